"""Rows of tracks in cm and rad, and why some of them count for nothing."""

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.tracks.clock import times_of
from flockenv.tracks.layout import TrackLayout, columns_of
from flockenv.tracks.motion import HEADING_ZERO, TURN, UNIT, in_water
from flockenv.tracks.table import Floats, column, numbers

if TYPE_CHECKING:
    import pandas as pd

FULL_TURN = {unit: turn + 1e-6 for unit, turn in TURN.items()}
"""The greatest heading within a full turn, rounded up."""

_MOST_STRANGE = 0.01
_MOST_OUTSIDE = 0.1


def rows_of(table: "pd.DataFrame", layout: TrackLayout) -> "pd.DataFrame":
    """Return the columns id, time, x, y, heading and why of rows.

    Times count as in the table, from the least; places are in cm from the pool's center, y up;
    headings in rad. `why` says why a row is left out, and is "" where it is not.
    """
    table = long_table(table, layout) if layout.is_wide else table
    up = -1.0 if layout.y_down else 1.0
    x, y, is_lost = _point(table, layout, layout.x, layout.y)
    rows = table[[]].assign(
        id=_names(table, layout),
        time=times_of(table, layout),
        x=(x - layout.center[0]) * layout.cm_per_unit,
        y=(y - layout.center[1]) * layout.cm_per_unit * up,
    )
    heading, is_strange = _headings(table, layout)
    sure = [numbers(table, name, layout) for name in columns_of(layout.confidence)]
    is_sure = [each >= (layout.least_confidence or 0.0) for each in sure]
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


def long_table(table: "pd.DataFrame", layout: TrackLayout) -> "pd.DataFrame":
    """Return one row per frame and boat of a table in which boats stand beside each other."""
    heading, sure = columns_of(layout.heading), columns_of(layout.confidence)
    fields = [str(layout.x), *columns_of(layout.y), *heading, *sure]
    pattern = re.compile(re.escape(str(layout.x)).replace(r"\{id\}", "(.+)"), re.IGNORECASE)
    there = {str(each).strip().casefold() for each in table}
    found = [pattern.fullmatch(str(each).strip()) for each in table]
    names = [each[1] for each in found if each]
    names = [each for each in names if fields[1].replace("{id}", each).casefold() in there]
    if not names:
        raise ParameterError(
            f"no columns look like {fields[0]!r} and {fields[1]!r}; there are "
            f"{', '.join(map(str, table))}"
        )
    time = column(table, layout.frame)
    each = [
        time.to_frame(layout.frame).assign(
            **{"{id}": name},
            **{field: column(table, field.replace("{id}", name)) for field in fields},
        )
        for name in names
    ]
    long: pd.DataFrame = require("pandas", "plot").concat(each)
    long.index.name = table.index.name
    return long


def _names(table: "pd.DataFrame", layout: TrackLayout) -> "pd.Series[Any]":
    """Return the names as text, none where no boat is named; whole numbers have no point."""
    if layout.id is None or layout.is_wide:
        ids = table["{id}"] if layout.is_wide else table.assign(id="0")["id"]
    else:
        ids = column(table, layout.id)
    names = ids.convert_dtypes().astype(object).where(ids.notna(), "").astype(str).str.strip()
    names = names.str.replace(r"^(-?\d+)\.0+$", r"\1", regex=True)
    nobody = {each.strip().casefold() for each in layout.unassigned} | {""}
    return names.mask(names.str.casefold().isin(nobody), None)


def _point(
    table: "pd.DataFrame", layout: TrackLayout, x: Any, y: Any
) -> tuple[Floats, Floats, Any]:
    """Return x and y in units of the file, and whether they stand for a boat that is lost."""
    pairs = [
        [numbers(table, name, layout) for name in names]
        for names in zip(columns_of(x), columns_of(y), strict=True)
    ]
    is_lost = np.zeros(len(table), bool)
    for pair in pairs:
        for point in layout.lost:
            is_lost |= (pair[0] == point[0]) & (pair[1] == point[1])
    means = [np.mean([pair[axis] for pair in pairs], axis=0) for axis in (0, 1)]
    return means[0], means[1], is_lost


def _headings(table: "pd.DataFrame", layout: TrackLayout) -> tuple[Floats, Any]:
    """Return headings in rad from x, y up, 0 where the table has none, and which are strange."""
    up = -1.0 if layout.y_down else 1.0
    strange = np.zeros(len(table), bool)
    if layout.heading is None:
        return np.zeros(len(table)), strange
    if not isinstance(layout.heading, str):
        x_tail, y_tail, tail_lost = _point(table, layout, *layout.heading[:2])
        x_head, y_head, head_lost = _point(table, layout, *layout.heading[2:])
        heading = direction(x_head - x_tail, (y_head - y_tail) * up)
        heading[tail_lost | head_lost] = np.nan
        return heading, strange
    heading = numbers(table, layout.heading, layout)
    turns = layout.heading_turns or ("cw" if layout.y_down else "ccw")
    if layout.wrapped:
        strange = np.abs(heading) > FULL_TURN[layout.heading_unit]
        _check_turn(heading, strange, layout)
        heading[strange] = np.nan
    sign = 1.0 if turns == "ccw" else -1.0
    heading = heading * (TURN["rad"] / TURN[layout.heading_unit])
    return HEADING_ZERO[layout.heading_zero] + sign * heading, strange


def direction(x: Floats, y: Floats) -> Floats:
    """Return the angle of vectors, in radians; NaN for none."""
    return np.where((x == 0.0) & (y == 0.0), np.nan, np.arctan2(y, x))


def _check_turn(heading: Floats, strange: Any, layout: TrackLayout) -> None:
    """Refuse headings of which more than a few exceed a full turn; one value may mark lost ones."""
    share = strange.sum() / max(1, np.isfinite(heading).sum())
    if share <= _MOST_STRANGE or (len(np.unique(heading[strange])) == 1 and share < 1.0):
        return
    largest, said = np.abs(heading[strange]).max(), layout.heading_unit
    units = (u for u in TURN if TURN[u] > TURN[said] and largest <= FULL_TURN[u])
    unit = next((f"heading_unit = {u!r} if they are in {UNIT[u]}, " for u in units), "")
    raise ParameterError(
        f"headings reach {largest:.4g}, and {share:.0%} exceed a full turn in {UNIT[said]}: "
        f"{unit}wrapped = false if they count whole turns"
    )


def _check_water(rows: "pd.DataFrame", why: Any) -> None:
    """Refuse a pool that is elsewhere; a few points in many rows mark boats that are lost."""
    outside = rows[why == "in no water"]
    counts = outside.value_counts(["x", "y"])
    others = len(outside) - counts[counts > 1].head(3).sum()
    placed = len(outside) + (why == "").sum() - (len(outside) - others)
    if others > _MOST_OUTSIDE * max(1, placed):
        raise ParameterError(
            f"{others / placed:.0%} of the centers lie outside the pool, or in the obstacle in its "
            "middle: do cm_per_unit, center and pool fit this table?"
        )
