"""Headings in rad from columns in any convention; impossible columns and units are refused."""

from contextlib import suppress
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flockenv.errors import ParameterError
from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.motion import Motion
from flockenv.tracks.table import Floats, finder, listed, numbers, points_of

if TYPE_CHECKING:
    import pandas as pd

HEADING_ZERO = {"right": 0.0, "up": np.pi / 2, "left": np.pi, "down": -np.pi / 2}
"""Zero of headings, in rad counter-clockwise from x."""

TURN = {"turn": 1.0, "rad": 2 * np.pi, "deg": 360.0}
"""A full turn in the units of headings."""

FULL_TURN = {unit: turn + 1e-6 for unit, turn in TURN.items()}
"""The greatest heading within a full turn, rounded up."""

_MOST_STRANGE = 0.01
_AXIS_JUMP = 0.8


def headings_of(table: "pd.DataFrame", layout: TrackLayout) -> tuple[Floats, NDArray[np.bool_]]:
    """Return headings in rad from x (0 without a column), and which exceed a full turn."""
    columns, strange = layout.columns["heading"], np.zeros(len(table), bool)
    if len(columns) == 4:
        (tail, head), is_lost = points_of(table, layout, columns[::2], columns[1::2])
        heading = direction(head - tail) * layout.y_sign
        return np.where(is_lost, np.nan, heading), strange
    if columns:
        heading = numbers(table[columns[0]], layout)
        strange = (np.abs(heading) > FULL_TURN[layout.heading_unit]) & layout.wrapped
        _check_largest(heading, strange, layout)
        heading = heading * (TURN["rad"] / TURN[layout.heading_unit])
    elif layout.quaternion is not None:
        heading = _turned(table, layout)
    else:
        return np.zeros(len(table)), strange
    sign = 1.0 if layout.turns == "ccw" else -1.0
    return HEADING_ZERO[layout.heading_zero] + sign * heading, strange


def _turned(table: "pd.DataFrame", layout: TrackLayout) -> Floats:
    """Return the angle about the vertical of unit quaternions."""
    columns = layout.columns["quaternion"]
    x, y, z, w = (numbers(table[name], layout) for name in columns)
    off = np.abs(x**2 + y**2 + z**2 + w**2 - 1.0)
    if np.nanmedian(off) > 0.01:
        raise ParameterError(
            f"quaternion = {list(columns)} is not accepted: columns x, y, z and w, whose squares "
            "add up to 1"
        )
    # If turns are counted from y to x, the axis belongs to a mirrored system.
    is_mirrored = layout.turns == ("ccw" if layout.y_down else "cw")
    across = -x * y if is_mirrored else x * y
    heading = np.arctan2(2 * (w * z + across), 1 - 2 * (y**2 + z**2))
    return np.where(off > 0.1, np.nan, heading)


def check_no_component(rows: "pd.DataFrame", heading: str, layout: TrackLayout) -> None:
    """Refuse a component of a quaternion, a sine or a cosine as a heading.

    They are recognized without names of columns: the squares of neighboring columns add up to 1.
    """
    own = finder(rows)(heading)
    squares = dict[int, Floats]()
    for index in range(max(0, own - 3), min(own + 4, rows.shape[1])):
        with suppress(ParameterError):  # A column of remarks.
            values = np.nan_to_num(numbers(rows.iloc[:, index], layout))
            if len(values) and np.abs(values).max() <= 1.01:
                squares[index] = values**2
    square = squares.pop(own, np.zeros(1))
    for others in (*combinations(squares, 3), *combinations(squares, 1)):
        total = square + sum(squares[index] for index in others)
        if abs(np.mean(total) - 1.0) < 0.1 and np.std(total) < 0.1 * np.std(square):
            names = [str(rows.columns[index]) for index in sorted((own, *others))]
            raise ParameterError(
                f"heading = {layout.heading!r} is a part of a turn: the squares of {listed(names)} "
                "add up to 1. Name the columns x, y, z and w in quaternion, or make angles of a "
                "sine and a cosine"
            )


