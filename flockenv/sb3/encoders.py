"""The encoders of `flockenv.policies.encoders` as feature extractors of stable-baselines3."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
import torch
from numpy.typing import ArrayLike
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor

from flockenv.envs.observation import (
    FlockRowSpace,
    ObservationSpace,
    neighbor_places,
    observation_entries,
)
from flockenv.errors import ParameterError, shown
from flockenv.policies.encoders import (
    ACTIVATIONS,
    LARGEST_FEATURE,
    Encoder,
    LeaningEncoder,
    NeighborSetEncoder,
    checked_activation,
)
from flockenv.policies.lean_features import features, observed_features
from flockenv.sb3.leader_vec_env import LeaderVecEnv

__all__ = [
    "ACTIVATION_MODULES",
    "EXTRACTORS",
    "EncoderExtractor",
    "LeaningExtractor",
    "NeighborSetExtractor",
    "usual_features",
]

ACTIVATION_MODULES: Mapping[str, type[torch.nn.Module]] = {
    "tanh": torch.nn.Tanh,
    "relu": torch.nn.ReLU,
}
"""Torch's modules for `flockenv.policies.network.ACTIVATIONS`."""
assert ACTIVATION_MODULES.keys() == ACTIVATIONS.keys()

_LEAST_DEVIATION = 0.05


class EncoderExtractor(BaseFeaturesExtractor):
    """A feature extractor that an encoder without torch can be made of, and the other way round.

    Parameters
    ----------
    observation_space
        Of a `LeaderVecEnv`.
    kind
        The kind of encoder.

    Raises
    ------
    ParameterError
        For spaces of other environments, and layouts that the encoder cannot read.
    """

    def __init__(self, observation_space: gymnasium.Space[Any], kind: type[Encoder]) -> None:
        space = observation_space
        if isinstance(space, FlockRowSpace):
            raise ParameterError(
                "rows with the features of a flock are not accepted: FlockCriticPolicy encodes "
                "what the actor sees"
            )
        if not isinstance(space, ObservationSpace) or space.leaders != 1:
            raise ParameterError(
                f"observation_space = {shown(space)} is not accepted: that of a LeaderVecEnv"
            )
        self.blocks: dict[str, Any] = dict(space.options["observation"])
        kind.check(self.blocks, space.options["mirror_to_target"])
        super().__init__(space, features_dim=1)

    @abstractmethod
    def encoder(self) -> Encoder:
        """Return the encoder as it is now, without torch."""

    @abstractmethod
    def copy_from(self, encoder: Encoder) -> None:
        """Take over the numbers of an encoder.

        Raises
        ------
        ParameterError
            If it is of another kind or size.
        """


