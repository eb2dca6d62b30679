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
    independent_rows,
    lacks_vec_normalize,
    space_under_wrappers,
    vec_normalize_of,
)

if TYPE_CHECKING:
    import gymnasium

Wrap = Callable[[Any], Any]
"""A function that puts an environment into one or several wrappers, and returns the outermost."""


class WrappedPolicy(ModelPolicy):
    """A model that was trained in a wrapper of an environment, with the wrapper.

    The wrapper changes what leaders observe: it may cut, scale or stack observations, or remember
    earlier ones. It is made again for each run, around a stand-in for the environment. The stand-in
    has the environment's spaces and returns the flock's observations, but it has no rewards, infos
    or attributes.

    Parameters
    ----------
    model
        A model of stable-baselines3 such as ``PPO``, or any object with its ``predict``.
    wrapper
        A function that puts an environment into the wrapper or wrappers, such as
        ``lambda venv: VecFrameStack(venv, 4)``. The `VecNormalize` of the model's own environment
        must not be among them: its statistics are applied anyway. A wrapper that normalizes
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
        training_space = space_under_wrappers(model)
        if training_space is not None and training_space != space:
            raise ParameterError(
                f"env = {short_repr(env)} is not accepted: the model was trained in "
                f"{training_space}, not {space}"
            )
        self._wrapper, self._is_per_flock = wrapper, is_single
        self._space, self._actions = space, unwrapped.action_space
        self._set_model(model, space, self._actions, provenance)
        wrapped = self._wrapped_stand_in(space.low[None])
        if wrapped.action_space != self._actions:
            raise ParameterError(
                f"a wrapper that makes the action space {wrapped.action_space} is not accepted: it "
                f"may change what leaders observe, but not their actions, {self._actions}"
            )
        self._set_normalizes_first(wrapped)
        wrapped_shape = wrapped.observation_space.shape
        model_shape = getattr(getattr(model, "observation_space", None), "shape", None)
        if model_shape is not None and model_shape != wrapped_shape:
            raise ParameterError(
                f"a wrapper that makes observations of shape {wrapped_shape} is not accepted: the "
                f"model takes {model_shape}"
            )

    def _set_normalizes_first(self, wrapped: Any) -> None:
        """Store whether the model's `VecNormalize` acts before the wrapper.

        Refuse wrappers that do not normalize as the model's training did.
        """
        statistics = [layer.obs_rms for layer in _layers(wrapped) if hasattr(layer, "obs_rms")]
        if any(statistic.count < 1.0 for statistic in statistics):
            raise ParameterError(
                "a wrapper that normalizes without statistics is not accepted: give it the obs_rms "
                "of the training's wrapper"
            )
        if not statistics and lacks_vec_normalize(self.model):
            raise ParameterError(
                "a model that was trained in VecNormalize and loaded without it is not accepted: "
                "let the wrapper return VecNormalize.load(..., venv)"
            )
        vec_normalize = vec_normalize_of(self.model)
        # VecNormalize acts first if it is the innermost of several wrappers of the training.
        self._normalizes_first = (
            vec_normalize is not None
            and self.model.env is not vec_normalize
            and vec_normalize.venv is vec_normalize.unwrapped
        )
        if vec_normalize is None:
            return
        normalized = self._space if self._normalizes_first else wrapped.observation_space
        training_shape = vec_normalize.obs_rms.mean.shape
        if training_shape != normalized.shape:
            raise ParameterError(
                f"a wrapper that makes observations of shape {normalized.shape} is not accepted: "
                f"those of the training's VecNormalize have shape {training_shape}"
            )

    def _wrapped_stand_in(self, inputs: NDArray[np.float32]) -> Any:
        """Return the wrapper around a stand-in for the environment.

        The stand-in holds the first flock of `inputs` if each flock has its own wrapper, otherwise
        all flocks.
        """
        if self._is_per_flock:
            wrapped = self._wrapper(_stand_in(self._space, self._actions, inputs[0]))
        else:
            wrapped = self._wrapper(_vector_stand_in(self._space, self._actions, inputs))
        for layer in _layers(wrapped):
            # Stop updates of the statistics: VecNormalize of stable-baselines3 has the first
            # switch, NormalizeObservation of Gymnasium the second.
            for switch in ("training", "update_running_mean"):
                if hasattr(layer, "obs_rms") and hasattr(layer, switch):
                    setattr(layer, switch, False)
        return wrapped

    def _model_actions(
        self,
        inputs: NDArray[np.float32],
        state: object,
        episode_start: NDArray[np.bool_] | None,
        deterministic: bool,
    ) -> tuple[object, object]:
        starts_run = state is None
        if episode_start is not None and episode_start.any():
            if not episode_start.all():
                raise ParameterError(
                    "episode_start of some flocks is not accepted: a wrapper's memory restarts "
                    "for all flocks together"
                )
            starts_run = True
        vec_normalize = vec_normalize_of(self.model)
        if vec_normalize is not None and self._normalizes_first:
            inputs = vec_normalize.normalize_obs(inputs)
        run = state if isinstance(state, _Run) and not starts_run else _Run(self, inputs)
        observations = run.wrapped_observations(inputs)
        if vec_normalize is not None and not self._normalizes_first:
            observations = vec_normalize.normalize_obs(observations)
        with independent_rows():
            actions, run.state = self.model.predict(observations, run.state, None, deterministic)
        run.actions = actions
        return actions, run


def _layers(wrapped: Any) -> list[Any]:
    """Return a wrapper and those within it, but not the environment itself."""
    layers = []
    while wrapped is not wrapped.unwrapped:
        layers.append(wrapped)
        wrapped = wrapped.venv if "venv" in vars(wrapped) else wrapped.env
    return layers


class _Run:
    """A run: its wrappers, and the model's state and last actions."""

    def __init__(self, policy: WrappedPolicy, inputs: NDArray[np.float32]) -> None:
        self.is_per_flock = policy._is_per_flock
        count = len(inputs) if self.is_per_flock else 1
        #: A wrapper for each flock, or one for all.
        self.wrappers = [policy._wrapped_stand_in(inputs[index:]) for index in range(count)]
        self.state: object = None
        self.actions: Any = None

    def wrapped_observations(self, inputs: NDArray[np.float32]) -> object:
        """Return the observations that the wrappers make of the flocks' own."""
        for index, wrapper in enumerate(self.wrappers):
            wrapper.unwrapped.observation = inputs[index] if self.is_per_flock else inputs
        is_first = self.actions is None
        if not self.is_per_flock:
            (venv,) = self.wrappers
            return venv.reset() if is_first else venv.step(self.actions)[0]
        rows = [
            wrapper.reset()[0] if is_first else wrapper.step(self.actions[index])[0]
            for index, wrapper in enumerate(self.wrappers)
        ]
        return np.stack([np.asarray(row) for row in rows])


