"""Draw what leaders from nothing reach, and the laws in their flocks."""

from pathlib import Path

from matplotlib.figure import Figure

from docs.scripts.plots import Plot, listed, rows
from studies.plots import COLORS, OWN, drawing, numbers
from studies.study import main

RESULTS = Path(__file__).parent / "results"
NOTHING = {
    pool: [RESULTS / f"{pool}_{seed}.csv" for seed in seeds]
    for pool, seeds in {"wide": (0, 1, 2), "narrow": (2, 3, 4)}.items()
}


def nothing(figure: Figure) -> None:
    """Draw what leaders from nothing reach, and the laws in their flocks."""
    panels = figure.subplots(1, 2)
    for axes, (pool, files) in zip(panels, NOTHING.items(), strict=True):
        ends = [rows(file, stage="end") for file in files]
        found = {f"seed {file.stem[-1]}": end[-1] for file, end in zip(files, ends, strict=True)}
        found |= {row["policy"]: row for row in reversed(ends[0][:-1])}
        colors = {name: COLORS.get(name, OWN) for name in found}
        listed(axes, {name: numbers(row) for name, row in found.items()}, colors)
        learner = ends[0][-1]["policy"]
        axes.set(title=f"{pool}, {learner}", xlabel="signed order")


PLOTS = {
    "reached": Plot([file for files in NOTHING.values() for file in files], nothing, (8.4, 3.2)),
}


script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