class NeighborSetExtractor(EncoderExtractor):
    """A deep set over the observed neighbors; `flockenv.policies.encoders.NeighborSetEncoder`.

    Parameters
    ----------
    observation_space
        Of a `LeaderVecEnv`.
    layers
        Sizes of the layers of the network that embeds each neighbor.
    activation
        ``"tanh"`` or ``"relu"``, after each layer.

    Raises
    ------
    ParameterError
        For spaces of other environments or without the block of neighbors, unknown activations, and
        no layers.
    """

    _places: torch.Tensor
    _others: torch.Tensor

    def __init__(
        self,
        observation_space: gymnasium.Space[Any],
        layers: Sequence[int] = (32, 32),
        activation: str = "tanh",
    ) -> None:
        super().__init__(observation_space, NeighborSetEncoder)
        self.activation = checked_activation(activation)
        if not layers:
            raise ParameterError("no layers are not accepted: the sizes of at least one")
        places = neighbor_places(self.blocks)
        others = np.setdiff1d(np.arange(len(observation_entries(self.blocks))), places)
        self.register_buffer("_places", torch.from_numpy(places), persistent=False)
        self.register_buffer("_others", torch.from_numpy(others), persistent=False)
        modules: list[torch.nn.Module] = []
        inputs = places.shape[1]
        for outputs in layers:
            modules += [torch.nn.Linear(inputs, outputs), ACTIVATION_MODULES[activation]()]
            inputs = outputs
        self.embed = torch.nn.Sequential(*modules)
        self._features_dim = len(others) + inputs

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Return encoded rows, shape (..., features_dim)."""
        neighbors = observations[..., self._places]
        mean = (self.embed(neighbors) * neighbors[..., :1]).mean(-2)
        return torch.cat([observations[..., self._others], mean], -1)

    def _linear(self) -> list[torch.nn.Linear]:
        return [each for each in self.embed if isinstance(each, torch.nn.Linear)]

    def encoder(self) -> NeighborSetEncoder:
        """Return the encoder as it is now, without torch."""
        return NeighborSetEncoder(
            [layer.weight.detach().cpu().numpy().T for layer in self._linear()],
            [layer.bias.detach().cpu().numpy() for layer in self._linear()],
            self.activation,
            observation=self.blocks,
        )

    def copy_from(self, encoder: Encoder) -> None:
        """Take over the layers of an encoder; see `EncoderExtractor`."""
        own = [tuple(layer.weight.T.shape) for layer in self._linear()]
        theirs = []
        if isinstance(encoder, NeighborSetEncoder) and encoder.activation == self.activation:
            theirs = encoder.layers
        if own != [weight.shape for weight, _ in theirs]:
            raise ParameterError(
                f"an encoder with layers of {own} numbers is needed, with {self.activation}"
            )
        with torch.no_grad():
            for layer, (weight, bias) in zip(self._linear(), theirs, strict=True):
                layer.weight.copy_(torch.from_numpy(weight.T.copy()))
                layer.bias.copy_(torch.from_numpy(bias))


class LeaningExtractor(EncoderExtractor):
    """Standardized features of a leaning law; `flockenv.policies.encoders.LeaningEncoder`.

    Parameters
    ----------
    observation_space
        Of a `LeaderVecEnv` with ``mirror_to_target``.
    mean, deviation
        Of each feature, as `usual_features` measures them; 0 and 1 where they are not given.

    Raises
    ------
    ParameterError
        For spaces of other environments, without the blocks of the features or without
        ``mirror_to_target``, and for numbers that are no means and deviations.
    """

    _mean: torch.Tensor
    _deviation: torch.Tensor

    def __init__(
        self,
        observation_space: gymnasium.Space[Any],
        mean: ArrayLike | None = None,
        deviation: ArrayLike | None = None,
    ) -> None:
        super().__init__(observation_space, LeaningEncoder)
        self._names = [entry.name for entry in observation_entries(self.blocks)]
        self._features = observed_features(self._names)
        self._features_dim = size = len(self._features)
        self.register_buffer("_mean", torch.zeros(size))
        self.register_buffer("_deviation", torch.ones(size))
        given = (
            np.zeros(size) if mean is None else mean,
            np.ones(size) if deviation is None else deviation,
        )
        self.copy_from(LeaningEncoder(*given, observation=self.blocks))

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Return encoded rows, shape (..., features_dim)."""
        found: torch.Tensor = features(observations, self._names, self._features, torch)
        limit = LARGEST_FEATURE
        return ((found - self._mean) / self._deviation).clip(-limit, limit)

    def encoder(self) -> LeaningEncoder:
        """Return the encoder as it is now, without torch."""
        numbers = (each.cpu().numpy() for each in (self._mean, self._deviation))
        return LeaningEncoder(*numbers, observation=self.blocks)

    def copy_from(self, encoder: Encoder) -> None:
        """Take over the means and deviations of an encoder; see `EncoderExtractor`."""
        if not isinstance(encoder, LeaningEncoder) or encoder.features != self._features:
            raise ParameterError(
                f"{shown(encoder)} is not accepted: the features {', '.join(self._features)}"
            )
        self._mean.copy_(torch.from_numpy(encoder.mean))
        self._deviation.copy_(torch.from_numpy(encoder.deviation))


EXTRACTORS: Mapping[str, type[EncoderExtractor]] = {
    NeighborSetEncoder.kind: NeighborSetExtractor,
    LeaningEncoder.kind: LeaningExtractor,
}
"""Feature extractors by the names in `flockenv.policies.encoders.ENCODERS`."""


def usual_features(*venvs: LeaderVecEnv, duration_s: float = 240.0) -> dict[str, list[float]]:
    """Measure the mean and the deviation of a leaning law's features under the tuned law.

    Leaders lean nowhere, so that the pool's tuned law steers them. The first 20 s are left out, and
    a feature that hardly varies has a deviation of 0.05.

    Parameters
    ----------
    venvs
        Environments with ``action_mode="lean"`` and ``mirror_to_target``, of one layout. They are
        reset, with the seeds set for that.
    duration_s
        How long to measure.

    Returns
    -------
    dict
        ``mean`` and ``deviation``, the arguments of `LeaningExtractor`.

    Raises
    ------
    ParameterError
        For another action mode.
    """
    rows = []
    for venv in venvs:
        if venv.action_mode != "lean":
            raise ParameterError(
                f"action_mode = {venv.action_mode!r} is not accepted: the features' usual values "
                "are those under a lean of 0"
            )
        space = venv.observation_space
        assert isinstance(space, ObservationSpace)
        names = [entry.name for entry in observation_entries(space.options["observation"])]
        LeaningEncoder.check(space.options["observation"], space.options["mirror_to_target"])
        venv.reset()
        no_lean = np.zeros((venv.num_envs, 1))
        every = max(1, round(2.0 * venv.decisions_hz))
        for step in range(1, round((20.0 + duration_s) * venv.decisions_hz) + 1):
            observations, _, _, _ = venv.step(no_lean)
            if step > 20.0 * venv.decisions_hz and step % every == 0:
                rows.append(features(observations, names, observed_features(names)))
    found = np.concatenate(rows)
    deviation = np.maximum(found.std(axis=0), _LEAST_DEVIATION)
    return {"mean": found.mean(axis=0).tolist(), "deviation": deviation.tolist()}