def direction(way: NDArray[np.complex128]) -> Floats:
    """Return the angle of vectors x + iy in rad; NaN for none."""
    return np.where(way == 0.0, np.nan, np.angle(way))


def _check_largest(heading: Floats, strange: NDArray[np.bool_], layout: TrackLayout) -> None:
    """Refuse headings if many exceed a full turn; a single such value may mark lost boats."""
    share = strange.sum() / max(1, np.isfinite(heading).sum())
    if share <= _MOST_STRANGE or (len(np.unique(heading[strange])) == 1 and share < 1.0):
        return
    largest, unit_given = np.abs(heading[strange]).max(), layout.heading_unit
    units = (u for u in TURN if TURN[u] > TURN[unit_given] and largest <= FULL_TURN[u])
    unit = next((f"heading_unit = {u!r} if they are in {u}, " for u in units), "")
    raise ParameterError(
        f"headings reach {largest:.4g}, and {share:.0%} exceed a full turn in {unit_given}: "
        f"{unit}wrapped = false if they count whole turns"
    )


def check_by_motion(heading: Floats, motion: Motion, layout: TrackLayout) -> None:
    """Refuse a column of headings that fits the motion better in another unit, or as axes."""
    if len(layout.columns["heading"]) != 1:
        return
    _check_unit(heading, motion, layout)
    jumps = (np.abs(np.diff(heading, axis=0)) > _AXIS_JUMP * np.pi) & motion.steps
    if layout.axis or jumps.sum() < 3 or not _spans_half_turn(heading):
        return
    if motion.cosine(bows_of(heading, motion)) > motion.cosine(heading):
        raise ParameterError(
            "headings lie within half a turn and jump from one end of it to the other: set "
            "axis = true if they are axes without a bow, as of ellipses"
        )


def _check_unit(heading: Floats, motion: Motion, layout: TrackLayout) -> None:
    """Refuse headings that stay within a full turn of a smaller unit, if they fit that unit."""
    zero, given = HEADING_ZERO[layout.heading_zero], layout.heading_unit
    turned = heading - zero
    for unit in (unit for unit in TURN if TURN[unit] < TURN[given]):
        # Headings must stay within a full turn of the smaller unit, and span more than half of one.
        share = TURN[unit] / TURN[given]
        least = TURN["rad"] * share
        is_wide = np.ptp(turned[motion.present]) > 0.5 * least
        if np.nanmax(np.abs(turned)) > 1.003 * least or not is_wide:
            continue
        if motion.cosine(zero + turned / share) > motion.cosine(heading):
            raise ParameterError(
                f"headings never exceed a full turn in {unit}, and fit the motion better than "
                f"in {given}: is heading_unit = {unit!r}?"
            )


def _spans_half_turn(heading: Floats) -> bool:
    """Return whether headings lie within half a turn, as axes do, apart from whole turns."""
    starts = np.pi * np.array([[0.0], [0.5], [1.0], [1.5]])
    turned = np.mod(heading[~np.isnan(heading)] - starts, 2 * np.pi)
    return bool((turned <= np.pi + 1e-6).all(axis=1).any())


def bows_of(axis: Floats, motion: Motion) -> Floats:
    """Return axes as headings: continuous, and mostly along the boat's motion."""
    heading = axis.copy()
    for boat in range(axis.shape[1]):
        for part in motion.split(boat)[0]:
            heading[part, boat] = np.unwrap(axis[part, boat], period=np.pi)
            if np.nansum(motion.ahead(heading)[part, boat]) < 0.0:
                heading[part, boat] += np.pi
    return heading


def unwrapped(heading: Floats) -> Floats:
    """Return headings without jumps of full turns between successive samples of a boat."""
    continuous = heading.copy()
    for boat in continuous.T:
        present = ~np.isnan(boat)
        boat[present] = np.unwrap(boat[present])
    return continuous
