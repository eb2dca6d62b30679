"""Draw the scores of entries, also in unlike flocks, their pairs, curves and profile."""

import itertools
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from docs.scripts.plots import Interval, Plot, bar_lengths, draw_intervals, name_heights
from flockenv.comparison.levels import NO_STEERING, REFERENCE
from studies.plots import OWN, drawing, interval
from studies.store import existing
from studies.study import main

RESULTS = Path(__file__).parent / "results"
PAIRS, CURVES, AREAS = (RESULTS / name for name in ("pairs.csv", "curves.csv.gz", "areas.csv"))
UNLIKE = RESULTS / "unlike.csv"
ENTRIES, ORDERS, LAWS = RESULTS / "entries.csv", RESULTS / "orders.csv.gz", RESULTS / "laws.csv"
KEY = ["level", "budget", "entry"]
SHADES = ("-", "--", ":", "-.")
MOST_WITH_ENDS = 9
"""Entries of a matrix whose cells have room for the ends of intervals."""


def trainings(results: Path = RESULTS) -> pd.DataFrame:
    """Return the score of each training."""
    orders = (
        pd.read_csv(existing(results / "orders.csv"))
        .groupby([*KEY, "policy"], sort=False)["signed_order"]
        .mean()
    )
    table = orders.reset_index()
    ends = table[table["entry"] == "reference"].pivot(
        index="level", columns="policy", values="signed_order"
    )
    own = table[table["entry"] != "reference"].reset_index(drop=True)
    none, law = (own["level"].map(ends[name]) for name in (NO_STEERING, REFERENCE))
    return own.assign(score=(own["signed_order"] - none) / (law - none))


def title(level: str, budget: object) -> str:
    """Return what a panel is called."""
    return f"{level}, {budget} flock-hours"


