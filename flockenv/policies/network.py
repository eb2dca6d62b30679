"""Learned policies: small networks in an ``.npz`` file, evaluated with NumPy alone."""

import hashlib
import json
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv._io.arguments import items, number, real_numbers
from flockenv._io.array_file import read_arrays, write_arrays
from flockenv.envs.observation import BLOCKS, OBSERVATION_VERSION
from flockenv.errors import ParameterError, refuse_unknown, short_repr
from flockenv.policies.base import RowPolicy
from flockenv.policies.torch_module import read_module

if TYPE_CHECKING:
    import gymnasium
    import torch

FORMAT = "flockenv policy 2"
"""The entry ``format`` in the header of every network's file."""

_LARGEST_FILE = 5 << 20
_HEADER = (
    *("format", "observation_version", "observation", "mirror_to_target", "action_mode"),
    *("decision_period_s", "activations", "norms", "made"),
)
_OPTIONS = ("observation", "mirror_to_target", "action_mode", "decision_period_s")


def _elu(values: NDArray[np.float32]) -> NDArray[np.float32]:
    zero = np.float32(0.0)
    return np.asarray(np.maximum(values, zero) + np.expm1(np.minimum(values, zero)), np.float32)


def _gelu(values: NDArray[np.float32]) -> NDArray[np.float32]:
    erf = np.vectorize(math.erf, [float])(values / math.sqrt(2.0))
    return np.asarray(0.5 * values * (1.0 + erf), np.float32)


ACTIVATIONS: Mapping[str, Callable[[NDArray[np.float32]], NDArray[np.float32]]] = {
    "tanh": np.tanh,
    "relu": partial(np.maximum, np.float32(0.0)),
    "elu": _elu,
    "gelu": _gelu,
    "identity": lambda values: values,
}
"""Activations after a layer; "identity" changes nothing."""

Norm = tuple[ArrayLike, ArrayLike, float]
"""A layer's normalization, as in torch's ``LayerNorm``: scale, shift, and the ``eps`` that is added
to the variance."""


@dataclass(frozen=True)
class _Layer:
    """A linear layer, its normalization if it has one, and its activation."""

    #: Shape (inputs, outputs).
    weight: NDArray[np.float32]
    bias: NDArray[np.float32]
    norm: tuple[NDArray[np.float32], NDArray[np.float32], float] | None
    activation: str

    def __call__(self, values: NDArray[np.float32]) -> NDArray[np.float32]:
        values = _core.linear(values, self.weight, self.bias)
        if self.norm is not None:
            scale, shift, epsilon = self.norm
            centered = values - values.mean(axis=1, keepdims=True)
            variance = np.square(centered).mean(axis=1, keepdims=True)
            values = centered / np.sqrt(variance + np.float32(epsilon)) * scale + shift
        return ACTIVATIONS[self.activation](values)


