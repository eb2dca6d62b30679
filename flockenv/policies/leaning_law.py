"""`LeaningLaw`: the damped law about a heading that leans outward by the observation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv._io.npz_header import array_of, entry_of
from flockenv.envs.observation import observation_entries
from flockenv.errors import ParameterError, refuse_unknown
from flockenv.policies.base import numbers
from flockenv.policies.files import PROVENANCE, StoredPolicy
from flockenv.policies.laws import DampedLaw
from flockenv.policies.lean_features import (
    FEATURES,
    FELLOW_FEATURES,
    FURTHER_FEATURES,
    block_of,
    features,
    observed_features,
)

__all__ = [
    "FEATURES",
    "FELLOW_FEATURES",
    "FURTHER_FEATURES",
    "GAINS",
    "HiddenUnits",
    "LeaningLaw",
    "features",
    "leaned",
    "observed_features",
]

GAINS = ("gain", "backward_gain", "damping")
"""As of `DampedLaw`."""

_LARGEST_LEAN = 1.2


@dataclass(frozen=True, slots=True, eq=False)
class HiddenUnits:
    """Units that make a lean nonlinear: Σ output·tanh(bias + Σ weight·feature) in rad.

    Attributes
    ----------
    weights : Mapping
        One number per unit, by the feature's name; 0 for features left out.
    biases, outputs : numpy.ndarray
        Shape (units,); outputs in rad.

    Raises
    ------
    ParameterError
        For unknown features, lengths that differ, and numbers that are not finite.
    """

    weights: Mapping[str, ArrayLike]
    biases: ArrayLike
    outputs: ArrayLike

    def __post_init__(self) -> None:
        refuse_unknown(self.weights, (*FEATURES, *FURTHER_FEATURES), "feature")
        biases = numbers("biases of hidden units", self.biases)
        vectors = {"biases": biases, "outputs": numbers("outputs of hidden units", self.outputs)}
        weights: Mapping[str, NDArray[Any]] = {
            name: numbers(f"{name} of hidden units", each) for name, each in self.weights.items()
        }
        for name, each in {**vectors, **weights}.items():
            if each.ndim != 1 or each.size == 0 or each.shape != biases.shape:
                raise ParameterError(
                    f"{name} of hidden units with shape {each.shape} is not accepted: one number "
                    f"per unit, as in biases {biases.shape}"
                )
            if not np.isfinite(each).all():
                raise ParameterError(f"{name} of hidden units holds numbers that are not finite")
        for name, given in {"weights": weights, **vectors}.items():
            object.__setattr__(self, name, given)

    def __len__(self) -> int:
        return len(np.asarray(self.biases))

    def arrays(self, names: Sequence[str]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
        """Return weights, shape (features, units), of the named features; biases; outputs."""
        zeros = np.zeros(len(self))
        rows = np.array([self.weights.get(name, zeros) for name in names])
        return rows, np.asarray(self.biases), np.asarray(self.outputs)


def leaned(
    rows: NDArray[np.float32],
    bias: NDArray[Any],
    weights: NDArray[Any],
    names: list[str],
    wanted: Sequence[str] = FEATURES,
    hidden: tuple[NDArray[Any], NDArray[Any], NDArray[Any]] | None = None,
) -> NDArray[np.float32]:
    """Return mirrored observations as if leaders headed further inward than they do, by their lean.

    Steering that along the target's tangent turns a leader outward of the tangent by as much.

    Parameters
    ----------
    rows
        Shape (..., leaders, observation size).
    bias, weights
        Shapes (...) and (..., number of features): one law, or one a stack of rows.
    names
        The names of an observation's entries, in order.
    wanted
        The features of the weights.
    hidden
        Weights, biases and outputs of hidden units, shapes (..., number of features, units),
        (..., units) and (..., units).

    Returns
    -------
    numpy.ndarray
        Shape (..., leaders, observation size), float32.
    """
    seen = features(rows, names, wanted)
    lean = np.asarray(bias)[..., None] + (seen @ weights[..., None])[..., 0]
    if hidden is not None:
        inner, biases, outputs = hidden
        units = np.tanh(seen @ inner + biases[..., None, :])
        lean = lean + (units @ outputs[..., None])[..., 0]
    lean = _LARGEST_LEAN * np.tanh(lean / _LARGEST_LEAN)
    cos, sin = names.index("cos_orientation"), names.index("sin_orientation")
    # The target is clockwise, and so is a growing orientation; 0 is outward.
    orientation = (rows[..., cos] + 1j * rows[..., sin]) * np.exp(1j * lean)
    turned = np.array(rows, np.float32)
    turned[..., cos], turned[..., sin] = orientation.real, orientation.imag
    return turned


class LeaningLaw(StoredPolicy):
    """The damped law about a heading that leans outward by a linear function of what is seen.

    The desired heading is the target's tangent, turned outward by 1.2·tanh(lean/1.2) rad with
    lean = bias + Σ weight·feature (`FEATURES`), and with hidden units Σ output·tanh(…) more
    (`HiddenUnits`). About it the leader steers as with `DampedLaw`.
    Observations have to be mirrored to the target, which the environments' option of that name
    does.

    Parameters
    ----------
    gains
        The three `GAINS` by name.
    bias
        Outward lean in rad where every feature is 0.
    weights
        Rad a feature, by its name in `FEATURES` or `FURTHER_FEATURES`; 0 for those left out.
    hidden
        Hidden units; without them the lean is linear in the features.
    observation
        Blocks of the observation that differ from the default layout.
    provenance
        Its provenance: any short texts by name, such as the command, the seed and the samples.

    Raises
    ------
    ParameterError
        For unknown names, numbers that are not finite, and layouts without the blocks of the
        features.

    Attributes
    ----------
    features : tuple of str
        `FEATURES`, and those of `FURTHER_FEATURES` that weights or hidden units name.
    """

    def __init__(
        self,
        gains: Mapping[str, float],
        bias: float,
        weights: Mapping[str, float],
        *,
        hidden: HiddenUnits | None = None,
        observation: Mapping[str, Any] | None = None,
        provenance: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(observation, mirror_to_target=True)
        self.gains = _checked(gains, GAINS)
        if len(self.gains) < len(GAINS):
            raise ParameterError(f"gains = {dict(gains)!r} are not accepted: {', '.join(GAINS)}")
        self.weights = _checked(weights, (*FEATURES, *FURTHER_FEATURES))
        self.hidden = hidden
        self.bias = _checked({"bias": bias}, ("bias",))["bias"]
        self.provenance = {str(name): str(text) for name, text in (provenance or {}).items()}
        self._names = [entry.name for entry in observation_entries(self.observation)]
        if not observed_features(self._names):
            raise ParameterError(
                f"observation = {self.observation!r} is not accepted: a leaning leader needs "
                "the blocks own, neighbors and order"
            )
        named = {*self.weights, *(hidden.weights if hidden else ())}
        self.features = (*FEATURES, *(name for name in FURTHER_FEATURES if name in named))
        for name in self.features:
            if name not in observed_features(self._names):
                raise ParameterError(
                    f"observation = {self.observation!r} is not accepted with the feature {name}: "
                    f"switch the block {block_of(name)} on"
                )
        self._damped = DampedLaw(**self.gains, observation=observation, mirror_to_target=True)
        self._weights = np.array([self.weights.get(name, 0.0) for name in self.features])
        self._hidden = hidden.arrays(self.features) if hidden else None

    def _steer(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        bias = np.asarray(self.bias)
        turned = leaned(rows, bias, self._weights, self._names, self.features, self._hidden)
        rudders: NDArray[np.float32] = self._damped.predict(turned)[0][:, 0]
        return rudders

    def _contents(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        header = {
            # Versions without hidden units would read their laws as linear ones.
            "kind": "leaning law" if self._hidden is None else "nonlinear leaning law",
            "observation": self.observation,
            "features": self.features,
            PROVENANCE: self.provenance,
        }
        arrays = {
            "gains": np.array([self.gains[name] for name in GAINS]),
            "bias": np.array(self.bias),
            "weights": self._weights,
        }
        if self._hidden is not None:
            arrays |= dict(zip(_HIDDEN, self._hidden, strict=True))
        return header, arrays

    @classmethod
    def from_file(cls, header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> Self:
        """Return the law of a file's header and arrays.

        Raises
        ------
        ParameterError
            For entries that are missing or not as `save` writes them.
        """
        names = header.get("features")
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise ParameterError(f"features = {names!r} is not accepted: a list of names")
        gains = array_of(arrays, "gains", (len(GAINS),)).tolist()
        weights = array_of(arrays, "weights", (len(names),)).tolist()
        hidden = None
        if header.get("kind") == "nonlinear leaning law":
            units = array_of(arrays, _HIDDEN[1]).shape
            shapes = ((len(names), *units), units, units)
            inner, *rest = (array_of(arrays, *each) for each in zip(_HIDDEN, shapes, strict=True))
            hidden = HiddenUnits(dict(zip(names, inner, strict=True)), *rest)
        return cls(
            dict(zip(GAINS, gains, strict=True)),
            array_of(arrays, "bias", ()).item(),
            dict(zip(names, weights, strict=True)),
            hidden=hidden,
            observation=entry_of(header, "observation", dict),
            provenance=entry_of(header, PROVENANCE, dict),
        )

    def __repr__(self) -> str:
        gains = ", ".join(f"{name}={value:.3g}" for name, value in self.gains.items())
        units = f", {len(self.hidden)} hidden units" if self.hidden else ""
        numbers = f"bias={self.bias:.3g}, {len(self.weights)} weights{units}"
        return f"{type(self).__name__}({gains}, {numbers})"


#: The arrays of hidden units in a file.
_HIDDEN = ("hidden_weights", "hidden_biases", "hidden_outputs")


def _checked(values: Mapping[str, float], known: tuple[str, ...]) -> dict[str, float]:
    for name, value in values.items():
        if name not in known:
            raise ParameterError(f"{name!r} is not accepted: one of {', '.join(known)}")
        if not np.isfinite(value):
            raise ParameterError(f"{name} = {value!r} is not accepted: a finite number")
    return {name: float(value) for name, value in values.items()}
