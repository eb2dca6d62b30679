"""Headings in rad from columns in any convention; impossible columns and units are refused."""

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from flockenv.errors import ParameterError
from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.motion import Motion
from flockenv.tracks.table import Floats, Table, listed

HEADING_ZERO = {"right": 0.0, "up": np.pi / 2, "left": np.pi, "down": -np.pi / 2}
"""Zero of headings, in rad counter-clockwise from x."""

TURN = {"turn": 1.0, "rad": 2 * np.pi, "deg": 360.0}
"""A full turn in the units of headings."""

FULL_TURN = {unit: turn + 1e-6 for unit, turn in TURN.items()}
"""The greatest heading within a full turn, rounded up."""

_MOST_STRANGE = 0.01
_AXIS_JUMP = 0.8


def headings_of(table: Table) -> tuple[Floats, NDArray[np.bool_]]:
    """Return headings in rad from x (0 without a column), and which exceed a full turn."""
    layout, columns = table.layout, table.layout.columns["heading"]
    strange = np.zeros(len(table.index), bool)
    if len(columns) == 4:
        x_tail, y_tail, tail_lost = table.points(columns[:1], columns[1:2])
        x_head, y_head, head_lost = table.points(columns[2:3], columns[3:])
        heading = direction(x_head - x_tail, (y_head - y_tail) * layout.y_sign)
        return np.where(tail_lost | head_lost, np.nan, heading), strange
    if columns:
        _check_no_component(table)
        heading = table.numbers(columns[0])
        strange = (np.abs(heading) > FULL_TURN[layout.heading_unit]) & layout.wrapped
        _check_largest(heading, strange, layout)
        turned = heading * (TURN["rad"] / TURN[layout.heading_unit])
    elif layout.quaternion is not None:
        turned = _turned(table, layout.quaternion)
    else:
        return np.zeros(len(strange)), strange
    sign = 1.0 if layout.turns == "ccw" else -1.0
    return HEADING_ZERO[layout.heading_zero] + sign * turned, strange


def _turned(table: Table, columns: tuple[str, str, str, str]) -> Floats:
    """Return the angle about the vertical of unit quaternions."""
    x, y, z, w = map(table.numbers, columns)
    off = np.abs(x**2 + y**2 + z**2 + w**2 - 1.0)
    if np.nanmedian(off) > 0.01:
        raise ParameterError(
            f"quaternion = {list(columns)} is not accepted: columns x, y, z and w, whose squares "
            "add up to 1"
        )
    # If turns are counted from y to x, the axis belongs to a mirrored system.
    is_mirrored = table.layout.turns == ("ccw" if table.layout.y_down else "cw")
    across = -x * y if is_mirrored else x * y
    heading = np.arctan2(2 * (w * z + across), 1 - 2 * (y**2 + z**2))
    return np.where(off > 0.1, np.nan, heading)


def _check_no_component(table: Table) -> None:
    """Refuse a component of a quaternion, a sine or a cosine as a heading.

    They are recognized without names of columns: the squares of neighboring columns add up to 1.
    """
    heading = table.layout.columns["heading"][0]
    own = table.index_of(heading.replace("{id}", table.boats[0]))
    beside = table.names[max(0, own - 3) : own + 4]
    squares = {name: values for name in beside if (values := _squares(table, name)) is not None}
    square = squares.pop(table.names[own], np.zeros(1))
    for others in (*combinations(squares, 3), *combinations(squares, 1)):
        total = square + sum(squares[name] for name in others)
        if abs(np.mean(total) - 1.0) < 0.1 and np.std(total) < 0.1 * np.std(square):
            names = [name for name in beside if name in (table.names[own], *others)]
            raise ParameterError(
                f"heading = {heading!r} is a part of a turn: the squares of {listed(names)} add "
                "up to 1. Name the columns x, y, z and w in quaternion, or make angles of a sine "
                "and a cosine"
            )


def _squares(table: Table, name: str) -> Floats | None:
    """Return the squares of a column if it may be such a component; 0 for missing numbers."""
    try:
        values = np.nan_to_num(table.numbers(name))
    except ParameterError:  # A column of remarks, or a repeated name.
        return None
    return values**2 if len(values) and np.abs(values).max() <= 1.01 else None


def direction(x: Floats, y: Floats) -> Floats:
    """Return the angle of vectors, in radians; NaN for none."""
    return np.where((x == 0.0) & (y == 0.0), np.nan, np.arctan2(y, x))


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
    wrapped = np.mod(heading[~np.isnan(heading)], np.pi * 2)
    return any(
        (np.mod(wrapped - start, 2 * np.pi) <= np.pi + 1e-6).all()
        for start in np.pi * np.array([0.0, 0.5, 1.0, 1.5])
    )


def bows_of(axis: Floats, motion: Motion) -> Floats:
    """Return axes as headings: continuous, and mostly along the boat's motion."""
    heading = axis.copy()
    for boat in range(axis.shape[1]):
        for part in motion.parts(boat):
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
