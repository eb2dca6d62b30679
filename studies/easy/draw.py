"""Draw the order that each seed reaches against minutes of one core."""

from pathlib import Path

from matplotlib.figure import Figure

from docs.scripts.plots import Plot, rows
from studies.plots import drawing, levels, seed_points
from studies.study import main

RESULTS = Path(__file__).parent / "results"
EASY = RESULTS / "curve.csv"


def easy(figure: Figure) -> None:
    """Draw the order that each seed reaches against minutes of one core."""
    axes = figure.subplots()
    found = [{**row, "min": str(float(row["cpu_s"]) / 60)} for row in rows(EASY, policy="PPO")]
    for place, seed in enumerate(sorted({row["seed"] for row in found})):
        own = [row for row in found if row["seed"] == seed]
        label = "" if place else "PPO, five seeds"
        seed_points(axes, own, "min", fmt="o-", lw=1.5, label=label)
    laws = ("paper's law", "damped law")
    levels(axes, [row for law in laws for row in rows(EASY, policy=law)])
    axes.set(xlabel="minutes of one core", ylabel="signed order")
    axes.legend(loc="lower right")


PLOTS = {
    "curve": Plot([EASY], easy, (6.0, 3.8)),
}


script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
