"""Draw the error of each quantity by the faults of a camera."""

from collections.abc import Iterable
from pathlib import Path

from matplotlib.figure import Figure

from docs.scripts.plots import Plot, rows
from studies.plots import drawing
from studies.study import main

RESULTS = Path(__file__).parent / "results"
ERRORS = RESULTS / "track_errors.csv"
QUANTITIES = {
    "psi_o": "Ψ_o",
    "nematic": "nematic order",
    "milling": "milling",
    "psi_v": "Ψ_v [cm/s]",
    "largest_cluster": "largest cluster",
}
MARKERS = "os^Dv"


def track_errors(figure: Figure) -> None:
    """Draw the error of each quantity on a line, a marker for each fault of the camera."""
    axes = figure.subplots()
    for place, row in enumerate(rows(ERRORS)):
        errors = [float(row[name]) for name in QUANTITIES]
        lines: Iterable[float] = [line + 0.12 * (place - 2) for line in range(len(QUANTITIES))]
        axes.plot(errors, lines, MARKERS[place], ms=6, label=row["camera"])
    axes.set(xscale="log", xlabel="mean absolute error")
    axes.set_yticks(range(len(QUANTITIES)), [*QUANTITIES.values()])
    axes.invert_yaxis()
    figure.legend(loc="outside lower center", ncols=2)


PLOTS = {"track_errors": Plot([ERRORS], track_errors, (6.8, 4.2))}
script = drawing(__name__, PLOTS)


if __name__ == "__main__":
    main(script)
