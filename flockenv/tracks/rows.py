"""Rows of tracks in cm and rad, and why some of them count for nothing."""

import re
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.tracks.clock import times_of
from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.motion import HEADING_ZERO, TURN, UNIT, in_water
from flockenv.tracks.table import NONE, Floats, Table, listed

if TYPE_CHECKING:
    import pandas as pd

FULL_TURN = {unit: turn + 1e-6 for unit, turn in TURN.items()}
"""The greatest heading within a full turn, rounded up."""

_MOST_STRANGE = 0.01
_MOST_OUTSIDE = 0.5


def rows_of(table: Table, layout: TrackLayout) -> "pd.DataFrame":
    """Return the columns id, time, x, y, heading and why of rows, in the order of the table.

    Times are in s from the least; places are in cm from the pool's center, y up; headings in rad.
    `why` says why a row is left out, and is "" where it is not.
    """
    given, table = table, long_table(table, layout) if layout.is_wide else table
    up = -1.0 if layout.y_down else 1.0
    x, y, is_lost = _point(table, layout, layout.columns["x"], layout.columns["y"])
    if layout.box is not None:
        width, height = (table.numbers(name, layout) for name in layout.box)
        x, y = x + width / 2, y + height / 2
    rows = table.rows[[]].assign(
        id=_names(table, layout),
        time=times_of(table, layout),
        x=(x - layout.center[0]) * layout.scale,
        y=(y - layout.center[1]) * layout.scale * up,
    )
    _check_no_part(given, layout)
    heading, is_strange = _headings(table, layout)
    sure = [table.numbers(name, layout) for name in layout.columns["confidence"]]
    is_sure = [confidence >= (layout.least_confidence or 0.0) for confidence in sure]
    is_wet = in_water(layout.pool, rows[["x", "y"]].to_numpy(), 2 * layout.hull[0])
    reasons = {
        "without a name": rows["id"].isna().to_numpy(),
        "at a point that stands for a lost boat": is_lost,
        "without a position": np.isnan(x + y),
        "with too little confidence": ~np.logical_and.reduce(is_sure) & bool(sure),
        "with a heading beyond a full turn": is_strange,
        "without a heading": np.isnan(heading),
        "in no water": ~is_wet,
    }
    why = np.select(list(reasons.values()), list(reasons), "")
    _check_water(rows, why)
    return rows.assign(heading=heading, why=why)


def names_nobody(table: Table, layout: TrackLayout) -> bool:
    """Return whether the column of names is empty."""
    if layout.id is None or layout.is_wide:
        return False
    ids = table.column(layout.id)
    return bool((ids.isna() | ids.astype(str).str.strip().str.lower().isin(NONE)).all())


def long_table(table: Table, layout: TrackLayout) -> Table:
    """Return one row per frame and boat, of a table with one row per frame."""
    pandas = require("pandas", "plot")
    fields = dict.fromkeys(name for columns in layout.columns.values() for name in columns)
    names = _names_beside(table, [*fields])
    rows, many = table.rows, len(names)
    columns: dict[str, Any] = {
        layout.frame: np.tile(table.column(layout.frame), many),
        "{id}": np.repeat(names, len(rows)),
    }
    for field in fields:
        boats = [table.index_of(field.replace("{id}", name)) for name in names]
        columns[field] = rows.iloc[:, boats].to_numpy().T.ravel()
    index = pandas.Index(np.tile(rows.index, many), name=rows.index.name)
    return Table(pandas.DataFrame(columns, index))


def _names_beside(table: Table, fields: list[str]) -> list[str]:
    """Return the names that stand for {id} in the columns of a table with one row per frame."""
    first = re.compile(re.escape(fields[0]).replace(r"\{id\}", "(.+)"), re.IGNORECASE)
    names = [found[1] for name in table.names if (found := first.fullmatch(name.strip()))]
    names = [n for n in names if all(field.replace("{id}", n) in table for field in fields)]
    if not names:
        looks = " and ".join(map(repr, fields))
        raise ParameterError(f"no columns look like {looks}; there are {listed(table.names)}")
    return names


def _names(table: Table, layout: TrackLayout) -> "pd.Series[Any]":
    """Return the names as text, None for rows without a boat; whole numbers have no point."""
    if layout.is_wide:
        ids = table.column("{id}")
    else:
        ids = table.rows.assign(id="0")["id"] if layout.id is None else table.column(layout.id)
    names = ids.convert_dtypes().astype(object).where(ids.notna(), "").astype(str).str.strip()
    names = names.str.replace(r"^(-?\d+)\.0+$", r"\1", regex=True)
    nobody = {name.strip().casefold() for name in layout.unassigned} | {""}
    return names.mask(names.str.casefold().isin(nobody), None)


