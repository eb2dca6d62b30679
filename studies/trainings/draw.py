"""Draw what trainings reach, by flock-hours and by algorithm."""

from pathlib import Path

from matplotlib.figure import Figure

from docs.scripts.plots import Plot, listed, rows
from studies.plots import OWN, drawing, levels, numbers, seed_points
from studies.study import main

RESULTS = Path(__file__).parent / "results"
EXAMPLE = RESULTS / "algorithms/evaluation.csv"
"""The evaluation of trainings by the example, 500 flock-hours each."""
MIXED = {
    500: RESULTS / "pretrained/evaluation-500.csv",
    1101: RESULTS / "pretrained/evaluation.csv",
}
"""Evaluations of the trainings with one to four leaders of `make pretrained`, by flock-hours."""
ALGORITHMS = {
    "PPO, 500 flock-hours": ("algorithms", "train_leaders"),
    "TRPO, 500": ("algorithms", "trpo"),
    "groups of branches, 200": ("group", "seed"),
    "pairs of branches, 200": ("paired", "seed"),
    "evolution strategy, 500": ("algorithms", "evolution"),
}
"""Folders of algorithms and their names there."""


def budgets(figure: Figure) -> None:
    """Draw the order of each seed, those of a budget beside each other."""
    axes = figure.subplots()
    # Beside other algorithms the example is called `train_leaders`.
    groups = [
        (EXAMPLE, "train", "500\nthree leaders", {"fmt": "o"}),
        (MIXED[500], "seed", "500\none to four", {"fmt": "s", "mfc": "white"}),
        (MIXED[1101], "seed", "1101\none to four", {"fmt": "s", "mfc": "white"}),
    ]
    for middle, (file, start, _, style) in enumerate(groups):
        found = [each for each in rows(file) if each["policy"].startswith(start)]
        for place, row in enumerate(found):
            at = middle + 0.08 * (place - (len(found) - 1) / 2)
            seed_points(axes, [{**row, "at": str(at)}], "at", **style)
    levels(axes, rows(MIXED[1101])[:2])
    axes.set_xticks(range(len(groups)), [each[2] for each in groups])
    axes.set(xlabel="flock-hours of the training, and its leaders", ylabel="signed order")
    axes.set_xlim(-0.75, 2.5)


def algorithms(figure: Figure) -> None:
    """Draw what each algorithm gains on the tuned law, its seeds as dots."""
    axes = figure.subplots()
    means, seeds = {}, []
    for name, (folder, called) in ALGORITHMS.items():
        (row,) = rows(RESULTS / f"{folder}/algorithms.csv", algorithm=called)
        means[name] = numbers(row, "gain", "gain_low", "gain_high")
        own = [
            each
            for each in rows(RESULTS / f"{folder}/evaluation.csv")
            if each["policy"][:4] == called[:4]
        ]
        seeds.append([float(each["gain"]) for each in own])
    listed(axes, means, dict.fromkeys(means, OWN), 0.0)
    for line, gains in enumerate(seeds):
        axes.plot(gains, [line + 0.22] * len(gains), ".", color="0.5")
    axes.set_xlabel("signed order minus the tuned law's")


PLOTS = {
    "budgets": Plot([EXAMPLE, *MIXED.values()], budgets),
    "gains": Plot(
        [
            RESULTS / f"{each}/{file}.csv"
            for each in ("algorithms", "paired", "group")
            for file in ("algorithms", "evaluation")
        ],
        algorithms,
        (6.8, 2.8),
    ),
}


script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
