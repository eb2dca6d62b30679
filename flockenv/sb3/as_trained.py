"""Models that act in an evaluation as they acted in their training."""

import copy
from typing import Any, TypeGuard

import numpy as np
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

from flockenv.envs.spaces import POLICY_OPTIONS, ObservationSpace, differing_options
from flockenv.errors import ParameterError, short_repr
from flockenv.policies import ModelPolicy, Policy
from flockenv.policies.model import lacks_vec_normalize, space_under_wrappers, vec_normalize_of
from flockenv.sb3.leader_vec_env import LeaderVecEnv
from flockenv.sb3.per_flock import PerFlock, layers_of


class AsTrained:
    """A model that acts on the observations of `PerFlock` as it did in its training.

    Observations are normalized as in the training. A recurrent model gets the starts of episodes
    per leader.
    """

    def __init__(self, model: object, flocks: VecEnv, leaders: LeaderVecEnv) -> None:
        self.model = _unwrapped(model)
        self._flock_of_row = leaders.flock_of_slot
        training_layer, layers = vec_normalize_of(self.model), normalizing_layers(flocks)
        observation_layers = [layer for layer in layers if layer.norm_obs]
        if not layers and lacks_vec_normalize(self.model):
            raise ParameterError(
                f"{short_repr(self.model)} was trained in VecNormalize and loaded without it: "
                "evaluate it in VecNormalize.load(..., env), which holds the statistics"
            )
        knows_training = getattr(self.model, "env", None) is not None
        if observation_layers and training_layer is None and knows_training:
            raise ParameterError(
                f"{short_repr(self.model)} was trained on observations that are not normalized: "
                "evaluate it without VecNormalize"
            )
        if training_layer is not None:
            _check_normalized_shape(self.model, training_layer, flocks, observation_layers)
            for layer in observation_layers:
                _copy_statistics(training_layer, layer)
        #: The training's `VecNormalize`, if the flocks do not normalize observations themselves.
        self._normalizing = None if observation_layers else training_layer

    def predict(
        self,
        observation: object,
        state: object = None,
        episode_start: object = None,
        deterministic: bool = False,
    ) -> tuple[Any, Any]:
        """Return the model's actions and state. `episode_start` has one entry per flock."""
        if self._normalizing is not None:
            observation = self._normalizing.normalize_obs(observation)
        if episode_start is not None:
            episode_start = np.asarray(episode_start)[self._flock_of_row]
        actions_and_state: tuple[Any, Any] = self.model.predict(
            observation, state=state, episode_start=episode_start, deterministic=deterministic
        )
        return actions_and_state


def as_trained(model: object, flocks: VecEnv) -> AsTrained:
    """Return a model that acts as in its training; refuse flocks with other options."""
    (leaders,) = (layer.leaders for layer in layers_of(flocks) if isinstance(layer, PerFlock))
    _check_task(model, flocks, leaders)
    return AsTrained(model, flocks, leaders)


def normalizing_layers(flocks: VecEnv) -> list[VecNormalize]:
    """Return the `VecNormalize`s around flocks."""
    return [layer for layer in layers_of(flocks) if isinstance(layer, VecNormalize)]


def _check_normalized_shape(
    model: object,
    training_layer: VecNormalize,
    flocks: VecEnv,
    observation_layers: list[VecNormalize],
) -> None:
    """Refuse flocks whose observations, as normalized, have another shape than in the training.

    The outermost of `observation_layers` normalizes them; without layers, `AsTrained` does.
    """
    statistics: Any = observation_layers[0].obs_rms if observation_layers else None
    shape = statistics.mean.shape if observation_layers else flocks.observation_space.shape
    training_statistics: Any = training_layer.obs_rms
    trained_shape = training_statistics.mean.shape
    if trained_shape != shape:
        raise ParameterError(
            f"{short_repr(model)} was trained on normalized observations of shape "
            f"{trained_shape}, not {shape}: evaluate it in wrappers in the same order"
        )


def _copy_statistics(source: VecNormalize, target: VecNormalize) -> None:
    """Let `target` normalize as `source` does."""
    target.obs_rms, target.ret_rms = copy.deepcopy((source.obs_rms, source.ret_rms))
    target.clip_obs, target.epsilon = source.clip_obs, source.epsilon


def _unwrapped(model: object) -> Any:
    """Return the model of a `ModelPolicy`, and any other model unchanged.

    A `ModelPolicy` would normalize observations a second time, and turn levels into rudders.
    """
    return model.model if type(model) is ModelPolicy else model


def _check_task(wrapped_model: object, flocks: VecEnv, leaders: LeaderVecEnv) -> None:
    """Refuse a model whose observations or actions mean something else in these flocks."""
    model = _unwrapped(wrapped_model)
    policy = Policy.from_source(model)
    policy.check_pool(leaders._batch.parameters(0).pool)
    space, options = getattr(model, "observation_space", None), leaders.observation_space.options
    # Both are checked: the model's space may lack the options, and the space under its wrappers may
    # be of another flock.
    spaces_with_options = [
        candidate for candidate in (space, space_under_wrappers(model)) if _has_options(candidate)
    ]
    for known_space in spaces_with_options:
        _check_options(model, known_space.policy_options(), options)
    if not spaces_with_options:
        policy.check_action_mode(leaders.action_mode, "in this evaluation")
        stated = {name: getattr(model, name, None) for name in POLICY_OPTIONS}
        stated = {name: value for name, value in stated.items() if value is not None}
        # A policy does not depend on options that it does not name.
        _check_options(model, stated, {name: options[name] for name in stated})
    spaces = {"observation": (space, flocks.observation_space)}
    spaces["action"] = (getattr(model, "action_space", None), flocks.action_space)
    for kind, (model_space, flock_space) in spaces.items():
        if model_space is not None and model_space != flock_space:
            raise ParameterError(
                f"{short_repr(model)} is not accepted in these flocks: its {kind} space is "
                f"{model_space}, not {flock_space}"
            )


def _has_options(space: object) -> TypeGuard[ObservationSpace]:
    return isinstance(space, ObservationSpace)


def _check_options(model: object, trained: dict[str, Any], options: dict[str, Any]) -> None:
    """Refuse flocks whose options differ from those of a model's training."""
    if differing := differing_options(trained, options):
        raise ParameterError(
            f"{short_repr(model)} is not accepted in these flocks: "
            + ", ".join(
                f"it is made for {name} = {trained_value!r}, not {value!r}"
                for name, (trained_value, value) in differing.items()
            )
        )
