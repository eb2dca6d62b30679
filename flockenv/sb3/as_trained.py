"""Models that act in an evaluation as they acted in their training."""

import copy
from typing import Any, TypeGuard

import numpy as np
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

from flockenv.envs.spaces import POLICY_OPTIONS, ObservationSpace, differing_options
from flockenv.errors import ParameterError, short_repr
from flockenv.policies import ModelPolicy, Policy
from flockenv.policies.model import lacks_normalizing, normalizing, space_under_wrappers
from flockenv.sb3.leader_vec_env import LeaderVecEnv
from flockenv.sb3.per_flock import PerFlock, layers_of


class AsTrained:
    """A model that acts on the observations of `PerFlock` as it did in its training.

    Observations are normalized as in the training, and a recurrent model is told the start of an
    episode for each leader.
    """

    def __init__(self, model: object, flocks: VecEnv, leaders: LeaderVecEnv) -> None:
        self.model = _unwrapped(model)
        self._flock_of_row = leaders.flock_of_slot
        own, layers = normalizing(self.model), normalizing_layers(flocks)
        theirs = [layer for layer in layers if layer.norm_obs]
        if not layers and lacks_normalizing(self.model):
            raise ParameterError(
                f"{short_repr(self.model)} was trained in VecNormalize and loaded without it: "
                "evaluate it in VecNormalize.load(..., env), which holds the statistics"
            )
        if theirs and own is None and getattr(self.model, "env", None) is not None:
            raise ParameterError(
                f"{short_repr(self.model)} was trained on observations that are not normalized: "
                "evaluate it without VecNormalize"
            )
        normalized: Any = theirs[0].obs_rms if theirs else None
        shape = normalized.mean.shape if theirs else flocks.observation_space.shape
        if own is not None and own.obs_rms.mean.shape != shape:
            raise ParameterError(
                f"{short_repr(self.model)} was trained on normalized observations of shape "
                f"{own.obs_rms.mean.shape}, not {shape}: evaluate it in wrappers in the same order"
            )
        if own is not None:
            for layer in theirs:
                _copy_statistics(own, layer)
        self._normalizing = None if theirs else own

    def predict(
        self,
        observation: object,
        state: object = None,
        episode_start: object = None,
        deterministic: bool = False,
    ) -> tuple[Any, Any]:
        """Return the model's actions. `episode_start` has one entry per flock."""
        if self._normalizing is not None:
            observation = self._normalizing.normalize_obs(observation)
        if episode_start is not None:
            episode_start = np.asarray(episode_start)[self._flock_of_row]
        found: tuple[Any, Any] = self.model.predict(
            observation, state=state, episode_start=episode_start, deterministic=deterministic
        )
        return found


def trained(model: object, flocks: VecEnv) -> AsTrained:
    """Return a model that acts as in its training; refuse flocks with another task."""
    (leaders,) = (layer.leaders for layer in layers_of(flocks) if isinstance(layer, PerFlock))
    _check_task(model, flocks, leaders)
    return AsTrained(model, flocks, leaders)


def normalizing_layers(flocks: VecEnv) -> list[VecNormalize]:
    """Return the `VecNormalize`s around flocks."""
    return [layer for layer in layers_of(flocks) if isinstance(layer, VecNormalize)]


def _copy_statistics(training: VecNormalize, own: VecNormalize) -> None:
    """Let `own` normalize as the training's `VecNormalize` does."""
    own.obs_rms, own.ret_rms = copy.deepcopy((training.obs_rms, training.ret_rms))
    own.clip_obs, own.epsilon = training.clip_obs, training.epsilon


def _unwrapped(model: object) -> Any:
    """Return the model of a `ModelPolicy`, which normalizes too and turns levels into rudders."""
    # If the flocks are in a wrapper, the model gets the wrapper's observations.
    return model.model if type(model) is ModelPolicy else model


def _check_task(given: object, flocks: VecEnv, leaders: LeaderVecEnv) -> None:
    """Refuse a model whose observations or actions mean something else here."""
    model = _unwrapped(given)
    own_policy = Policy.from_source(model)
    own_policy.check_pool(leaders._batch.parameters(0).pool)
    space, options = getattr(model, "observation_space", None), leaders.observation_space.options
    # A wrapper's space may say nothing about its meaning, or may belong to another flock.
    known = [one for one in (space, space_under_wrappers(model)) if _says_meaning(one)]
    for layer in known:
        _check_options(model, layer.policy_options(), options)
    if not known:
        own_policy.check_action_mode(leaders.action_mode, "in this evaluation")
        stated = {name: getattr(model, name, None) for name in POLICY_OPTIONS}
        stated = {name: value for name, value in stated.items() if value is not None}
        # A policy does not depend on options that it does not name.
        _check_options(model, stated, {name: options[name] for name in stated})
    spaces = {"observation": (space, flocks.observation_space)}
    spaces["action"] = (getattr(model, "action_space", None), flocks.action_space)
    for kind, (own, other) in spaces.items():
        if own is not None and own != other:
            raise ParameterError(
                f"{short_repr(model)} is not accepted in these flocks: its {kind} space is {own}, "
                f"not {other}"
            )


def _says_meaning(space: object) -> TypeGuard[ObservationSpace]:
    return isinstance(space, ObservationSpace)


def _check_options(model: object, stated: dict[str, Any], options: dict[str, Any]) -> None:
    """Refuse flocks whose options differ from those that a model was made for."""
    if differing := differing_options(stated, options):
        raise ParameterError(
            f"{short_repr(model)} is not accepted in these flocks: "
            + ", ".join(
                f"it is made for {name} = {own!r}, not {other!r}"
                for name, (own, other) in differing.items()
            )
        )
