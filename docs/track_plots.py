"""The plot of the page about tracks."""

from collections.abc import Iterable

from committed_data import rows
from interval_plots import Plot
from matplotlib.figure import Figure

ERRORS = "results/track_errors.csv"
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


PLOTS = {"results/track_errors.png": Plot([ERRORS], track_errors, (6.8, 4.2))}
"""How each is drawn, by its file below docs."""
