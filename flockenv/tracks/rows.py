"""Rows of tracks in cm and rad, and why some of them are omitted."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.tracks.clock import times_of
from flockenv.tracks.headings import headings_of
from flockenv.tracks.motion import in_water
from flockenv.tracks.table import Table

if TYPE_CHECKING:
    import pandas as pd

_MOST_OUTSIDE = 0.5


def rows_of(table: Table) -> "pd.DataFrame":
    """Return the columns id, time, x, y, heading and why of rows, in the order of the table.

    Times are in s from the earliest one, positions in cm from the pool's center with y up, headings
    in rad. `why` says why a row is omitted; it is "" for rows that count.
    """
    layout, names = table.layout, _names(table)
    x, y, is_lost = table.points(layout.columns["x"], layout.columns["y"])
    if layout.box is not None:
        x, y = (at + table.numbers(name) / 2 for at, name in zip((x, y), layout.box, strict=True))
    positions = {
        "x": (x - layout.center[0]) * layout.scale,
        "y": (y - layout.center[1]) * layout.scale * layout.y_sign,
    }
    heading, is_strange = headings_of(table)
    rows: pd.DataFrame = require("pandas", "plot").DataFrame(
        {"id": names, "time": times_of(table), **positions, "heading": heading}, table.index
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
        "outside the water": ~in_water(
            layout.pool, rows[["x", "y"]].to_numpy(), 2 * layout.hull[0]
        ),
    }
    rows["why"] = np.select(list(reasons.values()), list(reasons), "")
    _check_water(rows)
    return rows


def _names(table: Table) -> NDArray[np.object_]:
    """Return the names as text, 1.0 as "1"; None for rows without a boat."""
    layout, pandas = table.layout, require("pandas", "plot")
    if table.is_named:
        ids = table.column(str(layout.id))
    else:
        ids = pandas.Series(np.repeat(table.boats, len(table.rows)), dtype=object)
    names = ids.convert_dtypes().astype(object).where(ids.notna(), "").astype(str).str.strip()
    names = names.str.replace(r"^(-?\d+)\.0+$", r"\1", regex=True)
    nobody = {name.strip().casefold() for name in layout.unassigned} | {""}
    return names.mask(names.str.casefold().isin(nobody), None).to_numpy()


def _check_water(rows: "pd.DataFrame") -> None:
    """Refuse a pool in the wrong position; a few points with many rows each mark lost boats."""
    counts = rows[rows["why"] == "outside the water"].value_counts(["x", "y"])
    others = counts.sum() - counts[counts > 1].head(3).sum()
    share = others / max(1, others + (rows["why"] == "").sum())
    if share > _MOST_OUTSIDE:
        raise ParameterError(
            f"{share:.0%} of the centers lie outside the pool, or in the obstacle in its middle: "
            "do cm_per_unit, center and pool fit this table?"
        )
