"""How many boats stay outside of the jams: the lever rule of a phase that condenses on a wall.

If jams condense beside rotation, the coverage by boats outside of them is one number at a noise,
however many boats there are: the others join the jams. This reads it off the runs of the map,
chosen after these runs, whose flocks were followed for 20 minutes after they left their start. So
most had not come to rest, and a value that does not depend on the coverage is a sign and no proof.
"""

from typing import Any

import pandas as pd

from studies.claim import mean
from studies.picture import COLORS, curve, picture
from studies.store import write
from studies.study import Options

JAMS = 0.05
"""Least share of boats in jams, over the last ten minutes, of a flock that has any."""
_KEY = ["c4", "n_boats", "coverage", "start"]


def outside(table: pd.DataFrame) -> pd.DataFrame:
    """Return the coverage outside of jams at the end, over runs that have jams then.

    Coverage is the number of boats over those that fit the wall in one row.
    """
    rows = []
    for key, runs in table.groupby(_KEY):
        with_jams = runs[runs["in_jams"] >= JAMS]
        found = mean(with_jams["coverage"] * (1.0 - with_jams["in_jams"]))
        row = dict(zip(_KEY, key, strict=True)) | {"runs": len(runs), "with_jams": len(with_jams)}
        rows.append(row | dict(zip(("outside", "low", "high"), found, strict=True)))
    return pd.DataFrame(rows)


def write_outside(options: Options, table: pd.DataFrame) -> None:
    """Write the table of white noise at the coarse step as a file, and draw it."""
    white = table[(table["noise_scheme"] == "white") & (table["dt_s"] == 0.1)]
    found = outside(white)
    text = found.to_csv(index=False, float_format="%.3g", lineterminator="\n")
    write(options.folder / "outside.csv", text.encode())
    draw(options, found)


def draw(options: Options, found: pd.DataFrame) -> None:
    """Draw the coverage outside of jams against that of all boats, a panel for each size."""
    sizes = sorted(found["n_boats"].unique())
    colors = dict(zip(sorted(found["c4"].unique()), COLORS, strict=False))
    with picture(options, "outside", height_cm=9.0) as figure:
        panels = figure.subplots(1, len(sizes), sharex=True, sharey=True, squeeze=False)[0]
        for axes, n in zip(panels, sizes, strict=True):
            _panel(axes, found[found["n_boats"] == n], colors)
            axes.set(title=f"{n:g} boats", xlabel="coverage", xlim=(0.1, 1.1), ylim=(0.0, 0.7))
        panels[0].set_ylabel("coverage outside of jams")
        for c4, color in colors.items():
            panels[0].plot([], [], "o-", color=color, label=f"{c4:g}")
        figure.legend(title="c4", loc="outside lower center", ncols=len(colors))


def _panel(axes: Any, found: pd.DataFrame, colors: dict[float, str]) -> None:
    axes.plot([0.0, 0.7], [0.0, 0.7], color="0.7", zorder=0)  # No boat in a jam.
    for c4, own in found.groupby("c4"):
        for start, style in (("one-jam", {}), ("rotating", {"mfc": "w"})):
            points = own[(own["start"] == start) & (own["with_jams"] >= 3)]
            if len(points):
                intervals = points[["outside", "low", "high"]].itertuples(index=False)
                curve(axes, points["coverage"], intervals, color=colors[c4], **style)
