"""Draw where leaders are and how they head."""

from pathlib import Path

from matplotlib.figure import Figure

from docs.scripts.plots import Plot, rows
from studies.plots import drawing, grouped, interval
from studies.study import main

RESULTS = Path(__file__).parent / "results"
MOTION = RESULTS / "motion.csv"
POOLS = ("wide", "narrow")
SHOWN = {
    "in the row at the wall": "at_wall",
    "beside that row": "beside_wall",
    "close to a leader": "beside_leader",
    "heading, mean cosine": "alignment",
}
"""What the plot of motion shows: shares of the time, and how close to the target leaders head."""


def motion(figure: Figure) -> None:
    """Draw where leaders are and how they head."""
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, pool in zip(panels, POOLS, strict=True):
        found = {
            row["policy"]: {
                words: interval(row, name, f"{name}_low", f"{name}_high")
                for words, name in SHOWN.items()
            }
            for row in rows(MOTION, pool=pool)[::-1]
        }
        grouped(axes, found)
        axes.set(title=pool, xlabel="share of the time, or cosine", xlim=(0, 1))
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)


PLOTS = {
    "motion": Plot([MOTION], motion, (8.4, 3.4)),
}


script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
