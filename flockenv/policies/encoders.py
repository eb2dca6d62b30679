"""Encoders: what stands between a leader's observation and the layers of a network.

Each is declared once, here; `flockenv.sb3.encoders` trains them with torch.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv._io.npz_header import array_of, entry_of
from flockenv.envs.observation import neighbor_places, observation_entries
from flockenv.errors import ParameterError, refuse_unknown, shown
from flockenv.policies.base import numbers
from flockenv.policies.lean_features import features, observed_features

__all__ = [
    "ACTIVATIONS",
    "ENCODERS",
    "Encoder",
    "Layers",
    "LeaningEncoder",
    "NeighborSetEncoder",
    "checked_layers",
]

Layers = list[tuple[NDArray[np.float32], NDArray[np.float32]]]
"""Matrices, shape (inputs, outputs), and biases, shape (outputs,), in turn."""

LARGEST_FEATURE = 5.0
"""Standardized features are clipped to this, so that rare states do not rule."""


def _relu(values: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.maximum(values, np.float32(0.0))


ACTIVATIONS: Mapping[str, Callable[[NDArray[np.float32]], NDArray[np.float32]]] = {
    "tanh": np.tanh,
    "relu": _relu,
}
"""What may stand between two layers."""


class Encoder(ABC):
    """A map from rows of observations to rows of what a network's first layer takes.

    Parameters
    ----------
    observation
        Blocks of the observation that differ from the default layout.

    Attributes
    ----------
    kind : str
        Its name in `ENCODERS`, in settings and in files.
    size : int
        Numbers of an encoded row.
    names : list of str
        The entries of the observations that it reads, in order.
    """

    kind: ClassVar[str]
    size: int
    names: list[str]

    @abstractmethod
    def __call__(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return encoded rows, shape (leaders, size), of observations (leaders, numbers)."""

    @staticmethod
    @abstractmethod
    def check(observation: Mapping[str, Any], mirror_to_target: bool) -> None:
        """Refuse layouts that the encoder cannot read.

        Raises
        ------
        ParameterError
            Where a block is missing, or the view has to be mirrored.
        """

    @abstractmethod
    def contents(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Return what a file's header and arrays hold of it, by names that start with encoder."""

    @classmethod
    @abstractmethod
    def from_contents(
        cls,
        header: Mapping[str, Any],
        arrays: Mapping[str, NDArray[Any]],
        observation: Mapping[str, Any],
    ) -> Self:
        """Return the encoder of `contents`."""


class NeighborSetEncoder(Encoder):
    """A deep set: one small network embeds each observed neighbor, and the embeddings are averaged.

    The embeddings of the neighbors that are present are summed and divided by the number of places
    for neighbors, so that the mean shows how many there are and does not depend on their order
    (Zaheer et al., "Deep Sets", 2017). The other numbers of the observation come first in the
    encoded row, then the mean embedding.

    Parameters
    ----------
    weights, biases
        Layers of the network that embeds, as of `NetworkPolicy`; from the numbers of one neighbor.
    activation
        A name in `ACTIVATIONS`, after each layer.
    observation
        Blocks of the observation that differ from the default layout.

    Raises
    ------
    ParameterError
        Without the block of neighbors, and for layers that do not fit.
    """

    kind = "deepsets"

    def __init__(
        self,
        weights: Sequence[ArrayLike],
        biases: Sequence[ArrayLike],
        activation: str = "tanh",
        *,
        observation: Mapping[str, Any] | None = None,
    ) -> None:
        self.check(observation or {}, False)
        self._places = neighbor_places(observation)
        self._layers = checked_layers(weights, biases, self._places.shape[1], "the encoder's layer")
        self.activation = checked_activation(activation)
        self.names = [entry.name for entry in observation_entries(observation)]
        self._others = np.setdiff1d(np.arange(len(self.names)), self._places)
        self.size = len(self._others) + len(self._layers[-1][1])

    def __call__(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return encoded rows; see `Encoder`."""
        neighbors = rows[:, self._places]
        values, activate = neighbors, ACTIVATIONS[self.activation]
        for weight, bias in self._layers:
            values = activate(values @ weight + bias)
        # The first number of a neighbor says whether it is present.
        mean = (values * neighbors[..., :1]).mean(axis=1)
        encoded: NDArray[np.float32] = np.concatenate([rows[:, self._others], mean], axis=1)
        return encoded

    @staticmethod
    def check(observation: Mapping[str, Any], mirror_to_target: bool) -> None:
        """Refuse layouts without the block of neighbors; see `Encoder`."""
        if not len(neighbor_places(observation)):
            raise ParameterError(
                f"encoder = 'deepsets' is not accepted with observation = {dict(observation)!r}: "
                "it needs the block neighbors"
            )

    @property
    def layers(self) -> Layers:
        """Copies of the layers of the network that embeds."""
        return [(weight.copy(), bias.copy()) for weight, bias in self._layers]

    def contents(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Return what a file holds of it; see `Encoder`."""
        header = {"encoder_layers": len(self._layers), "encoder_activation": self.activation}
        arrays: dict[str, NDArray[Any]] = {}
        for place, (weight, bias) in enumerate(self._layers):
            arrays |= {f"encoder_weight_{place}": weight, f"encoder_bias_{place}": bias}
        return header, arrays

    @classmethod
    def from_contents(
        cls,
        header: Mapping[str, Any],
        arrays: Mapping[str, NDArray[Any]],
        observation: Mapping[str, Any],
    ) -> Self:
        """Return the encoder of `contents`; see `Encoder`."""
        places = range(entry_of(header, "encoder_layers", int))
        return cls(
            [array_of(arrays, f"encoder_weight_{place}") for place in places],
            [array_of(arrays, f"encoder_bias_{place}") for place in places],
            entry_of(header, "encoder_activation", str),
            observation=observation,
        )


class LeaningEncoder(Encoder):
    """The features of a `LeaningLaw`, each minus its mean and divided by its deviation.

    They are clipped to [-5, 5] then. A network without hidden layers whose actions are leans is
    nearly a `LeaningLaw`.

    Parameters
    ----------
    mean, deviation
        Of each feature, shape (number of features,), where it is usual; deviations are positive.
    features
        Names of the features; None: all that the observation has.
    observation
        Blocks of the observation that differ from the default layout. The view is mirrored to the
        target.

    Raises
    ------
    ParameterError
        For layouts without the blocks of the features, and for numbers that are no means and
        deviations.
    """

    kind = "leaning"

    def __init__(
        self,
        mean: ArrayLike,
        deviation: ArrayLike,
        *,
        features: Sequence[str] | None = None,
        observation: Mapping[str, Any] | None = None,
    ) -> None:
        self.check(observation or {}, True)
        self.names = [entry.name for entry in observation_entries(observation)]
        observed = observed_features(self.names)
        self.features = observed if features is None else tuple(features)
        refuse_unknown(self.features, observed, "feature of this observation")
        if not self.features or len({*self.features}) < len(self.features):
            raise ParameterError(
                f"features = {shown(features)} are not accepted: at least one, none of them twice"
            )
        self.mean = numbers("mean", mean, np.float32)
        self.deviation = numbers("deviation", deviation, np.float32)
        self.size = len(self.features)
        for name, values in (("mean", self.mean), ("deviation", self.deviation)):
            if values.shape != (self.size,) or not np.isfinite(values).all():
                raise ParameterError(
                    f"{name} is not accepted: {self.size} finite numbers, one for each feature"
                )
        if not (self.deviation > 0.0).all():
            raise ParameterError("deviation is not accepted: positive numbers")

    def __call__(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return encoded rows; see `Encoder`."""
        standardized = (features(rows, self.names, self.features) - self.mean) / self.deviation
        encoded: NDArray[np.float32] = np.clip(
            standardized, -LARGEST_FEATURE, LARGEST_FEATURE
        ).astype(np.float32)
        return encoded

    @staticmethod
    def check(observation: Mapping[str, Any], mirror_to_target: bool) -> None:
        """Refuse layouts without the blocks of the features, and views as they are."""
        names = [entry.name for entry in observation_entries(observation)]
        if not observed_features(names):
            raise ParameterError(
                f"encoder = 'leaning' is not accepted with observation = {dict(observation)!r}: it "
                "needs the blocks own, neighbors and order"
            )
        if not mirror_to_target:
            raise ParameterError("encoder = 'leaning' is not accepted without mirror_to_target")

    def contents(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Return what a file holds of it; see `Encoder`."""
        arrays = {"encoder_mean": self.mean, "encoder_deviation": self.deviation}
        return {"encoder_features": list(self.features)}, arrays

    @classmethod
    def from_contents(
        cls,
        header: Mapping[str, Any],
        arrays: Mapping[str, NDArray[Any]],
        observation: Mapping[str, Any],
    ) -> Self:
        """Return the encoder of `contents`; see `Encoder`."""
        names = entry_of(header, "encoder_features", list)
        if not all(isinstance(name, str) for name in names):
            raise ParameterError(f"encoder_features = {names!r} is not accepted: a list of names")
        mean, deviation = array_of(arrays, "encoder_mean"), array_of(arrays, "encoder_deviation")
        return cls(mean, deviation, features=names, observation=observation)


ENCODERS: Mapping[str, type[Encoder]] = {
    each.kind: each for each in (NeighborSetEncoder, LeaningEncoder)
}
"""Encoders by the name that settings and files give them."""


def checked_activation(activation: str) -> str:
    """Return the name of an activation.

    Raises
    ------
    ParameterError
        For unknown names.
    """
    if activation not in ACTIVATIONS:
        raise ParameterError(
            f"activation = {activation!r} is not accepted: one of {', '.join(ACTIVATIONS)}"
        )
    return activation


def checked_layers(
    weights: Sequence[ArrayLike],
    biases: Sequence[ArrayLike],
    size: int,
    noun: str,
    outputs: int | None = None,
) -> Layers:
    """Return layers as float32.

    Parameters
    ----------
    weights, biases
        One matrix, shape (inputs, outputs), and one vector a layer.
    size
        Inputs of the first one.
    noun
        What an error calls a layer.
    outputs
        Outputs of the last one; None: any number.

    Raises
    ------
    ParameterError
        For layers that do not fit each other, and numbers that are not finite.
    """
    if len(weights) != len(biases) or len(weights) == 0:
        raise ParameterError(
            f"{len(weights)} weights and {len(biases)} biases are not accepted: one of each a layer"
        )
    layers, inputs = [], size
    for place, (weight, bias) in enumerate(zip(weights, biases, strict=True)):
        matrix = numbers(f"weights of {noun} {place}", weight, np.float32)
        vector = numbers(f"biases of {noun} {place}", bias, np.float32)
        last = place == len(weights) - 1
        wanted = outputs if last and outputs is not None else vector.size
        if matrix.shape != (inputs, wanted) or vector.shape != (wanted,) or wanted == 0:
            raise ParameterError(
                f"{noun} {place} has weights {matrix.shape} and biases {vector.shape}, which is "
                f"not accepted: ({inputs}, {wanted}) and ({wanted},)"
            )
        if not (np.isfinite(matrix).all() and np.isfinite(vector).all()):
            raise ParameterError(f"{noun} {place} holds numbers that are not finite")
        layers.append((matrix, vector))
        inputs = wanted
    return layers