class NetworkPolicy(RowPolicy):
    """A fully connected network from one leader's observation to its rudder, shared by all leaders.

    A row's output does not depend on the other rows of its batch.

    Parameters
    ----------
    weights
        One matrix per layer, shape (inputs, outputs), float32; the last has one output.
    biases
        One vector per layer, shape (outputs,), float32.
    activation
        A name in `ACTIVATIONS`, for the activation between layers; or a list with the activation
        after each layer, the last included. The output is clipped to [-1, 1].
    norms
        For each layer None, or the normalization before its activation, as in torch's
        ``LayerNorm``: scale and shift, shape (outputs,), and the ``eps`` that is added to the
        variance.
    observation, mirror_to_target
        Layout of the observations, as in the environments' options of those names; the weights have
        to fit it.
    action_mode, decision_period_s
        Meaning of the output, and how long it is held: the environments' options of those names.
    provenance
        Its origin: any short texts by name, such as the command, the seed and the samples.

    Raises
    ------
    ParameterError
        For layers that do not fit each other or the layout, numbers that are not finite, and
        unknown activations.
    """

    def __init__(
        self,
        weights: Iterable[ArrayLike],
        biases: Iterable[ArrayLike],
        activation: str | Sequence[str] = "tanh",
        *,
        norms: Sequence[Norm | None] | None = None,
        observation: Mapping[str, object] | None = None,
        mirror_to_target: bool = False,
        action_mode: str = "rudder",
        decision_period_s: float | None = None,
        provenance: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(observation=observation, mirror_to_target=mirror_to_target)
        refuse_unknown((action_mode,), _core.ACTION_MODES, "action mode")
        period_s = (
            None if decision_period_s is None else number(decision_period_s, "decision_period_s")
        )
        if period_s is not None and not 0.0 < period_s < math.inf:
            raise ParameterError(
                f"decision_period_s = {short_repr(period_s)} is not accepted: a time in s"
            )
        self.action_mode = action_mode
        self.decision_period_s = None if period_s is None else float(period_s)
        self.provenance = {str(name): str(text) for name, text in dict(provenance or {}).items()}
        matrices, vectors = items(weights, "weights"), items(biases, "biases")
        self._layers = _checked_layers(matrices, vectors, norms, activation, self._observation_size)

    @classmethod
    def from_module(
        cls,
        module: "torch.nn.Module",
        space: "gymnasium.Space[Any]",
        *,
        squashed: bool = False,
        has_spread: bool = False,
        provenance: Mapping[str, str] | None = None,
    ) -> Self:
        """Return a torch network as a policy that needs no torch.

        Parameters
        ----------
        module
            A ``torch.nn.Module`` from one leader's observation to its rudder: linear layers in the
            order of their use. Each may be followed by a ``LayerNorm``, and by one of Tanh, ReLU,
            ELU and GELU. Layers that change nothing (``Identity``, and ``Dropout``, which acts in
            training alone) are skipped. The module is run on a few random observations. It is
            refused if its output is not that of its layers in this order, for example because its
            ``forward`` does more.
        space
            The observation space that it was trained on, of one leader or of several: it holds the
            options that a policy depends on.
        squashed
            Whether the distribution puts the mean through a hyperbolic tangent, as TorchRL's
            ``TanhNormal``.
        has_spread
            Whether the last layer has two outputs, the mean and the spread of a distribution. The
            mean is the rudder. A last ``NormalParamExtractor`` of TorchRL has the same effect.
        provenance
            As for `NetworkPolicy`.

        Raises
        ------
        ParameterError
            For other layers, for layers that do not fit, and for spaces of other environments.
        """
        from flockenv.envs.spaces import ObservationSpace

        if not isinstance(space, ObservationSpace):
            raise ParameterError(
                f"space = {short_repr(space)} is not accepted: the observation space of an "
                "environment of flockenv"
            )
        layers = read_module(module, has_spread=has_spread)
        activations = [layer.activation for layer in layers]
        if squashed and activations[-1] != "identity":
            raise ParameterError(
                f"squashed = True is not accepted: {activations[-1]} follows the last layer already"
            )
        if squashed:
            activations[-1] = "tanh"
        options = space.policy_options()
        blocks = options["observation"]
        names = ("mirror_to_target", "action_mode", "decision_period_s")
        return cls(
            [layer.weight for layer in layers],
            [layer.bias for layer in layers],
            activations,
            norms=[layer.norm for layer in layers],
            observation={name: block for name, block in blocks.items() if block != BLOCKS[name]},
            **{name: options[name] for name in names},
            provenance=provenance,
        )

    @property
    def activations(self) -> list[str]:
        """The activation after each layer."""
        return [layer.activation for layer in self._layers]

    @property
    def weights(self) -> list[NDArray[np.float32]]:
        """Copies of the layers' matrices, shape (inputs, outputs)."""
        return [layer.weight.copy() for layer in self._layers]

    @property
    def biases(self) -> list[NDArray[np.float32]]:
        """Copies of the layers' biases, shape (outputs,)."""
        return [layer.bias.copy() for layer in self._layers]

    def _steer(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        values = rows
        for layer in self._layers:
            values = layer(values)
        return np.clip(values, -1.0, 1.0)[:, 0]

    def _contents(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Return the header of a file, without the provenance, and its arrays."""
        epsilons: list[float | None] = []
        arrays: dict[str, NDArray[Any]] = {}
        for index, layer in enumerate(self._layers):
            arrays |= {f"weight_{index}": layer.weight, f"bias_{index}": layer.bias}
            epsilon = None
            if layer.norm is not None:
                scale, shift, epsilon = layer.norm
                arrays |= {f"scale_{index}": scale, f"shift_{index}": shift}
            epsilons.append(epsilon)
        header = {name: getattr(self, name) for name in _OPTIONS}
        header |= {"activations": self.activations, "norms": epsilons}
        return header, arrays

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the policy to an ``.npz`` file, whole or not at all.

        If it cannot be written, an OSError is raised and the old file is still there.
        """
        header, arrays = self._contents()
        stored = {"format": FORMAT, "observation_version": OBSERVATION_VERSION, **header}
        text = json.dumps({**stored, "made": self.provenance}, sort_keys=True)
        write_arrays(path, {"header": np.array(text), **arrays})

    @property
    def digest(self) -> str:
        """``sha256:`` and 12 digits of the SHA-256 of the policy's options and numbers."""
        header, arrays = self._contents()
        digest = hashlib.sha256(json.dumps(header, sort_keys=True).encode())
        for name in sorted(arrays):
            array = np.ascontiguousarray(arrays[name])
            digest.update(f"{name} {array.shape} {array.dtype.str}".encode() + array.tobytes())
        return f"sha256:{digest.hexdigest()[:12]}"

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a network from its ``.npz`` file, in which nothing is executed.

        Raises the errors of `flockenv.policies.load`.
        """
        arrays = read_arrays(path, _LARGEST_FILE)
        try:
            header = _checked_header(str(arrays.pop("header")))
            activations, epsilons = header["activations"], header["norms"]
            indices = range(len(items(activations, "activations")))
            norm_indices = [index for index in indices if epsilons[index] is not None]
            names = [f"{kind}_{index}" for index in indices for kind in ("weight", "bias")]
            names += [f"{kind}_{index}" for index in norm_indices for kind in ("scale", "shift")]
            refuse_unknown(arrays, names, "array of a network")
            norms = [
                (arrays[f"scale_{index}"], arrays[f"shift_{index}"], epsilons[index])
                if index in norm_indices
                else None
                for index in indices
            ]
            # An option that is missing from the file has its default.
            options = {name: header[name] for name in _OPTIONS if name in header}
            return cls(
                [arrays[f"weight_{index}"] for index in indices],
                [arrays[f"bias_{index}"] for index in indices],
                activations,
                norms=norms,
                provenance=header["made"],
                **options,
            )
        except KeyError as error:
            raise ParameterError(f"{path} is not a complete policy: it has no {error}") from error
        # Deeply nested JSON raises this error, too.
        except (TypeError, ValueError, IndexError, RecursionError) as error:
            raise ParameterError(f"{path} is not a complete policy: {error}") from error

    def __repr__(self) -> str:
        sizes = [self._observation_size, *(len(layer.bias) for layer in self._layers)]
        *hidden, last = self.activations
        activations = ", ".join(dict.fromkeys(hidden)) or "linear"
        activations += "" if last == "identity" else f", then {last}"
        return f"{type(self).__name__}({'-'.join(map(str, sizes))}, {activations})"


def _checked_header(text: str) -> dict[str, Any]:
    """Return the header of a network's file; refuse other formats and observation versions."""
    header: dict[str, Any] = json.loads(text.removeprefix("\ufeff"))
    refuse_unknown(header, _HEADER, "entry of a network's header")
    if header["format"] != FORMAT:
        raise ParameterError(f"format = {short_repr(header['format'])}, not {FORMAT!r}")
    version = header["observation_version"]
    if version != OBSERVATION_VERSION:
        raise ParameterError(
            f"it was made for version {short_repr(version)} of the observation, not "
            f"{OBSERVATION_VERSION}: train it again"
        )
    return header


def _checked_layers(
    weights: Sequence[ArrayLike],
    biases: Sequence[ArrayLike],
    norms: Sequence[Norm | None] | None,
    activation: str | Sequence[str],
    observation_size: int,
) -> list[_Layer]:
    """Return layers from one leader's observation to one output, as float32."""
    count = len(weights)
    if count != len(biases) or count == 0:
        raise ParameterError(
            f"{count} weights and {len(biases)} biases are not accepted: one of each a layer"
        )
    layer_norms: Sequence[Norm | None] = [None] * count if norms is None else items(norms, "norms")
    activations = _checked_activations(activation, count)
    if (len(layer_norms), len(activations)) != (count, count):
        raise ParameterError(
            f"{len(layer_norms)} norms and {len(activations)} activations are not accepted: one of "
            f"each for {count} layers"
        )
    layers, inputs = [], observation_size
    for index, (weight, bias) in enumerate(zip(weights, biases, strict=True)):
        matrix, vector = (_as_float32(values, f"layer {index}") for values in (weight, bias))
        outputs = 1 if index == count - 1 else vector.size
        if matrix.shape != (inputs, outputs) or vector.shape != (outputs,) or outputs == 0:
            reason = f": one leader observes {inputs} numbers" if index == 0 else ""
            raise ParameterError(
                f"layer {index} has weights {matrix.shape} and biases {vector.shape}, but needs "
                f"({inputs}, {outputs}) and ({outputs},){reason}"
            )
        if not (np.isfinite(matrix).all() and np.isfinite(vector).all()):
            raise ParameterError(f"layer {index} holds numbers that are not finite")
        norm = _checked_norm(layer_norms[index], outputs, f"the norm of layer {index}")
        layers.append(_Layer(matrix, vector, norm, activations[index]))
        inputs = outputs
    return layers


def _checked_activations(activation: str | Sequence[str], count: int) -> Sequence[str]:
    """Return the activation after each layer; a single name is for all layers but the last."""
    if isinstance(activation, str):
        refuse_unknown((activation,), ACTIVATIONS, "activation")
        return [*[activation] * (count - 1), "identity"]
    activations: Sequence[str] = items(activation, "activation")
    refuse_unknown(activations, ACTIVATIONS, "activation")
    return activations


def _checked_norm(
    norm: Norm | None, size: int, name: str
) -> tuple[NDArray[np.float32], NDArray[np.float32], float] | None:
    """Return a layer's normalization with float32 arrays (size,); refuse other shapes."""
    if norm is None:
        return None
    if len(items(norm, name)) != 3:
        raise ParameterError(f"{name} is not accepted: scale, shift and a number")
    scale, shift = (_as_float32(values, name) for values in norm[:2])
    epsilon = float(number(norm[2], name))
    if not (scale.shape == shift.shape == (size,) and 0.0 <= epsilon < math.inf):
        raise ParameterError(
            f"{name} has scales {scale.shape}, shifts {shift.shape} and {epsilon:g}, but needs "
            f"({size},), ({size},) and a number of at least 0"
        )
    if not (np.isfinite(scale).all() and np.isfinite(shift).all()):
        raise ParameterError(f"{name} holds numbers that are not finite")
    return scale, shift, epsilon


def _as_float32(values: ArrayLike, name: str) -> NDArray[np.float32]:
    """Return real numbers as float32; numbers beyond its range become infinite."""
    array = real_numbers(values, name)
    if array.dtype.kind == "b" or np.ma.is_masked(array):
        raise ParameterError(f"{name} is not accepted: real numbers, all of them")
    with np.errstate(over="ignore"):
        return np.array(array, np.float32)
