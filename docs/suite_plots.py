"""The plots of the page about the suite."""

from collections.abc import Mapping

from committed_data import Row, rows
from interval_plots import Interval, Plot, grouped
from matplotlib.axes import Axes
from matplotlib.figure import Figure

SCORES = "suite/v2.csv"
BASELINES = "suite/baselines.csv"
ALGORITHMS = {"PPO": "ppo", "evolution": "evolution", "IPPO": "ippo", "MAPPO": "mappo"}
"""Algorithms by their words; the rows of their policies are named ALGORITHM-FLOCK_HOURS-SEED."""
BUDGETS = {"1000": "0.15", "100": "0.6"}
"""The color of each budget in flock-hours."""
IMPROVED = "probability of improvement"


def scores(figure: Figure) -> None:
    """Draw the scores of the learned leaders and of laws in each task."""
    found: dict[str, dict[str, Interval]] = {}
    for row in rows(SCORES):
        found.setdefault(row["policy"], {})[row["task"]] = _ends(row)
    left, right = figure.subplots(1, 2, width_ratios=(3, 1))
    improved = {name: {"": own.pop(IMPROVED)} for name, own in found.items()}
    grouped(left, found, reference=0.0)
    grouped(right, improved, reference=0.5)
    left.set(xlabel="signed order beyond the tuned law")
    left.legend(loc="lower left", fontsize=9)
    right.set(title="all tasks", xlabel=IMPROVED.replace(" of ", "\nof "))


def baselines(figure: Figure) -> None:
    """Draw the scores of every trained policy: a panel for each task and for all of them."""
    found = {(row["policy"], row["task"]): row for row in rows(BASELINES)}
    *tasks, middle, improved = dict.fromkeys(task for _, task in found)
    panels = figure.subplots(4, 2, sharey=True)
    shown = [_ends(row) for (_, task), row in found.items() if task != improved]
    ends = (min(low for _, low, _ in shown), max(high for _, _, high in shown))
    for axes, task in zip(panels.flat, [middle, improved, *tasks], strict=True):
        _of_task(axes, {name: row for (name, other), row in found.items() if other == task})
        axes.axvline(0.5 if task == improved else 0.0, color="0.4", lw=1)
        axes.set_title(task)
        if task != improved:
            axes.set_xlim(*ends)
    handles, labels = panels[0, 0].get_legend_handles_labels()
    budgets = {f"{hours} flock-hours": handles[labels.index(f"{hours}-0")] for hours in BUDGETS}
    figure.legend(budgets.values(), budgets, loc="outside lower center", ncols=2)


def _of_task(axes: Axes, found: Mapping[str, Row]) -> None:
    series = {
        f"{hours}-{seed}": {
            words: _ends(found[f"{name}-{hours}-{seed}"]) for words, name in ALGORITHMS.items()
        }
        for hours in BUDGETS
        for seed in range(3)
    }
    colors = {name: BUDGETS[name.partition("-")[0]] for name in series}
    grouped(axes, series, colors, shift=0.13)


def _ends(row: Row) -> Interval:
    return float(row["score"]), float(row["score_low"]), float(row["score_high"])


PLOTS = {
    "suite/scores.png": Plot([SCORES], scores, (8.4, 5.0)),
    "suite/baselines.png": Plot([BASELINES], baselines, (8.4, 10.0)),
}
"""How each is drawn, by its file below docs."""