def _point(
    table: Table, layout: TrackLayout, x: tuple[str, ...], y: tuple[str, ...]
) -> tuple[Floats, Floats, Any]:
    """Return x and y in units of the file, and whether they mark a lost boat."""
    pairs = [[table.numbers(name, layout) for name in names] for names in zip(x, y, strict=True)]
    is_lost = np.zeros(len(table), bool)
    for pair in pairs:
        for point in layout.lost:
            is_lost |= (pair[0] == point[0]) & (pair[1] == point[1])
    means = [np.mean([pair[axis] for pair in pairs], axis=0) for axis in (0, 1)]
    return means[0], means[1], is_lost


def _headings(table: Table, layout: TrackLayout) -> tuple[Floats, Any]:
    """Return headings in rad from x, y up, 0 without a column, and which exceed a full turn."""
    up = -1.0 if layout.y_down else 1.0
    strange = np.zeros(len(table), bool)
    columns, unit = layout.columns["heading"], layout.heading_unit
    if len(columns) == 4:
        x_tail, y_tail, tail_lost = _point(table, layout, columns[:1], columns[1:2])
        x_head, y_head, head_lost = _point(table, layout, columns[2:3], columns[3:])
        heading = direction(x_head - x_tail, (y_head - y_tail) * up)
        heading[tail_lost | head_lost] = np.nan
        return heading, strange
    if layout.quaternion is not None:
        heading, unit = _turned(table, layout, layout.quaternion), "rad"
    elif not columns:
        return np.zeros(len(table)), strange
    else:
        heading = table.numbers(columns[0], layout)
        if layout.wrapped:
            strange = np.abs(heading) > FULL_TURN[unit]
            _check_turn(heading, strange, layout)
            heading[strange] = np.nan
    turns = layout.heading_turns or ("cw" if layout.y_down else "ccw")
    sign = 1.0 if turns == "ccw" else -1.0
    return HEADING_ZERO[layout.heading_zero] + sign * heading * (TURN["rad"] / TURN[unit]), strange


def _turned(table: Table, layout: TrackLayout, columns: tuple[str, str, str, str]) -> Floats:
    """Return the angle about the vertical of quaternions, whose length is 1."""
    x, y, z, w = (table.numbers(name, layout) for name in columns)
    off = np.abs(x**2 + y**2 + z**2 + w**2 - 1.0)
    if np.nanmedian(off) > 0.01:
        raise ParameterError(
            f"quaternion = {list(columns)} is not accepted: columns x, y, z and w, whose squares "
            "add up to 1"
        )
    # Turns counted from y to x are about an axis of a mirrored system.
    is_mirrored = layout.heading_turns not in (None, "cw" if layout.y_down else "ccw")
    across = -x * y if is_mirrored else x * y
    heading = np.arctan2(2 * (w * z + across), 1 - 2 * (y**2 + z**2))
    return np.where(off > 0.1, np.nan, heading)


def _check_no_part(table: Table, layout: TrackLayout) -> None:
    """Refuse a part of a quaternion, a sine or a cosine in place of a heading.

    Names of columns do not matter: the squares of neighboring parts add up to 1.
    """
    heading = layout.columns["heading"]
    if len(heading) != 1:
        return
    fields = [name for columns in layout.columns.values() for name in columns]
    boat = _names_beside(table, fields)[0] if layout.is_wide else ""
    own = table.index_of(heading[0].replace("{id}", boat))
    beside = range(max(0, own - 3), min(own + 4, len(table.names)))
    squares = {index: _squares(table, table.names[index], layout) for index in beside}
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


def _squares(table: Table, name: str, layout: TrackLayout) -> Any:
    """Return the squares of a column that may be a part of turns, 0 for missing numbers."""
    try:
        values = np.nan_to_num(table.numbers(name, layout))
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
    unit = next((f"heading_unit = {u!r} if they are in {UNIT[u]}, " for u in units), "")
    raise ParameterError(
        f"headings reach {largest:.4g}, and {share:.0%} exceed a full turn in {UNIT[unit_given]}: "
        f"{unit}wrapped = false if they count whole turns"
    )


def _check_water(rows: "pd.DataFrame", why: Any) -> None:
    """Refuse a pool in another position; a few points in many rows mark lost boats."""
    outside = rows[why == "in no water"]
    counts = outside.value_counts(["x", "y"])
    others = len(outside) - counts[counts > 1].head(3).sum()
    placed = len(outside) + (why == "").sum() - (len(outside) - others)
    if others > _MOST_OUTSIDE * max(1, placed):
        raise ParameterError(
            f"{others / placed:.0%} of the centers lie outside the pool, or in the obstacle in its "
            "middle: do cm_per_unit, center and pool fit this table?"
        )