def scores(figure: Figure) -> None:
    """Draw a panel for each level and budget: means with intervals, and each training as a dot."""
    rows, every = pd.read_csv(ENTRIES), trainings()
    laws = pd.read_csv(LAWS).pivot(index="level", columns="policy", values="signed_order")
    found, names = list(rows.groupby(["level", "budget"], sort=False)), [*rows["entry"].unique()]
    across = min(len(found), 2)
    panels = figure.subplots(
        -(-len(found) // across), across, sharex=True, sharey=True, squeeze=False
    )
    for axes in panels.flat[len(found) :]:
        axes.set_visible(False)
    for axes, ((level, budget), own) in zip(panels.flat, found, strict=False):
        axes.axvline(1.0, color="0.4", lw=1)
        for row in own.to_dict("records"):
            ends: Interval = (row["score"], row["score_low"], row["score_high"])
            draw_intervals(axes, [names.index(row["entry"])], [ends], OWN)
        there = every[(every["level"] == level) & (every["budget"] == budget)]
        at = [names.index(name) + 0.25 for name in there["entry"]]
        axes.plot(there["score"], at, ".", ms=4, color="0.4")
        none, law = laws.loc[level, NO_STEERING], laws.loc[level, REFERENCE]
        axes.axvline((laws.loc[level, "paper's law"] - none) / (law - none), color="0.4", ls=":")
        axes.set_title(title(level, budget), loc="left")
        name_heights(axes, names)
    figure.supxlabel("score: 0 no steering, dotted the paper's law, 1 the damped law")


def scores_size() -> tuple[float, float]:
    """Return a size in which each entry has room in each panel."""
    rows = pd.read_csv(ENTRIES)
    panels = rows.groupby(["level", "budget"]).ngroups
    return 6.8, 0.6 + 0.325 * -(-panels // 2) * rows["entry"].nunique()


def profile(figure: Figure) -> None:
    """Draw how many of an entry's trainings reach a score, for the first level and budget."""
    axes, every = figure.subplots(), trainings()
    level, budget = every.loc[0, ["level", "budget"]]
    own = every[(every["level"] == level) & (every["budget"] == budget)]
    at = np.linspace(own["score"].min() - 0.02, own["score"].max() + 0.02, 400)
    order = own.groupby("entry")["score"].mean().sort_values(ascending=False)
    shades = np.linspace(0.0, 0.65, len(order))
    for place, name in enumerate(order.index):
        reached = own[own["entry"] == name]["score"].to_numpy()
        share = (reached[:, None] >= at).mean(axis=0)
        style = {"color": str(shades[place]), "ls": SHADES[place % len(SHADES)]}
        axes.plot(at, share, label=name, **style)
    axes.set(xlabel="score", ylabel="share of trainings that reach it")
    axes.set_title(title(level, budget), loc="left")
    axes.legend()


def matrix(figure: Figure) -> None:
    """Draw how far each entry is above each other one, for the first level and budget."""
    table = pd.read_csv(PAIRS)
    level, budget = table.loc[0, ["level", "budget"]]
    own = table[(table["level"] == level) & (table["budget"] == budget)]
    names = [*dict.fromkeys([*own["better"], *own["worse"]])]
    axes = figure.subplots()
    for row in own.to_dict("records"):
        # As in the table of scores the best stands first.
        above, below = names.index(row["better"]), names.index(row["worse"])
        is_told = row["difference_low"] > 0.0 or row["difference_high"] < 0.0
        ends = f"\n{row['difference_low']:.2f} to\n{row['difference_high']:.2f}"
        if len(names) > MOST_WITH_ENDS:
            ends = ""
        improved = f"{100.0 * row['improvement']:.0f} %"
        for at, words in (((below, above), f"{row['difference']:+.2f}{ends}"),
                          ((above, below), improved)):  # fmt: skip
            axes.add_patch(_cell(at, is_told))
            axes.text(*at, words, ha="center", va="center", fontsize=9)
    axes.set_xticks(range(len(names)), names, rotation=30, ha="left", rotation_mode="anchor")
    axes.set_yticks(range(len(names)), names)
    axes.set(xlim=(-0.5, len(names) - 0.5), ylim=(len(names) - 0.5, -0.5), aspect="equal")
    axes.grid(visible=False)
    axes.tick_params(length=0, top=True, labeltop=True, bottom=False, labelbottom=False)
    for side in axes.spines.values():
        side.set_visible(False)


def _cell(at: tuple[int, int], is_told: bool) -> Rectangle:
    corner = at[0] - 0.47, at[1] - 0.47
    return Rectangle(corner, 0.94, 0.94, color=OWN if is_told else "0.9", alpha=0.35, lw=0)


def curves_size() -> tuple[float, float]:
    """Return a size in which all rows of panels are equally high."""
    areas = pd.read_csv(AREAS)
    first = (areas[["level", "budget"]] == areas.loc[0, ["level", "budget"]]).all(axis=1).sum()
    return 6.8, 0.6 + 1.8 * -(-first // 4)


def curves(figure: Figure) -> None:
    """Draw what trainings have learned during them, a panel for each entry of the first level."""
    every, areas = pd.read_csv(CURVES), pd.read_csv(AREAS)
    level, budget = areas.loc[0, ["level", "budget"]]
    first = areas[(areas["level"] == level) & (areas["budget"] == budget)]
    panels = figure.subplots(-(-len(first) // 4), 4, sharex=True, sharey=True, squeeze=False)
    for axes in panels.flat[len(first) :]:
        axes.set_visible(False)
    for axes, name in zip(panels.flat, first["entry"], strict=False):
        here = (every["level"] == level) & (every["budget"] == budget) & (every["entry"] == name)
        lines = [own for _, own in every[here].groupby("policy")]
        for own in lines:
            axes.plot(own["flock_hours"], own["score"], color="0.7", lw=0.8)
        mean = np.mean([own[["flock_hours", "score"]] for own in lines], axis=0)
        axes.plot(*mean.T, "o-", ms=4, color=OWN)
        axes.axhline(1.0, color="0.4", lw=1)
        axes.set_title(name)
    figure.supxlabel("flock-hours of training")
    figure.supylabel("score, 1: the damped law")


ENDS = ("", "_low", "_high")
_SHAPES = ("o", "s", "^", "D", "v", "P", "X", "p")
MARKS = [
    {"fmt": shape, **inks}
    for inks in ({"color": OWN, "mec": "w"}, {"color": OWN, "mec": OWN, "mfc": "w"})
    for shape in _SHAPES
]
"""Of the first entries; more than sixteen begin again."""


def unlike(figure: Figure) -> None:
    """Draw scores in unlike flocks against those in a level's own, for the first budget."""
    rows = pd.read_csv(ENTRIES).merge(pd.read_csv(UNLIKE), on=[*KEY, "trainings"])
    rows = rows[rows["budget"] == rows["budget"].min()]
    marks = dict(zip(rows["entry"].unique(), itertools.cycle(MARKS), strict=False))
    found = list(rows.groupby("level", sort=False))
    across = min(len(found), 2)
    panels = figure.subplots(-(-len(found) // across), across, squeeze=False).flat
    for axes in panels[len(found) :]:
        axes.set_visible(False)
    for axes, (level, own) in zip(panels, found, strict=False):
        axes.axline((0.0, 0.0), slope=1.0, color="0.4", lw=1)
        for row in own.to_dict("records"):
            x, y = (interval(row, *(name + end for end in ENDS)) for name in ("score", "unlike"))
            bars = (bar_lengths(*([end] for end in each)) for each in (y, x))
            style = {"ms": 9, "lw": 1, **marks[row["entry"]]}
            axes.errorbar(x[0], y[0], *bars, label=row["entry"], **style)
        axes.set_title(level, loc="left")
    figure.supxlabel("score in the level's own flocks")
    figure.supylabel("score in unlike flocks")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=4)


def unlike_size() -> tuple[float, float]:
    """Return a size with room for each row of panels and of the legend."""
    rows = pd.read_csv(UNLIKE)
    panels, words = (rows[column].nunique() for column in ("level", "entry"))
    across = min(panels, 2)
    high = (4.5 if across == 1 else 3.0) * -(-panels // across)
    return 6.8, 0.4 + high + 0.25 * -(-words // 4)


PLOTS = {
    "scores": Plot([ENTRIES, ORDERS, LAWS], scores, scores_size),
    "unlike": Plot([ENTRIES, UNLIKE], unlike, unlike_size),
    "matrix": Plot([PAIRS], matrix, (6.8, 6.8)),
    "curves": Plot([CURVES, AREAS], curves, curves_size),
    "profile": Plot([ORDERS], profile, (6.8, 3.6)),
}
script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
