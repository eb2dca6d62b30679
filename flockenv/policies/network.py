"""Learned policies: small networks in an ``.npz`` file, evaluated with NumPy alone."""

import hashlib
import json
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv._io.arguments import items, real_numbers
from flockenv._io.array_file import read_arrays, write_arrays
from flockenv.envs.observation import BLOCKS, OBSERVATION_VERSION
from flockenv.errors import ParameterError, refuse_unknown, shown
from flockenv.policies.base import RowPolicy

if TYPE_CHECKING:
    import gymnasium

FORMAT = "flockenv policy 1"
"""First entry of every network's file."""

_LARGEST_FILE = 5 << 20
_HEADER = (
    *("format", "observation_version", "observation", "mirror_to_target", "action_mode"),
    *("decision_period_s", "activation", "made"),
)
_OPTIONS = ("observation", "mirror_to_target", "action_mode", "decision_period_s")


ACTIVATIONS: Mapping[str, Callable[[NDArray[np.float32]], NDArray[np.float32]]] = {
    "tanh": np.tanh,
    "relu": partial(np.maximum, np.float32(0.0)),
}
"""What may stand between two layers."""


class NetworkPolicy(RowPolicy):
    """A fully connected network from one leader's observation to its rudder, shared by all leaders.

    A row's output does not depend on the other rows of its batch.

    Parameters
    ----------
    weights
        One matrix a layer, shape (inputs, outputs), float32; the last has one output.
    biases
        One vector a layer, shape (outputs,), float32.
    activation
        A name in `ACTIVATIONS`, between the layers; the last layer's output is clipped to [-1, 1].
    observation, mirror_to_target
        Layout of the observations, as in the environments' options of those names; the weights have
        to fit it.
    action_mode, decision_period_s
        What the output stands for, and for how long it is held: the environments' options of those
        names.
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
        activation: str = "tanh",
        *,
        observation: Mapping[str, Any] | None = None,
        mirror_to_target: bool = False,
        action_mode: str = "rudder",
        decision_period_s: float | None = None,
        provenance: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(observation=observation, mirror_to_target=mirror_to_target)
        refuse_unknown((action_mode,), _core.ACTION_MODES, "action mode")
        refuse_unknown((activation,), ACTIVATIONS, "activation")
        if decision_period_s is not None and not 0.0 < decision_period_s < math.inf:
            raise ParameterError(
                f"decision_period_s = {shown(decision_period_s)} is not accepted: a time in s"
            )
        self.action_mode = action_mode
        self.decision_period_s = None if decision_period_s is None else float(decision_period_s)
        self.activation = activation
        self.provenance = {str(name): str(text) for name, text in dict(provenance or {}).items()}
        matrices, vectors = items(weights, "weights"), items(biases, "biases")
        self._layers = _checked_layers(matrices, vectors, self._size)

    @classmethod
    def from_module(
        cls,
        module: Any,
        space: "gymnasium.Space[Any]",
        *,
        squashed: bool = False,
        provenance: Mapping[str, str] | None = None,
    ) -> Self:
        """Return a torch network as a policy that needs no torch.

        Parameters
        ----------
        module
            A ``torch.nn.Module`` from one leader's observation to its rudder: linear layers in the
            order in which they follow each other, with one of `ACTIVATIONS` between them. If the
            last layer has two outputs, the mean and the spread of a distribution, the mean is the
            rudder. Layers that change nothing (``Identity``, TorchRL's ``NormalParamExtractor``)
            are passed over.
        space
            The space of the observations that it was trained on, of one leader or of several: it
            holds the options that a policy depends on.
        squashed
            Whether the distribution puts the mean through a hyperbolic tangent, as TorchRL's
            ``TanhNormal``. The activation has to be "tanh" then.
        provenance
            As of `NetworkPolicy`.

        Raises
        ------
        ParameterError
            For other layers, for layers that do not fit, and for spaces of other environments.
        """
        from flockenv.envs.spaces import ObservationSpace

        if not isinstance(space, ObservationSpace):
            raise ParameterError(
                f"space = {shown(space)} is not accepted: the space of observations of an "
                "environment here"
            )
        layers, activation = _module_layers(module)
        weights, biases = (list(each) for each in zip(*layers, strict=True))
        if len(biases[-1]) == 2:
            weights[-1], biases[-1] = weights[-1][:, :1], biases[-1][:1]
        if squashed:
            if activation != "tanh":
                raise ParameterError(
                    f"activation = {activation!r} is not accepted with a squashed mean: 'tanh'"
                )
            weights.append(np.ones((1, 1), np.float32))
            biases.append(np.zeros(1, np.float32))
        options = space.policy_options()
        blocks = options["observation"]
        names = ("mirror_to_target", "action_mode", "decision_period_s")
        return cls(
            weights,
            biases,
            activation,
            observation={name: block for name, block in blocks.items() if block != BLOCKS[name]},
            **{name: options[name] for name in names},
            provenance=provenance,
        )

    @property
    def weights(self) -> list[NDArray[np.float32]]:
        """Copies of the layers' matrices, shape (inputs, outputs)."""
        return [weight.copy() for weight, _ in self._layers]

    @property
    def biases(self) -> list[NDArray[np.float32]]:
        """Copies of the layers' biases, shape (outputs,)."""
        return [bias.copy() for _, bias in self._layers]

    def _steer(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        between, values = ACTIVATIONS[self.activation], rows
        for place, (weight, bias) in enumerate(self._layers):
            values = _core.linear(values, weight, bias)
            if place < len(self._layers) - 1:
                values = between(values)
        return np.clip(values, -1.0, 1.0)[:, 0]

    def _contents(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Return the header of a file, without the provenance, and its arrays."""
        header = {name: getattr(self, name) for name in (*_OPTIONS, "activation")}
        arrays: dict[str, NDArray[Any]] = {}
        for place, (weight, bias) in enumerate(self._layers):
            arrays |= {f"weight_{place}": weight, f"bias_{place}": bias}
        return header, arrays

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the policy to an ``.npz`` file, whole or not at all.

        If it cannot be written, which is an OSError, what was there before is still there.
        """
        header, arrays = self._contents()
        whole = {"format": FORMAT, "observation_version": OBSERVATION_VERSION, **header}
        text = json.dumps({**whole, "made": self.provenance}, sort_keys=True)
        write_arrays(path, {"header": np.array(text), **arrays})

    @property
    def digest(self) -> str:
        """The first digits of the SHA-256 of layout and numbers alone."""
        header, arrays = self._contents()
        whole = hashlib.sha256(json.dumps(header, sort_keys=True).encode())
        for name in sorted(arrays):
            array = np.ascontiguousarray(arrays[name])
            whole.update(f"{name} {array.shape} {array.dtype.str}".encode() + array.tobytes())
        return f"sha256:{whole.hexdigest()[:12]}"

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a network from its ``.npz`` file, in which nothing is executed.

        Raises what `flockenv.policies.load` raises.
        """
        arrays = read_arrays(path, _LARGEST_FILE)
        try:
            header = json.loads(str(arrays.pop("header")).removeprefix("\ufeff"))
            refuse_unknown(header, _HEADER, "entry of a network's header")
            if header["format"] != FORMAT:
                raise ParameterError(f"format = {shown(header['format'])}, not {FORMAT!r}")
            version = header["observation_version"]
            if version != OBSERVATION_VERSION:
                raise ParameterError(
                    f"it was made for version {shown(version)} of the observation, not "
                    f"{OBSERVATION_VERSION}: train it again"
                )
            places = range(len(arrays) // 2)
            layers = [f"{kind}_{place}" for place in places for kind in ("weight", "bias")]
            refuse_unknown(arrays, layers, "array of a network")
            # An option that is younger than the file has its default.
            options = {name: header[name] for name in _OPTIONS if name in header}
            return cls(
                [arrays[f"weight_{place}"] for place in places],
                [arrays[f"bias_{place}"] for place in places],
                header["activation"],
                provenance=header["made"],
                **options,
            )
        except KeyError as error:
            raise ParameterError(f"{path} is no whole policy: it has no {error}") from error
        # Also of JSON that is nested without end.
        except (TypeError, ValueError, RecursionError) as error:
            raise ParameterError(f"{path} is no whole policy: {error}") from error

    def __repr__(self) -> str:
        sizes = [self._size, *(len(bias) for _, bias in self._layers)]
        return f"{type(self).__name__}({'-'.join(map(str, sizes))}, {self.activation})"


def _checked_layers(
    weights: Sequence[ArrayLike], biases: Sequence[ArrayLike], size: int
) -> list[tuple[NDArray[np.float32], NDArray[np.float32]]]:
    """Return layers from so many inputs to one output, as float32."""
    if len(weights) != len(biases) or len(weights) == 0:
        raise ParameterError(
            f"{len(weights)} weights and {len(biases)} biases are not accepted: one of each a layer"
        )
    layers, inputs = [], size
    for place, (weight, bias) in enumerate(zip(weights, biases, strict=True)):
        matrix, vector = (_singles(each, f"layer {place}") for each in (weight, bias))
        wanted = 1 if place == len(weights) - 1 else vector.size
        if matrix.shape != (inputs, wanted) or vector.shape != (wanted,) or wanted == 0:
            raise ParameterError(
                f"layer {place} has weights {matrix.shape} and biases {vector.shape}, but needs "
                f"({inputs}, {wanted}) and ({wanted},)"
            )
        if not (np.isfinite(matrix).all() and np.isfinite(vector).all()):
            raise ParameterError(f"layer {place} holds numbers that are not finite")
        layers.append((matrix, vector))
        inputs = wanted
    return layers


def _singles(values: ArrayLike, name: str) -> NDArray[np.float32]:
    """Return real numbers as float32, in which those beyond it are infinite."""
    found = real_numbers(values, name)
    if found.dtype.kind == "b" or np.ma.is_masked(found):
        raise ParameterError(f"{name} is not accepted: real numbers, all of them")
    with np.errstate(over="ignore"):
        return np.array(found, np.float32)


#: Names of torch's activations, and of layers that leave the mean as it is.
_MODULE_ACTIVATIONS = {"Tanh": "tanh", "ReLU": "relu"}
_PASSED_OVER = ("Identity", "NormalParamExtractor")


def _module_layers(
    module: Any,
) -> tuple[list[tuple[NDArray[np.float32], NDArray[np.float32]]], str]:
    """Return the matrices and biases of a torch module, and what stands between them."""
    layers: list[tuple[NDArray[np.float32], NDArray[np.float32]]] = []
    between: list[str] = []
    for layer in module.modules():
        kind = type(layer).__name__
        if next(layer.children(), None) is not None or kind in _PASSED_OVER:
            continue
        if kind == "Linear" and len(layers) == len(between) and layer.bias is not None:
            weight, bias = (each.detach().cpu().numpy() for each in (layer.weight, layer.bias))
            layers.append((weight.T, bias))
        elif kind in _MODULE_ACTIVATIONS and len(layers) == len(between) + 1:
            between.append(_MODULE_ACTIVATIONS[kind])
        else:
            raise ParameterError(
                f"a module with the layer {shown(layer)} at this place is not accepted: linear "
                f"layers with biases and one of {', '.join(_MODULE_ACTIVATIONS)} between them"
            )
    if len(layers) != len(between) + 1 or len(set(between)) > 1:
        raise ParameterError(
            f"a module with {len(layers)} linear layers and the activations {between} is not "
            "accepted: one and the same activation between each two layers"
        )
    return layers, between[0] if between else "tanh"
