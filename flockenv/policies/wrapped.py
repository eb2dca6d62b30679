"""`WrappedPolicy`: a model together with the wrapper that made its observations."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.arguments import check_function
from flockenv._io.extras import require
from flockenv.envs.spaces import ObservationSpace
from flockenv.errors import ParameterError, short_repr
from flockenv.policies.base import LeaderPolicy
from flockenv.policies.model import (
    ModelPolicy,
    lacks_normalizing,
    normalizing,
    one_by_one,
    space_under_wrappers,
)

if TYPE_CHECKING:
    import gymnasium

Wrap = Callable[[Any], Any]
"""A function that returns an environment in a wrapper, or in several."""


class WrappedPolicy(ModelPolicy):
    """A model that was trained in a wrapper of an environment, with the wrapper.

    The wrapper changes what leaders observe: it may cut, scale, stack or remember. It is made again
    for each run, around a stand-in for the environment. The stand-in has the environment's spaces
    and passes on the flock's observations, but has no rewards, infos or attributes.

    Parameters
    ----------
    model
        A model of stable-baselines3 such as ``PPO``, or any object with its ``predict``.
    wrapper
        A function that puts an environment into the wrapper or wrappers, such as
        ``lambda venv: VecFrameStack(venv, 4)``. It must not contain the `VecNormalize` of the
        model's own environment, whose statistics are applied anyway. A wrapper that normalizes
        observations itself must hold the training's statistics, which are not updated.
    env
        The environment that was wrapped for the training: a `LeaderVecEnv`, or
        ``flockenv/Leaders-v0``. The model is for flocks with its options.
    provenance
        As for `ModelPolicy`.

    Raises
    ------
    ParameterError
        For other environments than the model's own, for a model that was trained in `VecNormalize`
        and loaded without it, for wrappers that change what actions are or make observations of
        another shape than the model takes, and for wrappers that normalize with statistics that
        were never learned.
    TypeError
        If the wrapper is not a function.
    """

    def __init__(
        self,
        model: LeaderPolicy,
        wrapper: Wrap,
        env: object,
        *,
        provenance: Mapping[str, str] | None = None,
    ) -> None:
        check_function(wrapper, "wrapper")
        unwrapped: Any = getattr(env, "unwrapped", env)
        space = getattr(unwrapped, "observation_space", None)
        is_single = not hasattr(unwrapped, "num_envs")
        if not isinstance(space, ObservationSpace):
            raise ParameterError(
                f"env = {short_repr(env)} is not accepted: a LeaderVecEnv or flockenv/Leaders-v0 "
                "as it was before it was wrapped"
            )
        own = space_under_wrappers(model)
        if own is not None and own != space:
            raise ParameterError(
                f"env = {short_repr(env)} is not accepted: the model was trained in {own}, not "
                f"{space}"
            )
        self._wrapper, self._is_per_item = wrapper, is_single
        self._space, self._actions = space, unwrapped.action_space
        self._set_model(model, space, self._actions, provenance)
        made = self._made(space.low[None])
        if made.action_space != self._actions:
            raise ParameterError(
                f"a wrapper that makes the action space {made.action_space} is not accepted: it "
                f"may change what leaders observe, but not their actions, {self._actions}"
            )
        self._check_normalizing(made)
        takes = getattr(getattr(model, "observation_space", None), "shape", None)
        if takes is not None and takes != made.observation_space.shape:
            raise ParameterError(
                f"a wrapper that makes observations of shape {made.observation_space.shape} is not "
                f"accepted: the model takes {takes}"
            )

    def _check_normalizing(self, made: Any) -> None:
        """Refuse wrappers that do not normalize as the model's training did."""
        statistics = [layer.obs_rms for layer in _layers(made) if hasattr(layer, "obs_rms")]
        if any(statistic.count < 1.0 for statistic in statistics):
            raise ParameterError(
                "a wrapper that normalizes without statistics is not accepted: let it take over "
                "obs_rms of the training's"
            )
        if not statistics and lacks_normalizing(self.model):
            raise ParameterError(
                "a model that was trained in VecNormalize and loaded without it is not accepted: "
                "let the wrapper return VecNormalize.load(..., venv)"
            )
        own = normalizing(self.model)
        self._is_normalized_first = (
            own is not None and self.model.env is not own and own.venv is own.unwrapped
        )
        seen = self._space if self._is_normalized_first else made.observation_space
        if own is not None and own.obs_rms.mean.shape != seen.shape:
            raise ParameterError(
                f"a wrapper that makes observations of shape {seen.shape} is not accepted: those "
                f"of the training's VecNormalize have shape {own.obs_rms.mean.shape}"
            )

    def _made(self, items: NDArray[np.float32]) -> Any:
        """Return the wrapper around stand-ins that give these observations."""
        if self._is_per_item:
            made = self._wrapper(_stand_in(self._space, self._actions, items[0]))
        else:
            made = self._wrapper(_vector_stand_in(self._space, self._actions, items))
        for layer in _layers(made):
            # Of stable-baselines3's VecNormalize, and of Gymnasium's NormalizeObservation.
            for learns in ("training", "update_running_mean"):
                if hasattr(layer, "obs_rms") and hasattr(layer, learns):
                    setattr(layer, learns, False)
        return made

    def _decided(
        self,
        items: NDArray[np.float32],
        state: object,
        episode_start: NDArray[np.bool_] | None,
        deterministic: bool,
    ) -> tuple[object, object]:
        starts = state is None
        if episode_start is not None and episode_start.any():
            if not episode_start.all():
                raise ParameterError(
                    "episode_start of some flocks is not accepted: a wrapper's memory restarts "
                    "for all flocks together"
                )
            starts = True
        own = normalizing(self.model)
        if own is not None and self._is_normalized_first:
            items = own.normalize_obs(items)
        run = state if isinstance(state, _Run) and not starts else _Run(self, items)
        seen = run.observed(items)
        if own is not None and not self._is_normalized_first:
            seen = own.normalize_obs(seen)
        with one_by_one():
            actions, run.state = self.model.predict(seen, run.state, None, deterministic)
        run.actions = actions
        return actions, run