def _stand_in(
    space: ObservationSpace, actions: "gymnasium.Space[Any]", observation: NDArray[np.float32]
) -> "gymnasium.Env[Any, Any]":
    """Return a Gymnasium environment that always returns its attribute `observation`."""
    import gymnasium

    class StandIn(gymnasium.Env[object, object]):
        observation_space, action_space = space, actions

        def __init__(self) -> None:
            self.observation = observation

        def reset(
            self, *, seed: int | None = None, options: object = None
        ) -> tuple[object, dict[str, Any]]:
            return self.observation, {}

        def step(self, action: object) -> tuple[object, float, bool, bool, dict[str, Any]]:
            return self.observation, 0.0, False, False, {}

    return StandIn()


def _vector_stand_in(
    space: ObservationSpace, actions: "gymnasium.Space[Any]", observation: NDArray[np.float32]
) -> object:
    """Return a vector environment of stable-baselines3 that returns its attribute `observation`."""
    vec_env = require("stable_baselines3.common.vec_env", "train")

    class StandIn(vec_env.VecEnv):  # type: ignore[misc,name-defined]
        def __init__(self) -> None:
            self.observation, self.render_mode = observation, None
            super().__init__(len(observation), space, actions)

        def reset(self) -> object:
            return self.observation

        def step_async(self, actions: object) -> None:
            pass

        def step_wait(self) -> tuple[object, ...]:
            count = self.num_envs
            infos: list[dict[str, Any]] = [{} for _ in range(count)]
            return self.observation, np.zeros(count), np.zeros(count, bool), infos

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
