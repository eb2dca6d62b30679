"""Draw what the learned leaders and both planners reach, and what one step of planning adds."""

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from docs.scripts.plots import Plot, listed, rows
from flockenv.statistics import mean_interval, student_interval
from studies.plots import OWN, drawing
from studies.study import main

RESULTS = Path(__file__).parent / "results"
OFFSETS = RESULTS / "best_of_offsets.csv"
LEARNED = "learned"
PLANS = {"planner, noise known": "known", "planner, noise unknown": "fresh"}


def planned(noise: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the signed orders of the learned leaders and of a planner, in the same episodes."""
    found = rows(RESULTS / f"plan_{noise}.csv")
    learned, plan = ([float(row[name]) for row in found] for name in ("learned", "planned"))
    return np.array(learned), np.array(plan)


def plans(figure: Figure) -> None:
    """Draw what the learned leaders and both planners reach, and what planning adds."""
    left, right = figure.subplots(1, 2, sharey=True)
    orders = {name: planned(noise) for name, noise in PLANS.items()}
    (learned, _), *_ = orders.values()
    means, gains = {LEARNED: student_interval(learned)}, {LEARNED: (0.0, 0.0, 0.0)}
    for name, (own, plan) in orders.items():
        means[name], gains[name] = student_interval(plan), student_interval(plan - own)
    listed(left, means)
    listed(right, gains, reference=0.0)
    left.set(xlabel="signed order", xlim=(0, 1))
    right.set(xlabel="minus learned")


def offsets(figure: Figure) -> None:
    """Draw what the best of 16 offsets adds by each horizon: the mean, and each state as a dot."""
    table = pd.read_csv(OFFSETS)
    named = {f"to {horizon} s": own["gain"] for horizon, own in table.groupby("horizon_s")}
    axes = figure.subplots()
    means = {name: mean_interval(own) for name, own in named.items()}
    listed(axes, means, dict.fromkeys(means, OWN), 0.0)
    for place, own in enumerate(named.values()):
        spread = np.linspace(0.2, 0.4, len(own))
        axes.plot(own, place + spread, ".", ms=3, color="0.6")
    axes.set(xlabel="mean order with the best offset minus without")


PLOTS = {
    "offsets": Plot([OFFSETS], offsets, (6.8, 2.4)),
    "plans": Plot([RESULTS / "plan_known.csv", RESULTS / "plan_fresh.csv"], plans, (8.4, 2.2)),
}


script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
