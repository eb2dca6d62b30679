"""Draw what the learned leaders and both planners reach."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from docs.scripts.plots import Plot, listed, rows
from flockenv.statistics import student_interval
from studies.plots import drawing
from studies.study import main

RESULTS = Path(__file__).parent / "results"
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


PLOTS = {
    "plans": Plot([RESULTS / "plan_known.csv", RESULTS / "plan_fresh.csv"], plans, (8.4, 2.2)),
}


script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
