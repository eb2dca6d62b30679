"""Learned policies: small networks in an ``.npz`` file, evaluated with NumPy alone."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Self

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv._io.npz_header import array_of, entry_of
from flockenv.envs.observation import BLOCKS, ObservationSpace, observation_entries
from flockenv.errors import ParameterError, refuse_unknown, shown
from flockenv.policies.encoders import (
    ACTIVATIONS,
    ENCODERS,
    Encoder,
    checked_activation,
    checked_layers,
)
from flockenv.policies.files import PROVENANCE, StoredPolicy

__all__ = ["ACTIVATIONS", "NetworkPolicy"]


class NetworkPolicy(StoredPolicy):
    """A fully connected network from one leader's observation to its rudder, shared by all leaders.

    Parameters
    ----------
    weights
        One matrix a layer, shape (inputs, outputs), float32; the last has one output.
    biases
        One vector a layer, shape (outputs,), float32.
    activation
        A name in `ACTIVATIONS`, between the layers; the last layer's output is clipped to [-1, 1].
    observation, mirror_to_target
        Layout of the observations, as in the environments' options of those names. Without weights
        for the whole layout the policy is refused.
    action_mode, decision_period_s
        What the output stands for, and for how long it is held: the environments' options of those
        names.
    encoder
        What the first layer takes in place of the observation; None: the observation itself. Its
        layout has to be the policy's.
    squashed
        Whether the last layer's output goes through a hyperbolic tangent, where it is clipped
        otherwise.
    provenance
        Where it comes from: any short texts by name, such as the command, the seed and the samples.

    Raises
    ------
    ParameterError
        For layers that do not fit each other or the layout, numbers that are not finite, and
        unknown activations.
    """

    def __init__(
        self,
        weights: Sequence[ArrayLike],
        biases: Sequence[ArrayLike],
        activation: str = "tanh",
        *,
        observation: Mapping[str, Any] | None = None,
        mirror_to_target: bool = False,
        action_mode: str = "rudder",
        decision_period_s: float | None = None,
        encoder: Encoder | None = None,
        squashed: bool = False,
        provenance: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(observation, mirror_to_target)
        refuse_unknown((action_mode,), _core.action_modes(), "action mode")
        if decision_period_s is not None and not 0.0 < decision_period_s < math.inf:
            raise ParameterError(
                f"decision_period_s = {decision_period_s!r} is not accepted: a positive time in s"
            )
        self.action_mode = action_mode
        self.decision_period_s = None if decision_period_s is None else float(decision_period_s)
        self.activation = activation
        self.provenance = {str(name): str(text) for name, text in (provenance or {}).items()}
        self.squashed = bool(squashed)
        self._encoder = encoder
        size = self._size
        if encoder is not None:
            if not isinstance(encoder, Encoder):
                raise ParameterError(f"encoder = {shown(encoder)} is not accepted: an Encoder")
            encoder.check(self.observation, self.mirror_to_target)
            if encoder.names != [each.name for each in observation_entries(self.observation)]:
                raise ParameterError(
                    f"encoder is not accepted with observation = {self.observation!r}: it reads "
                    f"another layout, of {len(encoder.names)} numbers"
                )
            size = encoder.size
        self._layers = checked_layers(weights, biases, size, "layer", outputs=1)
        checked_activation(activation)

    @classmethod
    def from_module(
        cls,
        module: Any,
        space: gymnasium.Space[Any],
        *,
        squashed: bool = False,
        provenance: Mapping[str, str] | None = None,
    ) -> Self:
        """Return a torch network as a policy that needs no torch.

        Parameters
        ----------
        module
            A ``torch.nn.Module`` from one leader's observation to its rudder: linear layers in the
            order in which they follow each other, with one of `ACTIVATIONS` between them. Where
            the last layer has two outputs, the mean and the spread of a distribution, the mean is
            the rudder. Layers that change nothing (``Identity``, TorchRL's
            ``NormalParamExtractor``) are passed over.
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
        blocks = space.options["observation"]
        names = ("mirror_to_target", "action_mode", "decision_period_s")
        return cls(
            weights,
            biases,
            activation,
            observation={name: block for name, block in blocks.items() if block != BLOCKS[name]},
            **{name: space.options[name] for name in names},
            provenance=provenance,
        )

    @property
    def encoder(self) -> Encoder | None:
        """What the first layer takes in place of the observation."""
        return self._encoder

    @property
    def weights(self) -> list[NDArray[np.float32]]:
        """Copies of the layers' matrices, shape (inputs, outputs)."""
        return [weight.copy() for weight, _ in self._layers]

    @property
    def biases(self) -> list[NDArray[np.float32]]:
        """Copies of the layers' biases, shape (outputs,)."""
        return [bias.copy() for _, bias in self._layers]

    def last_inputs(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return what the last layer takes, shape (rows, inputs), for rows of observations.

        Raises
        ------
        ParameterError
            If the shape of `rows` is not (rows, numbers of one leader's observation).
        """
        if rows.ndim != 2 or rows.shape[1] != self._size:
            raise ParameterError(
                f"rows with shape {rows.shape} are not accepted: (rows, {self._size})"
            )
        between = ACTIVATIONS[self.activation]
        values = rows if self._encoder is None else self._encoder(rows)
        for weight, bias in self._layers[:-1]:
            values = between(values @ weight + bias)
        return values

    def _steer(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        weight, bias = self._layers[-1]
        outputs = self.last_inputs(rows) @ weight + bias
        rudders: NDArray[np.float32] = (
            np.tanh(outputs) if self.squashed else np.clip(outputs, -1.0, 1.0)
        )
        return rudders[:, 0]

    def _contents(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        header = {
            "observation": self.observation,
            "mirror_to_target": self.mirror_to_target,
            "activation": self.activation,
            "layers": len(self._layers),
            PROVENANCE: self.provenance,
        }
        # Only where they differ from the default, so that files and digests of rudders stay.
        if self.action_mode != "rudder":
            header["action_mode"] = self.action_mode
        if self.decision_period_s is not None:
            header["decision_period_s"] = self.decision_period_s
        if self.squashed:
            header["squashed"] = True
        arrays: dict[str, NDArray[Any]] = {}
        if self._encoder is not None:
            header["encoder"] = self._encoder.kind
            encoder_header, arrays = self._encoder.contents()
            header |= encoder_header
        for place, (weight, bias) in enumerate(self._layers):
            arrays |= {f"weight_{place}": weight, f"bias_{place}": bias}
        return header, arrays

    @classmethod
    def from_file(cls, header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> Self:
        """Return the policy of a file's header and arrays.

        Raises
        ------
        ParameterError
            For entries that are missing or not as `save` writes them.
        """
        places = range(entry_of(header, "layers", int))
        return cls(
            [array_of(arrays, f"weight_{place}") for place in places],
            [array_of(arrays, f"bias_{place}") for place in places],
            entry_of(header, "activation", str),
            observation=entry_of(header, "observation", dict),
            mirror_to_target=entry_of(header, "mirror_to_target", bool),
            encoder=_encoder_of(header, arrays),
            provenance=entry_of(header, PROVENANCE, dict),
            **_action_of(header),
        )

    def __repr__(self) -> str:
        first = [] if self._encoder is None else [f"{self._encoder.kind} {self._encoder.size}"]
        sizes = [self._size, *first, *(len(bias) for _, bias in self._layers)]
        return f"{type(self).__name__}({'-'.join(map(str, sizes))}, {self.activation})"


def _action_of(header: Mapping[str, Any]) -> dict[str, Any]:
    kinds = {"action_mode": str, "decision_period_s": float, "squashed": bool}
    return {name: entry_of(header, name, kind) for name, kind in kinds.items() if name in header}


def _encoder_of(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> Encoder | None:
    if "encoder" not in header:
        return None
    kind = entry_of(header, "encoder", str)
    if kind not in ENCODERS:
        raise ParameterError(f"encoder = {kind!r} is not accepted: one of {', '.join(ENCODERS)}")
    return ENCODERS[kind].from_contents(header, arrays, entry_of(header, "observation", dict))


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
