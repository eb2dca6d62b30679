"""Rows of tracks in cm and rad, and why some of them count for nothing."""

from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.tracks.clock import times_of
from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.motion import HEADING_ZERO, TURN, in_water
from flockenv.tracks.table import NONE, Floats, Table, listed

if TYPE_CHECKING:
    import pandas as pd

FULL_TURN = {unit: turn + 1e-6 for unit, turn in TURN.items()}
"""The greatest heading within a full turn, rounded up."""

_MOST_STRANGE = 0.01
_MOST_OUTSIDE = 0.5


def rows_of(table: Table) -> "pd.DataFrame":
    """Return the columns id, time, x, y, heading and why of rows, in the order of the table.

    Times are in s from the least; places are in cm from the pool's center, y up; headings in rad.
    `why` says why a row is left out, and is "" where it is not.
    """
    layout = table.layout
    x, y, is_lost = _point(table, layout.columns["x"], layout.columns["y"])
    if layout.box is not None:
        x, y = (at + table.numbers(name) / 2 for at, name in zip((x, y), layout.box, strict=True))
    places = {
        "x": (x - layout.center[0]) * layout.scale,
        "y": (y - layout.center[1]) * layout.scale * layout.up,
    }
    _check_no_part(table)
    heading, is_strange = _headings(table)
    rows: pd.DataFrame = require("pandas", "plot").DataFrame(
        {"id": _names(table), "time": times_of(table), **places, "heading": heading}, table.index
    )
    is_sure = np.ones(len(rows), bool)
    for name in layout.columns["confidence"]:
        is_sure &= table.numbers(name) >= (layout.least_confidence or 0.0)
    reasons = {
        "without a name": rows["id"].isna().to_numpy(),
        "at a point that stands for a lost boat": is_lost,
        "without a position": np.isnan(x + y),
        "with too little confidence": ~is_sure,
        "with a heading beyond a full turn": is_strange,
        "without a heading": np.isnan(heading),
        "in no water": ~in_water(layout.pool, rows[["x", "y"]].to_numpy(), 2 * layout.hull[0]),
    }
    rows["why"] = np.select(list(reasons.values()), list(reasons), "")
    _check_water(rows)
    return rows


def names_nobody(table: Table) -> bool:
    """Return whether the column of names is empty."""
    if table.layout.id is None or table.layout.is_wide:
        return False
    ids = table.column(table.layout.id)
    return bool((ids.isna() | ids.astype(str).str.strip().str.lower().isin(NONE)).all())


def _names(table: Table) -> Any:
    """Return the names as text, None for rows without a boat; whole numbers have no point."""
    layout, pandas = table.layout, require("pandas", "plot")
    if layout.is_wide or layout.id is None:
        ids = pandas.Series(np.repeat(table.boats, len(table.rows)), dtype=object)
    else:
        ids = table.column(layout.id)
    names = ids.convert_dtypes().astype(object).where(ids.notna(), "").astype(str).str.strip()
    names = names.str.replace(r"^(-?\d+)\.0+$", r"\1", regex=True)
    nobody = {name.strip().casefold() for name in layout.unassigned} | {""}
    return names.mask(names.str.casefold().isin(nobody), None).to_numpy()


def _point(table: Table, x: tuple[str, ...], y: tuple[str, ...]) -> tuple[Floats, Floats, Any]:
    """Return x and y in units of the file, and whether they mark a lost boat."""
    points = np.array([[table.numbers(name) for name in names] for names in (x, y)])
    is_lost = np.zeros(points.shape[-1], bool)
    for point in table.layout.lost:
        is_lost |= ((points[0] == point[0]) & (points[1] == point[1])).any(axis=0)
    return *points.mean(axis=1), is_lost


