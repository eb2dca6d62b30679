"""`LeaningLaw`: the damped law about a heading that leans outward by the observation."""

from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from flockenv._io.moved_modules import renamed_argument
from flockenv._io.npz_header import array_of, entry_of
from flockenv.envs.observation import observation_entries
from flockenv.errors import ParameterError
from flockenv.policies.files import PROVENANCE, StoredPolicy
from flockenv.policies.laws import DampedLaw

__all__ = ["FEATURES", "GAINS", "LeaningLaw", "features", "leaned"]

GAINS = ("gain", "backward_gain", "damping")
"""As of `DampedLaw`."""

_OWN = ("radial_position", "outward_velocity", "clockwise_velocity", "forward_velocity")
_ORDER = (
    "mean_cos_orientation",
    "mean_sin_orientation",
    "mean_outward_velocity",
    "mean_clockwise_velocity",
)

FEATURES = (
    *_OWN,
    "near_outer_wall",
    *_ORDER,
    "near",
    "near_outward",
    "near_ahead",
    "near_opposed",
    "near_turned",
    "near_outward_velocity",
    "near_clockwise_velocity",
    "opposed_outward",
    "opposed_ahead",
    "turned_outward",
    "turned_ahead",
    "leaders",
    "leaders_outward",
    "leaders_ahead",
)
"""The features of a leaning leader's lean.

They are entries of the observation by their names there; ``near_outer_wall``, how much the radial
position exceeds 0.6; and sums over the observed neighbors. Normal boats count with exp(-d²/2),
leaders (``leaders…``) with exp(-d²/8), where d is their distance in the observation's unit of 6
boat radii. The sums are of 1, the positions (``outward``, ``ahead``: clockwise), the velocities,
how far they head against the leader (``opposed``: (1 - cos of the relative heading)/2, ``turned``:
its sine) and products.
"""

_LARGEST_LEAN = 1.2
_WALL = 0.6


def features(rows: NDArray[Any], names: list[str]) -> NDArray[np.float64]:
    """Return the `FEATURES` of mirrored observations.

    Parameters
    ----------
    rows
        Shape (..., observation size).
    names
        The names of an observation's entries, in order.

    Returns
    -------
    numpy.ndarray
        Shape (..., number of features).
    """
    rows = np.asarray(rows, np.float64)
    first, width = names.index("present"), 8
    # Own entries come first, those of the order block last: some names stand in both.
    own = {name: rows[..., names.index(name)] for name in _OWN}
    order = [rows[..., names.index(name)] for name in _ORDER]
    neighbors = rows[..., first : first + width * names.count("present")]
    neighbors = neighbors.reshape(*rows.shape[:-1], -1, width)
    present, outward, ahead, cos, sin, outward_velocity, velocity, leads = np.moveaxis(
        neighbors, -1, 0
    )
    squared = outward**2 + ahead**2
    near = present * (1.0 - leads) * np.exp(-squared / 2.0)
    leaders = present * leads * np.exp(-squared / 8.0)
    opposed = (1.0 - cos) / 2.0
    sums = [
        near,
        near * outward,
        near * ahead,
        near * opposed,
        near * sin,
        near * outward_velocity,
        near * velocity,
        near * opposed * outward,
        near * opposed * ahead,
        near * sin * outward,
        near * sin * ahead,
        leaders,
        leaders * outward,
        leaders * ahead,
    ]
    wall = np.maximum(own["radial_position"] - _WALL, 0.0)
    columns = [*own.values(), wall, *order, *(each.sum(axis=-1) for each in sums)]
    return np.stack(columns, axis=-1)


def leaned(
    rows: NDArray[np.float32], bias: NDArray[Any], weights: NDArray[Any], names: list[str]
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

    Returns
    -------
    numpy.ndarray
        Shape (..., leaders, observation size), float32.
    """
    lean = np.asarray(bias)[..., None] + (features(rows, names) @ weights[..., None])[..., 0]
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
    lean = bias + Σ weight·feature (`FEATURES`). About it the leader steers as with `DampedLaw`.
    Observations have to be mirrored to the target, which the environments' option of that name
    does.

    Parameters
    ----------
    gains
        The three `GAINS` by name.
    bias
        Outward lean in rad where every feature is 0.
    weights
        Rad a feature, by its name; 0 for those left out.
    observation
        Blocks of the observation that differ from the default layout.
    provenance
        Its provenance: any short texts by name, such as the command, the seed and the samples.

    Raises
    ------
    ParameterError
        For unknown names, numbers that are not finite, and layouts without the blocks of the
        features.
    """

    @renamed_argument("made", "provenance")
    def __init__(
        self,
        gains: Mapping[str, float],
        bias: float,
        weights: Mapping[str, float],
        *,
        observation: Mapping[str, Any] | None = None,
        provenance: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(observation, mirror_to_target=True)
        self.gains = _checked(gains, GAINS)
        if len(self.gains) < len(GAINS):
            raise ParameterError(f"gains = {dict(gains)!r} are not accepted: {', '.join(GAINS)}")
        self.weights = _checked(weights, FEATURES)
        self.bias = _checked({"bias": bias}, ("bias",))["bias"]
        self.provenance = {str(name): str(text) for name, text in (provenance or {}).items()}
        self._names = [entry.name for entry in observation_entries(self.observation)]
        for name in (*_OWN, *_ORDER, "present"):
            if name not in self._names:
                raise ParameterError(
                    f"observation = {self.observation!r} is not accepted: a leaning leader needs "
                    "the blocks own, neighbors and order"
                )
        self._damped = DampedLaw(**self.gains, observation=observation, mirror_to_target=True)
        self._weights = np.array([self.weights.get(name, 0.0) for name in FEATURES])

    def _steer(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        turned = leaned(rows, np.asarray(self.bias), self._weights, self._names)
        rudders: NDArray[np.float32] = self._damped.predict(turned)[0][:, 0]
        return rudders

    def _contents(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        header = {
            "kind": "leaning law",
            "observation": self.observation,
            "features": FEATURES,
            PROVENANCE: self.provenance,
        }
        arrays = {
            "gains": np.array([self.gains[name] for name in GAINS]),
            "bias": np.array(self.bias),
            "weights": self._weights,
        }
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
        return cls(
            dict(zip(GAINS, gains, strict=True)),
            array_of(arrays, "bias", ()).item(),
            dict(zip(names, weights, strict=True)),
            observation=entry_of(header, "observation", dict),
            provenance=entry_of(header, PROVENANCE, dict),
        )

    def __repr__(self) -> str:
        gains = ", ".join(f"{name}={value:.3g}" for name, value in self.gains.items())
        return f"{type(self).__name__}({gains}, bias={self.bias:.3g}, {len(self.weights)} weights)"


def _checked(values: Mapping[str, float], known: tuple[str, ...]) -> dict[str, float]:
    for name, value in values.items():
        if name not in known:
            raise ParameterError(f"{name!r} is not accepted: one of {', '.join(known)}")
        if not np.isfinite(value):
            raise ParameterError(f"{name} = {value!r} is not accepted: a finite number")
    return {name: float(value) for name, value in values.items()}
