"""Draw how clearly the order after a branch shows which policy is better."""

from pathlib import Path

from matplotlib.figure import Figure

from docs.scripts.plots import Plot, rows
from studies.plots import across, drawing
from studies.study import main

RESULTS = Path(__file__).parent / "results"
PAIRED = RESULTS / "signal.csv"


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


PLOTS = {
    "signal": Plot([PAIRED], paired),
}


script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
