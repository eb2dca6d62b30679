"""Draw the scores of entries, and how many of their trainings reach a score."""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from docs.scripts.plots import Interval, Plot, listed
from flockenv.comparison.levels import NO_STEERING, REFERENCE
from studies.plots import OWN, drawing
from studies.study import main

RESULTS = Path(__file__).parent / "results"
ENTRIES, ORDERS, LAWS = RESULTS / "entries.csv", RESULTS / "orders.csv.gz", RESULTS / "laws.csv"
KEY = ["level", "budget", "entry"]
SHADES = ("-", "--", ":", "-.")


def trainings() -> pd.DataFrame:
    """Return the score of each training."""
    orders = pd.read_csv(ORDERS).groupby([*KEY, "policy"], sort=False)["signed_order"].mean()
    table = orders.reset_index()
    ends = table[table["entry"] == "reference"].pivot(
        index="level", columns="policy", values="signed_order"
    )
    own = table[table["entry"] != "reference"].set_index("level")
    none, law = ends[NO_STEERING], ends[REFERENCE]
    return own.assign(score=(own["signed_order"] - none) / (law - none)).reset_index()


def title(level: str, budget: object) -> str:
    """Return what a panel is called."""
    return f"{level}, {budget} flock-hours"


def scores(figure: Figure) -> None:
    """Draw a panel for each level and budget: means with intervals, and each training as a dot."""
    rows, every = pd.read_csv(ENTRIES), trainings()
    laws = pd.read_csv(LAWS).pivot(index="level", columns="policy", values="signed_order")
    found = list(rows.groupby(["level", "budget"], sort=False))
    heights = [len(own) for _, own in found]
    panels = figure.subplots(len(found), 1, sharex=True, squeeze=False, height_ratios=heights)
    for axes, ((level, budget), own) in zip(panels[:, 0], found, strict=True):
        intervals: dict[str, Interval] = {
            row["entry"]: (row["score"], row["score_low"], row["score_high"])
            for row in own.to_dict("records")
        }
        listed(axes, intervals, dict.fromkeys(intervals, OWN), 1.0)
        there = every[(every["level"] == level) & (every["budget"] == budget)]
        at = [[*intervals].index(name) + 0.22 for name in there["entry"]]
        axes.plot(there["score"], at, ".", ms=4, color="0.4")
        none, law = laws.loc[level, NO_STEERING], laws.loc[level, REFERENCE]
        axes.axvline((laws.loc[level, "paper's law"] - none) / (law - none), color="0.4", ls=":")
        axes.set_title(title(level, budget), loc="left")
    panels[-1, 0].set_xlabel("score: 0 no steering, dotted the paper's law, 1 the damped law")


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


PLOTS = {
    "scores": Plot([ENTRIES, ORDERS, LAWS], scores, (6.8, 4.6)),
    "profile": Plot([ORDERS], profile, (6.8, 3.6)),
}
script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
