"""`ModelPolicy`: a model of stable-baselines3 as a policy."""

import hashlib
import json
import os
import sys
import zipfile
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv._io.extras import require
from flockenv._io.plain_file import open_plain
from flockenv.errors import ParameterError
from flockenv.policies.base import leaders_in_last_axis, observation_array

if TYPE_CHECKING:
    import gymnasium
    from stable_baselines3.common.policies import BasePolicy
    from torch import Tensor

    from flockenv.envs.spaces import ObservationSpace

_WEIGHTS_ENTRY = "policy.pth"
_READ_ENTRIES = (
    *("policy_class", "policy_kwargs", "observation_space", "action_space", "use_sde"),
    *("_last_obs", "_last_original_obs"),
)


class ModelPolicy:
    """A model or policy of stable-baselines3 that steers leaders like any other policy here.

    A model that was trained on `LeaderVecEnv` takes one leader's observation, and steers any number
    of leaders. A model that was trained on ``gymnasium.make("flockenv/Leaders-v0")`` takes the
    observations of k leaders in one row, and steers flocks with k leaders. If the model
    chooses levels (`rudder_levels`), they become rudders. If its environment is a `VecNormalize`,
    observations are normalized the same way; a model's file does not hold the statistics.

    A leader's rudder does not depend on the number of leaders that are steered at once, if the
    network has linear layers with hyperbolic tangents or rectifiers between them, like the default
    `MlpPolicy`. With other layers, PyTorch may round a row differently at another index.

    Parameters
    ----------
    model
        A model such as ``PPO``, or its ``policy``.
    provenance
        Its origin: any short texts by name.

    Attributes
    ----------
    leaders : int
        Number of leaders that the model steers at once.
    control_hz : float
        Control steps per second that it was trained with.
    observation : dict
    mirror_to_target : bool
    action_mode : str
    decision_period_s : float or None
        The environments' options of those names that it was trained with.

    Raises
    ------
    ParameterError
        If its spaces do not belong to a flockenv environment, or have unknown options.
    """

    def __init__(self, model: Any, *, provenance: Mapping[str, str] | None = None) -> None:
        from flockenv.envs.spaces import ObservationSpace

        space = getattr(model, "observation_space", None)
        if not isinstance(space, ObservationSpace):
            raise ParameterError(
                f"a model with the observation space {space} is not accepted: it was trained on "
                "another environment, or a wrapper changes what it sees; WrappedPolicy takes it "
                "with the wrapper"
            )
        if lacks_vec_normalize(model):
            raise ParameterError(
                "a model that was trained in VecNormalize and loaded without it is not accepted: "
                "load it with env = VecNormalize.load(...), which holds the statistics"
            )
        self._set_model(model, space, model.action_space, provenance)

    def _set_model(
        self,
        model: Any,
        space: "ObservationSpace",
        actions: "gymnasium.Space[Any]",
        provenance: Mapping[str, str] | None,
    ) -> None:
        """Store a model, and the options in the observation space that it was trained on."""
        self.model = model
        self.provenance = dict(provenance or {})
        self.leaders = space.leaders
        self._observation_size = space.shape[0] // space.leaders
        options = space.policy_options()
        self.observation: dict[str, object] = options["observation"]
        self.mirror_to_target: bool = options["mirror_to_target"]
        self.control_hz: float = options["control_hz"]
        self.action_mode: str = options["action_mode"]
        self.decision_period_s: float | None = options["decision_period_s"]
        self._rudder_levels = _rudder_levels_of(actions, self.leaders)

    def predict(
        self,
        observation: ArrayLike | Mapping[object, ArrayLike],
        state: object = None,
        episode_start: object = None,
        deterministic: bool = True,
    ) -> tuple[object, object]:
        """Return rudders for observations, as `LeaderPolicy`.

        A model of k leaders treats every k consecutive leaders as a flock. `deterministic` is
        passed to the model. Also raises ParameterError for numbers of leaders that are not a
        multiple of k.
        """
        if isinstance(observation, Mapping):
            arrays = [np.atleast_1d(observation_array(rows)) for rows in observation.values()]
            # Beside each other, so that the leaders of a flock are consecutive.
            stacked = np.stack(arrays, axis=-2)
            rudders, state = self._predict(stacked, state, episode_start, deterministic)
            return dict(zip(observation, np.moveaxis(rudders, -2, 0), strict=True)), state
        return self._predict(observation_array(observation), state, episode_start, deterministic)

    def _predict(
        self, array: NDArray[np.float32], state: object, episode_start: object, deterministic: bool
    ) -> tuple[NDArray[np.float32], object]:
        """Return the rudders of an array of observations, and the model's next state."""
        leaders_per_row = leaders_in_last_axis(array, self._observation_size)
        all_leaders = array.size // self._observation_size
        # Rows of one leader each are joined, so only longer rows must hold whole flocks.
        splits_flock = leaders_per_row > 1 and leaders_per_row % self.leaders != 0
        if all_leaders % self.leaders or splits_flock:
            raise ParameterError(
                f"observation has shape {array.shape}, but {self!r} steers {self.leaders} leaders "
                "at once"
            )
        inputs = array.reshape(all_leaders // self.leaders, -1)
        if episode_start is not None:
            # One bool per flock becomes one per input: a flock may have several inputs.
            flock_starts: NDArray[np.bool_] = np.asarray(episode_start, np.bool_).ravel()
            episode_start = np.repeat(flock_starts, len(inputs) // len(flock_starts))
        model_actions, state = self._model_actions(inputs, state, episode_start, deterministic)
        actions = np.asarray(model_actions, np.float64).reshape(all_leaders)
        if self._rudder_levels is not None:
            actions = np.array(_core.rudders_of_levels(actions.tolist(), self._rudder_levels))
        rudders = np.clip(actions, -1.0, 1.0).astype(np.float32)
        return rudders.reshape(*array.shape[:-1], leaders_per_row), state

    def _model_actions(
        self,
        inputs: NDArray[np.float32],
        state: object,
        episode_start: NDArray[np.bool_] | None,
        deterministic: bool,
    ) -> tuple[object, object]:
        """Return the model's actions and next state, for one input per leader or per flock."""
        vec_normalize = vec_normalize_of(self.model)
        if vec_normalize is not None:
            inputs = vec_normalize.normalize_obs(inputs)
        with independent_rows():
            actions_and_state: tuple[object, object] = self.model.predict(
                inputs, state, episode_start, deterministic
            )
        return actions_and_state

    def __repr__(self) -> str:
        name = self.provenance.get("file", type(self.model).__name__)
        leaders = "one leader" if self.leaders == 1 else f"{self.leaders} leaders at once"
        return f"{type(self).__name__}({name}, {leaders}, {self.control_hz:g} Hz)"


def vec_normalize_of(model: object) -> Any:
    """Return the ``VecNormalize`` of a model's environment, if it normalizes observations."""
    vec_normalize = getattr(model, "get_vec_normalize_env", lambda: None)()
    return vec_normalize if vec_normalize is not None and vec_normalize.norm_obs else None


def lacks_vec_normalize(model: object) -> bool:
    """Return whether a model was trained in a ``VecNormalize`` but loaded without it."""
    if getattr(model, "get_vec_normalize_env", lambda: None)() is not None:
        return False
    return _was_normalized(getattr(model, "__dict__", {}))


def _was_normalized(values: Mapping[str, Any]) -> bool:
    """Return whether a model with these attributes was trained in a ``VecNormalize``."""
    if values.get("_last_original_obs") is None:
        return False
    # On-policy algorithms store that only in VecNormalize, off-policy algorithms always. Those that
    # were given another environment have no last observations left: nothing tells of VecNormalize.
    is_off_policy, last = "learning_starts" in values, values.get("_last_obs")
    space = values["observation_space"]
    has_left_space = isinstance(last, np.ndarray) and not all(map(space.contains, last))
    return has_left_space or not is_off_policy


def space_under_wrappers(model: object) -> "ObservationSpace | None":
    """Return the space of the unwrapped environment in which a model learns, if known."""
    from flockenv.envs.spaces import ObservationSpace

    unwrapped = getattr(getattr(model, "env", None), "unwrapped", None)
    # DummyVecEnv of stable-baselines3 lists its environments in `envs`.
    first_env = getattr(unwrapped, "envs", [unwrapped])[0]
    space = getattr(getattr(first_env, "unwrapped", first_env), "observation_space", None)
    return space if isinstance(space, ObservationSpace) else None


def independent_rows() -> AbstractContextManager[object]:
    """Return a context in which torch computes each row of a linear layer independently."""
    torch = sys.modules.get("torch")
    return _independent_rows_mode(torch)() if torch else nullcontext()


@cache
def _independent_rows_mode(torch: ModuleType) -> type[AbstractContextManager[object]]:
    """Return the class of the context of `independent_rows`; it inherits from a class of torch."""
    linear = torch.nn.functional.linear

    class IndependentRows(torch.overrides.TorchFunctionMode):  # type: ignore[misc,name-defined]
        def __torch_function__(
            self,
            function: Callable[..., object],
            types: object,
            arguments: tuple[Any, ...] = (),
            options: dict[str, Any] | None = None,
        ) -> object:
            return (_linear if function is linear else function)(*arguments, **(options or {}))

    return IndependentRows


def _linear(input: "Tensor", weight: "Tensor", bias: "Tensor | None" = None) -> "Tensor":  # noqa: A002 - torch's names
    """Return the output of torch's linear layer, computed by the core."""
    rows = input.reshape(-1, input.shape[-1])
    outputs = len(weight)
    bias = weight.new_zeros(outputs) if bias is None else bias
    arrays = (tensor.detach().float().cpu().numpy() for tensor in (rows, weight.T, bias))
    return input.new_tensor(_core.linear(*arrays)).reshape(*input.shape[:-1], outputs)


def _rudder_levels_of(space: "gymnasium.Space[Any]", leaders: int) -> int | None:
    """Return the number of levels that a model chooses from; None if its actions are rudders."""
    import gymnasium

    if isinstance(space, gymnasium.spaces.Box) and space.shape == (leaders,):
        return None
    if isinstance(space, gymnasium.spaces.Discrete) and leaders == 1:
        return int(space.n)
    if isinstance(space, gymnasium.spaces.MultiDiscrete) and space.shape == (leaders,):
        return int(space.nvec[0])
    raise ParameterError(
        f"a model with the action space {space} is not accepted: it observes {leaders} leaders and "
        "has to choose as many rudders or levels"
    )


def as_policy(policy: object) -> object:
    """Return a policy unchanged, and a model of stable-baselines3 as a `ModelPolicy`."""
    # A model has a space of Gymnasium's, so without Gymnasium imported the policy is no model.
    gymnasium = sys.modules.get("gymnasium")
    if gymnasium and isinstance(getattr(policy, "observation_space", None), gymnasium.Space):
        return ModelPolicy(policy)
    return policy


def is_model_file(path: str | os.PathLike[str]) -> bool:
    """Return whether a file is a model of stable-baselines3, by the names of its zip's entries."""
    with open_plain(path) as file:
        try:
            return _WEIGHTS_ENTRY in zipfile.ZipFile(file).namelist()
        except (zipfile.BadZipFile, NotImplementedError, ValueError):
            # A damaged zip may state an unknown version, or names that are not text.
            return False


def load_model(path: str | os.PathLike[str]) -> ModelPolicy:
    """Read the policy of a model's ``.zip`` file; this executes code in the file.

    ``model.save`` of stable-baselines3 or sb3-contrib wrote the file. Raises what
    `flockenv.policies.load` raises; models trained in `VecNormalize` are refused, too.
    """
    saving = require("stable_baselines3.common.save_util", "train")
    try:
        with zipfile.ZipFile(path) as archive:
            stored = json.loads(archive.read("data"))
        # Other entries, such as schedules and buffers, are None, so their code is not executed.
        skipped = dict.fromkeys(stored.keys() - set(_READ_ENTRIES))
        data, weights, _ = saving.load_from_zip_file(path, device="cpu", custom_objects=skipped)
        if _was_normalized(data):
            raise ParameterError(
                "it was trained in VecNormalize, and its file does not hold how observations were "
                "normalized: steer with the model in memory, or train without VecNormalize: "
                "observations are scaled already"
            )
        model = _new_policy(data)
        model.load_state_dict(weights["policy"])
        model.set_training_mode(False)
        provenance = {
            "file": Path(path).name,
            "sha256": hashlib.sha256(Path(path).read_bytes()).hexdigest(),
            "samples": str(stored.get("num_timesteps")),
            "seed": str(stored.get("seed")),
        }
        return ModelPolicy(model, provenance=provenance)
    except OSError:
        raise
    except ParameterError as error:
        raise ParameterError(f"{path} is not accepted: {error}") from error
    # The file's own code may raise anything.
    except Exception as error:
        raise ParameterError(
            f"{path} is not a model that can be read: {type(error).__name__}: {error}"
        ) from error


def _new_policy(data: Mapping[str, Any]) -> "BasePolicy":
    """Return a policy of the stored class with the stored options, and newly drawn weights."""
    policy_class, options = data["policy_class"], dict(data["policy_kwargs"])
    options.pop("device", None)
    # The third argument is the schedule of the learning rate, which steering never calls.
    arguments = data["observation_space"], data["action_space"], lambda _: 0.0
    try:
        policy: BasePolicy = policy_class(*arguments, **{"use_sde": data["use_sde"], **options})
    except TypeError:  # Policies of DQN and similar algorithms take no use_sde.
        policy = policy_class(*arguments, **options)
    return policy