def _layers(wrapped: Any) -> list[Any]:
    """Return a wrapper and those within it, but not the environment itself."""
    found = []
    while wrapped is not wrapped.unwrapped:
        found.append(wrapped)
        wrapped = wrapped.venv if "venv" in vars(wrapped) else wrapped.env
    return found


class _Run:
    """A run: the wrappers' memory, and the model's decisions."""

    def __init__(self, policy: WrappedPolicy, items: NDArray[np.float32]) -> None:
        self.is_per_item = policy._is_per_item
        count = len(items) if self.is_per_item else 1
        self.wrapped = [policy._made(items[index:]) for index in range(count)]
        self.state: object = None
        self.actions: Any = None

    def observed(self, items: NDArray[np.float32]) -> object:
        """Return observations after the wrappers have changed them."""
        for index, wrapper in enumerate(self.wrapped):
            wrapper.unwrapped.given = items[index] if self.is_per_item else items
        starts = self.actions is None
        if not self.is_per_item:
            (venv,) = self.wrapped
            return venv.reset() if starts else venv.step(self.actions)[0]
        seen = [
            wrapper.reset()[0] if starts else wrapper.step(self.actions[index])[0]
            for index, wrapper in enumerate(self.wrapped)
        ]
        return np.stack([np.asarray(row) for row in seen])


def _stand_in(
    space: ObservationSpace, actions: "gymnasium.Space[Any]", given: NDArray[np.float32]
) -> "gymnasium.Env[Any, Any]":
    """Return an environment of Gymnasium whose observations are given to it."""
    import gymnasium

    class StandIn(gymnasium.Env[object, object]):
        observation_space, action_space = space, actions

        def __init__(self) -> None:
            self.given = given

        def reset(
            self, *, seed: int | None = None, options: object = None
        ) -> tuple[object, dict[str, Any]]:
            return self.given, {}

        def step(self, action: object) -> tuple[object, float, bool, bool, dict[str, Any]]:
            return self.given, 0.0, False, False, {}

    return StandIn()


def _vector_stand_in(
    space: ObservationSpace, actions: "gymnasium.Space[Any]", given: NDArray[np.float32]
) -> object:
    """Return a vector environment of stable-baselines3 whose observations are given to it."""
    vec_env = require("stable_baselines3.common.vec_env", "train")

    class StandIn(vec_env.VecEnv):  # type: ignore[misc,name-defined]
        def __init__(self) -> None:
            self.given, self.render_mode = given, None
            super().__init__(len(given), space, actions)

        def reset(self) -> object:
            return self.given

        def step_async(self, actions: object) -> None:
            pass

        def step_wait(self) -> tuple[object, ...]:
            count = self.num_envs
            return self.given, np.zeros(count), np.zeros(count, bool), [{} for _ in range(count)]

        def close(self) -> None:
            pass

        def get_attr(self, attr_name: str, indices: object = None) -> list[object]:
            return [getattr(self, attr_name)] * self.num_envs

        def set_attr(self, attr_name: str, value: object, indices: object = None) -> None:
            raise AttributeError(attr_name)

        def env_method(
            self, method_name: str, *arguments: object, **options: object
        ) -> list[object]:
            raise AttributeError(method_name)

        def env_is_wrapped(self, wrapper_class: object, indices: object = None) -> list[bool]:
            return [False] * self.num_envs

    return StandIn()
