"""Samples of tracks in cm and rad, and why some of them are omitted."""

from typing import TYPE_CHECKING

import numpy as np

from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.tracks.clock import times_of
from flockenv.tracks.formats import NO_NUMBER
from flockenv.tracks.headings import check_no_component, headings_of
from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.motion import in_water
from flockenv.tracks.table import long_table, numbers, points_of

if TYPE_CHECKING:
    import pandas as pd

TWICE = "that are repeated"
_MOST_OUTSIDE = 0.5


def samples_of(rows: "pd.DataFrame", layout: TrackLayout) -> "tuple[pd.DataFrame, bool]":
    """Return the columns id, time, x, y, heading and why of samples, and whether boats have names.

    Times are in s from the earliest one, positions in cm from the pool's center with y up, headings
    in rad. `why` says why a sample is omitted; it is "" for samples that count. If no row has a
    name, all rows belong to one boat.
    """
    table, boats = long_table(rows, layout)
    points, is_lost = points_of(table, layout, layout.columns["x"], layout.columns["y"])
    position = points.mean(axis=0)
    if layout.box is not None:
        (size,), _ = points_of(table, layout, layout.box[:1], layout.box[1:])
        position += size / 2
    position = (position - complex(*layout.center)) * layout.scale
    position = position.conj() if layout.y_down else position
    if len(layout.columns["heading"]) == 1:
        check_no_component(rows, layout.columns["heading"][0].replace("{id}", boats[0]), layout)
    heading, is_strange = headings_of(table, layout)
    names, is_named = names_of(table, boats, layout)
    samples = names.to_frame("id").assign(
        time=times_of(table[layout.frame], layout),
        x=position.real,
        y=position.imag,
        heading=heading,
    )
    is_sure = np.ones(len(table), bool)
    for name in layout.columns["confidence"]:
        is_sure &= numbers(table[name], layout) >= (layout.least_confidence or 0.0)
    reasons = {
        "without a name": names.isna(),
        "at a point that stands for a lost boat": is_lost,
        "without a position": np.isnan(position),
        "with too little confidence": ~is_sure,
        "with a heading beyond a full turn": is_strange,
        "without a heading": np.isnan(heading),
        "outside the water": ~in_water(layout.pool, np.abs(position), 2 * layout.hull[0]),
        TWICE: samples.duplicated(),
    }
    samples["why"] = np.select(list(reasons.values()), list(reasons), "")
    _check_water(samples)
    return samples, is_named


def names_of(
    table: "pd.DataFrame", boats: list[str], layout: TrackLayout
) -> "tuple[pd.Series[str], bool]":
    """Return the names as text, 1.0 as "1", None for rows without a boat; and if there are any."""
    rows = len(table) // len(boats)
    names = require("pandas", "plot").Series(np.repeat(boats, rows), table.index, dtype=object)
    is_named = layout.is_wide
    if layout.id is not None and not is_named:
        found = table[layout.id].astype(object).where(table[layout.id].notna(), "")
        found = found.astype(str).str.strip()
        is_named = not found.str.lower().isin(NO_NUMBER).all()
        names = found if is_named else names
    names = names.str.replace(r"^(-?\d+)\.0+$", r"\1", regex=True)
    nobody = {name.strip().casefold() for name in layout.unassigned} | {""}
    return names.mask(names.str.casefold().isin(nobody), None), is_named


def _check_water(samples: "pd.DataFrame") -> None:
    """Refuse a pool in the wrong position; a few points with many rows each mark lost boats."""
    counts = samples[samples["why"] == "outside the water"].value_counts(["x", "y"])
    others = counts.sum() - counts[counts > 1].head(3).sum()
    share = others / max(1, others + samples["why"].isin(["", TWICE]).sum())
    if share > _MOST_OUTSIDE:
        raise ParameterError(
            f"{share:.0%} of the centers lie outside the pool, or in the obstacle in its middle: "
            "do cm_per_unit, center and pool fit this table?"
        )
