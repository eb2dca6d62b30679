"""Draw the order that each seed reaches against its processor time."""

from pathlib import Path

from matplotlib.figure import Figure

from docs.scripts.plots import Plot, rows
from studies.plots import drawing, levels, seed_points
from studies.study import main

RESULTS = Path(__file__).parent / "results"
EASY = RESULTS / "curve.csv"


def easy(figure: Figure) -> None:
    """Draw the order that each seed reaches against its processor time."""
    axes = figure.subplots()
    for seed in sorted({row["seed"] for row in rows(EASY, policy="PPO")}):
        seed_points(axes, rows(EASY, policy="PPO", seed=seed), "cpu_s", fmt="o-", lw=1.5)
    laws = ("paper's law", "damped law")
    levels(axes, [row for law in laws for row in rows(EASY, policy=law)])
    axes.set(xlabel="processor time of the training, s", ylabel="signed order")


PLOTS = {
    "curve": Plot([EASY], easy),
}


script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
