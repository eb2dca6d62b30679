"""The plots of the pages about training."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from committed_data import Row, rows
from interval_plots import Plot, across, colors_of, listed
from matplotlib.axes import Axes
from matplotlib.figure import Figure

EASY = "easy/curve.csv"
SIGNALS = "results/signals.csv"
PAIRED = "training/paired/signal.csv"
EXAMPLE = "training/algorithms/evaluation.csv"
"""The evaluation of trainings by the example, 500 flock-hours each."""
MIXED = {
    500: "training/pretrained/evaluation-500.csv",
    1101: "training/pretrained/evaluation.csv",
}
"""Evaluations of the trainings with one to four leaders of `make pretrained`, by flock-hours."""
NOTHING = {
    pool: [f"training/from_nothing/{pool}_{seed}/curve.csv" for seed in seeds]
    for pool, seeds in {"wide": (0, 1, 2), "narrow": (2, 3, 4)}.items()
}
ALGORITHMS = {
    "PPO, 500 flock-hours": ("training/algorithms", "train_leaders"),
    "TRPO, 500": ("training/algorithms", "trpo"),
    "groups of branches, 200": ("training/group", "seed"),
    "pairs of branches, 200": ("training/paired", "seed"),
    "evolution strategy, 500": ("training/algorithms", "evolution"),
}
"""Folders of algorithms and their names there."""
COLORS = colors_of(["mine", "damped law", "paper's law", "tuned law"])
OWN = COLORS["mine"]
"""The color of what a reader trains."""


def easy(figure: Figure) -> None:
    """Draw the order that each seed reaches against its processor time."""
    axes = figure.subplots()
    for seed in sorted({row["seed"] for row in rows(EASY, policy="PPO")}):
        _seed(axes, rows(EASY, policy="PPO", seed=seed), "cpu_s", fmt="o-", lw=1.5)
    laws = ("paper's law", "damped law")
    _levels(axes, [row for law in laws for row in rows(EASY, policy=law)])
    axes.set(xlabel="processor time of the training, s", ylabel="signed order")


def budgets(figure: Figure) -> None:
    """Draw the order of each seed against the flock-hours of its training."""
    axes = figure.subplots()
    # Beside other algorithms the example is called `train_leaders`.
    found = [each for each in rows(EXAMPLE) if each["policy"].startswith("train")]
    for place, row in enumerate(found):
        _seed(axes, [{**row, "at": str(500 + 16 * (place - 2))}], "at", fmt="o")
    for hours, file in MIXED.items():
        mixed = [each for each in rows(file) if each["policy"].startswith("seed")]
        for place, row in enumerate(mixed):
            at = hours + 16 * (place - 3.5)
            _seed(axes, [{**row, "at": str(at)}], "at", fmt="s", mfc="white")
    _levels(axes, rows(MIXED[1101])[:2])
    axes.set(xlabel="flock-hours of the training", ylabel="signed order", xlim=(120, 1300))


def algorithms(figure: Figure) -> None:
    """Draw what each algorithm gains on the tuned law, its seeds as dots."""
    axes = figure.subplots()
    means, seeds = {}, []
    for name, (folder, called) in ALGORITHMS.items():
        (row,) = rows(f"{folder}/algorithms.csv", algorithm=called)
        means[name] = _numbers(row, "gain", "gain_low", "gain_high")
        own = [
            each for each in rows(f"{folder}/evaluation.csv") if each["policy"][:4] == called[:4]
        ]
        seeds.append([float(each["gain"]) for each in own])
    listed(axes, means, dict.fromkeys(means, OWN), 0.0)
    for line, gains in enumerate(seeds):
        axes.plot(gains, [line + 0.22] * len(gains), ".", color="0.5")
    axes.set_xlabel("signed order minus the tuned law's")


def nothing(figure: Figure) -> None:
    """Draw what leaders from nothing reach, and the laws in their flocks."""
    panels = figure.subplots(1, 2)
    for axes, (pool, files) in zip(panels, NOTHING.items(), strict=True):
        ends = [rows(file, stage="end") for file in files]
        found = {
            f"seed {file.split('/')[2][-1]}": end[-1] for file, end in zip(files, ends, strict=True)
        }
        found |= {row["policy"]: row for row in reversed(ends[0][:-1])}
        colors = {name: COLORS.get(name, OWN) for name in found}
        listed(axes, {name: _numbers(row, *_ENDS) for name, row in found.items()}, colors)
        learner = ends[0][-1]["policy"]
        axes.set(title=f"{pool}, {learner}", xlabel="signed order")


def signals(figure: Figure) -> None:
    """Draw how clearly samples of each reward show the way to a better policy."""
    names = ("leader_velocity", "contact_push", "contact_alignment", "signed_order")
    cases = (("rudder", "wide"), ("rudder", "narrow"), ("lean", "wide"))
    panels = figure.subplots(1, 3, sharey=True)
    for axes, (mode, pool) in zip(panels, cases, strict=True):
        found = {}
        for name in names:
            (row,) = rows(SIGNALS, pool=pool, action_mode=mode, reward=name)
            z, error = float(row["z_per_million"]), float(row["error"])
            found[name] = (z, z - 1.96 * error, z + 1.96 * error)
        listed(axes, found, dict.fromkeys(found, "0.15"), 0.0)
        axes.set(title=f"{mode}s in {pool}", xlabel="z for a million samples")


def paired(figure: Figure) -> None:
    """Draw how clearly the order after a branch shows which policy is better."""
    axes = figure.subplots()
    called = {"True": "one state, one noise", "False": "other flocks"}
    found = [{**row, "paired": called[row["paired"]]} for row in rows(PAIRED)]
    across(axes, found, "horizon_s", ("z", "z_low", "z_high"), by="paired", shift=2.0)
    axes.axhline(0.0, color="0.4", lw=1)
    axes.set(xlabel="seconds after the branch", ylabel="z of the order for one flock-hour")
    axes.legend()


_ENDS = ("signed_order", "low", "high")


def _numbers(row: Row, *names: str) -> tuple[float, float, float]:
    mean, low, high = (float(row[name]) for name in names)
    return mean, low, high


def _seed(axes: Axes, found: Sequence[Row], x: str, **style: Any) -> None:
    """Draw what a seed reaches against a column x."""
    points = [(float(row[x]), *_numbers(row, *_ENDS)) for row in found]
    at, mean, low, high = np.array(points).T
    axes.errorbar(at, mean, (mean - low, high - mean), ms=5, capsize=3, color=OWN, **style)


def _levels(axes: Axes, laws: Sequence[Row]) -> None:
    """Draw what laws reach as bands as high as their intervals, their names at the left."""
    for row in laws:
        name, (mean, low, high) = row["policy"], _numbers(row, *_ENDS)
        axes.axhspan(low, high, color=COLORS[name], alpha=0.2, lw=0)
        axes.axhline(mean, color=COLORS[name], lw=1.5)
        axes.annotate(
            name, (0.0, mean), (4, 3), axes.get_yaxis_transform(), "offset points",
            color=COLORS[name],
        )  # fmt: skip


PLOTS = {
    "easy/curve.png": Plot([EASY], easy),
    "training/budgets.png": Plot([EXAMPLE, *MIXED.values()], budgets),
    "training/algorithms/gains.png": Plot(
        [
            f"training/{each}/{file}.csv"
            for each in ("algorithms", "paired", "group")
            for file in ("algorithms", "evaluation")
        ],
        algorithms,
        (6.8, 2.8),
    ),
    "training/from_nothing/reached.png": Plot(
        [file for files in NOTHING.values() for file in files], nothing, (8.4, 3.2)
    ),
    "results/signals.png": Plot([SIGNALS], signals, (8.4, 2.8)),
    "training/paired/signal.png": Plot([PAIRED], paired),
}
"""How each is drawn, by its file below docs."""
