"""Draw what a search for each number of leaders adds to the tuned law."""

from pathlib import Path

from matplotlib.figure import Figure

from docs.scripts.plots import Plot, listed, rows
from studies.plots import drawing, interval
from studies.study import main

RESULTS = Path(__file__).parent / "results"
GAINS = RESULTS / "gains.csv"
POOLS = ("wide", "narrow")


def tuned_laws(figure: Figure) -> None:
    """Draw what a search for each number of leaders adds to the tuned law."""
    ends = ("beyond", "beyond_low", "beyond_high")
    found = {pool: {row["leaders"]: row for row in rows(GAINS, pool=pool)} for pool in POOLS}
    shown = {
        pool: {k: interval(row, *ends) for k, row in each.items()} for pool, each in found.items()
    }
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, (pool, gains) in zip(panels, shown.items(), strict=True):
        listed(axes, gains, dict.fromkeys(gains, "0.15"), 0.0)
        axes.set(title=pool, xlabel="searched gains minus tuned law")
    panels[0].set_ylabel("leaders")


PLOTS = {
    "tuned_laws": Plot([GAINS], tuned_laws, (8.4, 2.6)),
}


script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