def _headings(table: Table) -> tuple[Floats, Any]:
    """Return headings in rad from x, y up, 0 without a column, and which exceed a full turn."""
    layout, columns = table.layout, table.layout.columns["heading"]
    unit = layout.heading_unit if layout.quaternion is None else "rad"
    if len(columns) == 4:
        x_tail, y_tail, tail_lost = _point(table, columns[:1], columns[1:2])
        x_head, y_head, head_lost = _point(table, columns[2:3], columns[3:])
        heading = direction(x_head - x_tail, (y_head - y_tail) * layout.up)
        return np.where(tail_lost | head_lost, np.nan, heading), np.zeros(len(heading), bool)
    if layout.quaternion is not None:
        heading = _turned(table, layout.quaternion)
    elif columns:
        heading = table.numbers(columns[0])
    else:
        heading = np.zeros(len(table.index))
    strange = (np.abs(heading) > FULL_TURN[unit]) & layout.wrapped
    _check_turn(heading, strange, layout)
    sign = 1.0 if layout.turns == "ccw" else -1.0
    if columns or layout.quaternion is not None:
        heading = HEADING_ZERO[layout.heading_zero] + sign * heading * (TURN["rad"] / TURN[unit])
    return heading, strange


def _turned(table: Table, columns: tuple[str, str, str, str]) -> Floats:
    """Return the angle about the vertical of quaternions, whose length is 1."""
    x, y, z, w = map(table.numbers, columns)
    off = np.abs(x**2 + y**2 + z**2 + w**2 - 1.0)
    if np.nanmedian(off) > 0.01:
        raise ParameterError(
            f"quaternion = {list(columns)} is not accepted: columns x, y, z and w, whose squares "
            "add up to 1"
        )
    # Turns counted from y to x are about an axis of a mirrored system.
    is_mirrored = table.layout.turns == ("ccw" if table.layout.y_down else "cw")
    across = -x * y if is_mirrored else x * y
    heading = np.arctan2(2 * (w * z + across), 1 - 2 * (y**2 + z**2))
    return np.where(off > 0.1, np.nan, heading)


def _check_no_part(table: Table) -> None:
    """Refuse a part of a quaternion, a sine or a cosine in place of a heading.

    Names of columns do not matter: the squares of neighboring parts add up to 1.
    """
    heading = table.layout.columns["heading"]
    if len(heading) != 1:
        return
    own = table.index_of(heading[0].replace("{id}", table.boats[0]))
    beside = range(max(0, own - 3), min(own + 4, len(table.names)))
    squares = {index: _squares(table, table.names[index]) for index in beside}
    parts = [index for index in beside if squares[index] is not None and index != own]
    if squares[own] is None or not np.std(squares[own]) > 0.0:
        return
    for others in (*combinations(parts, 3), *combinations(parts, 1)):
        total = np.sum([squares[index] for index in (own, *others)], axis=0)
        if abs(np.mean(total) - 1.0) < 0.1 and np.std(total) < 0.1 * np.std(squares[own]):
            names = listed([table.names[index] for index in sorted((own, *others))])
            raise ParameterError(
                f"heading = {heading[0]!r} is a part of a turn: the squares of {names} add up to "
                "1. Name the columns x, y, z and w in quaternion, or make angles of a sine and a "
                "cosine"
            )


def _squares(table: Table, name: str) -> Any:
    """Return the squares of a column that may be a part of turns, 0 for missing numbers."""
    try:
        values = np.nan_to_num(table.numbers(name))
    except ParameterError:  # A column of remarks, or a repeated name.
        return None
    return values**2 if len(values) and np.abs(values).max() <= 1.01 else None


def direction(x: Floats, y: Floats) -> Floats:
    """Return the angle of vectors, in radians; NaN for none."""
    return np.where((x == 0.0) & (y == 0.0), np.nan, np.arctan2(y, x))


def _check_turn(heading: Floats, strange: Any, layout: TrackLayout) -> None:
    """Refuse headings if many exceed a full turn; a single value may mark lost boats."""
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


def _check_water(rows: "pd.DataFrame") -> None:
    """Refuse a pool in another position; a few points in many rows mark lost boats."""
    counts = rows[rows["why"] == "in no water"].value_counts(["x", "y"])
    others = counts.sum() - counts[counts > 1].head(3).sum()
    share = others / max(1, others + (rows["why"] == "").sum())
    if share > _MOST_OUTSIDE:
        raise ParameterError(
            f"{share:.0%} of the centers lie outside the pool, or in the obstacle in its middle: "
            "do cm_per_unit, center and pool fit this table?"
        )
