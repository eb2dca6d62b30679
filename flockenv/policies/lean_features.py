"""What the lean of a `LeaningLaw` depends on: features of mirrored observations."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from flockenv.envs.observation import observation_entries

__all__ = [
    "FEATURES",
    "FELLOW_FEATURES",
    "FURTHER_FEATURES",
    "block_of",
    "features",
    "observed_features",
]

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

_FURTHER_ENTRIES = (
    "cos_orientation",
    "sin_orientation",
    "clockwise_spin",
    "fw",
    "bw",
    "bw_duration",
)
FELLOW_FEATURES = ("fellows", "gap_ahead_cos", "gap_ahead_sin", "gap_behind_cos", "gap_behind_sin")

FURTHER_FEATURES = (*_FURTHER_ENTRIES, *FELLOW_FEATURES)
"""Features that a lean may have besides `FEATURES`, where the observation has their blocks.

The first are entries of the blocks ``own`` and ``phase`` by their names there. The others are of
the block ``fellow_leaders``: how many fellow leaders are observed, and cosine and sine of the
angles along the ring to the next one ahead (clockwise) and behind, which are whole turns for a
leader alone (``FELLOW_FEATURES``).
"""

_WALL = 0.6


def block_of(feature: str) -> str:
    """Return the block of the observation that one of `FURTHER_FEATURES` needs."""
    if feature in FELLOW_FEATURES:
        return "fellow_leaders"
    return next(entry.block for entry in observation_entries() if entry.name == feature)


def observed_features(names: Sequence[str]) -> tuple[str, ...]:
    """Return the features that an observation with these entries has.

    Without the blocks own, neighbors and order there are none.
    """
    if not {*_OWN, *_ORDER, "present"} <= {*names}:
        return ()
    needed = {name: "fellow" if name in FELLOW_FEATURES else name for name in FURTHER_FEATURES}
    return (*FEATURES, *(name for name, entry in needed.items() if entry in names))


def features(
    rows: Any, names: list[str], wanted: Sequence[str] = FEATURES, arrays: Any = np
) -> Any:
    """Return features of mirrored observations.

    Parameters
    ----------
    rows
        Shape (..., observation size).
    names
        The names of an observation's entries, in order.
    wanted
        Names of `FEATURES` and `FURTHER_FEATURES`.
    arrays
        The module of the rows: NumPy, which computes in float64, or torch.

    Returns
    -------
    numpy.ndarray or torch.Tensor
        Shape (..., number of wanted features).
    """
    if arrays is np:
        rows = np.asarray(rows, np.float64)
    # Own entries come first, those of the order block after the neighbors': some names stand in
    # both, and in the block of fellow leaders.
    own = {name: rows[..., names.index(name)] for name in _OWN}
    order = [rows[..., names.index(name)] for name in _ORDER]
    outer = (own["radial_position"] - _WALL).clip(min=0.0)
    columns = [*own.values(), outer, *order, *_neighbor_sums(rows, names, arrays)]
    found = dict(zip(FEATURES, columns, strict=True))
    found |= {name: rows[..., names.index(name)] for name in _FURTHER_ENTRIES if name in wanted}
    if any(name in FELLOW_FEATURES for name in wanted):
        found |= dict(zip(FELLOW_FEATURES, _fellow_gaps(rows, names, arrays), strict=True))
    return arrays.stack([found[name] for name in wanted], -1)


def _repeated(rows: Any, names: list[str], entry: str, width: int, arrays: Any) -> Any:
    """Return the entries of a repeated block, shape (width, ..., repeats)."""
    first = names.index(entry)
    block = rows[..., first : first + width * names.count(entry)]
    return arrays.moveaxis(block.reshape(*rows.shape[:-1], -1, width), -1, 0)


def _neighbor_sums(rows: Any, names: list[str], arrays: Any) -> list[Any]:
    present, outward, ahead, cos, sin, outward_velocity, velocity, leads = _repeated(
        rows, names, "present", 8, arrays
    )
    squared = outward**2 + ahead**2
    near = present * (1.0 - leads) * arrays.exp(-squared / 2.0)
    leaders = present * leads * arrays.exp(-squared / 8.0)
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
    return [each.sum(-1) for each in sums]


def _fellow_gaps(rows: Any, names: list[str], arrays: Any) -> list[Any]:
    fellow, cos, sin, *_ = _repeated(rows, names, "fellow", 6, arrays)
    turn = 2.0 * np.pi
    clockwise = arrays.arctan2(sin, cos) % turn
    # Where there is none, the next leader is this one, a whole turn away.
    gaps = [
        arrays.amin(arrays.where(fellow > 0.0, each, turn), -1)
        for each in (clockwise, -clockwise % turn)
    ]
    waves = arrays.cos, arrays.sin
    return [fellow.sum(-1), *(wave(gap) for gap in gaps for wave in waves)]
