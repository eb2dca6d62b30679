"""Draw the scores of the suite and of its grid."""

from pathlib import Path

from matplotlib.figure import Figure

from docs.scripts.plots import Interval, Plot, rows
from flockenv.comparison.figure import policy_colors
from studies.plots import drawing, grouped, interval
from studies.study import main

RESULTS = Path(__file__).parent / "results"
SCORES, GRID = RESULTS / "v2.csv", RESULTS / "grid-100.csv"
ALGORITHMS = {
    "ppo": "PPO",
    "trpo": "TRPO",
    "evolution": "evolution",
    "recurrent-ppo": "recurrent PPO",
    "sac": "SAC",
    "ippo": "IPPO",
    "mappo": "MAPPO",
}
INPUTS = {
    "lean-linear": "lean features, linear",
    "lean-network": "lean features, network",
    "default-network": "default observation, network",
}
IMPROVED = "probability of improvement"
SHIFT = 0.27
"""Between the inputs of an algorithm."""


def scores(figure: Figure) -> None:
    """Draw the scores of the learned leaders and of laws in each task."""
    found: dict[str, dict[str, Interval]] = {}
    for row in rows(SCORES):
        found.setdefault(row["policy"], {})[row["task"]] = interval(
            row, "score", "score_low", "score_high"
        )
    left, right = figure.subplots(1, 2, width_ratios=(3, 1))
    improved = {name: {"": own.pop(IMPROVED)} for name, own in found.items()}
    grouped(left, found, reference=0.0)
    grouped(right, improved, reference=0.5)
    left.set(xlabel="signed order beyond the tuned law")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    right.set(title="all tasks", xlabel=IMPROVED.replace(" of ", "\nof "))


def scores_size() -> tuple[float, float]:
    """Return a size in which each policy has room in each task."""
    found = rows(SCORES)
    tasks = {row["task"] for row in found if row["task"] != IMPROVED}
    policies = {row["policy"] for row in found}
    return 8.4, 0.8 + 0.15 * len(tasks) * len(policies)


def grid(figure: Figure) -> None:
    """Draw the scores of each algorithm with each input: all seeds together, and each as a dot."""
    panels = figure.subplots(1, 2, sharey=True)
    found = {words: rows(GRID, input=name) for name, words in INPUTS.items()}
    colors = policy_colors(found)
    for axes, what, reference in zip(panels, ("iqm", "improvement"), (0.0, 0.5), strict=True):
        names = (what, f"{what}_low", f"{what}_high")
        means = {
            words: {
                ALGORITHMS[row["algorithm"]]: tuple(float(row[name]) for name in names)
                for row in own
                if row["seed"] == "all"
            }
            for words, own in found.items()
        }
        grouped(axes, means, colors, reference, SHIFT)
        for place, (words, own) in enumerate(found.items()):
            seeds = [row for row in own if row["seed"] != "all"]
            at = [
                [*ALGORITHMS].index(row["algorithm"]) + SHIFT * (place - 1) + 0.09 for row in seeds
            ]
            axes.plot([float(row[what]) for row in seeds], at, ".", ms=4, color=colors[words])
    panels[0].set(xlabel="interquartile mean beyond the tuned law")
    panels[1].set(xlabel=IMPROVED)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)


PLOTS = {
    "scores": Plot([SCORES], scores, scores_size),
    "grid": Plot([GRID], grid, (8.4, 6.4)),
}
script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
