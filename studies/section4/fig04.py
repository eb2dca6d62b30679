"""Figure 4: snapshots of the four states, each the clearest frame that a rule finds."""

import math
from typing import Any

import numpy as np
from matplotlib.patches import Circle

import flockenv
from flockenv.statistics.structure import structure_series
from studies.picture import COLORS, picture
from studies.section4.states import STATES
from studies.study import Options, Row, main, simulated

_TITLES = ("jamming", "clustering", "ordered motion", "disordered motion")
_NOISE_S = (0.4, 1.4, 1.0, 2.8)
"""Where each state is looked for: the noises at which Table 2 has it."""
_RUNS = 8
_ENDS = np.array([-1.0, 1.0])


def clearest(state: str, bw_s: float, minutes: float) -> tuple[flockenv.Recording, int] | None:
    """Return the run and sample in a state with the highest Ψ_o.

    Of disorder it is the lowest Ψ_o, and of clustering the largest cluster.
    """
    best: tuple[float, flockenv.Recording, int] | None = None
    for seed in range(_RUNS):
        row: Row = {"preset": "experiment", "bw_s": bw_s, "minutes": minutes, "seed": seed}
        run = simulated(row, sample_hz=2.0)
        used = np.flatnonzero(run.in_analysis_window)
        clusters = np.zeros(len(run.time_s))
        clusters[used] = structure_series("largest_cluster", run.parameters, run.pose[used])
        names = run.order.states(run.parameters.speed_cm_s, clusters)[used]
        worth = {"clustering": clusters[used], "disordered": -run.order.psi_o[used]}.get(
            state, run.order.psi_o[used]
        )
        inside = np.array([name.startswith(state) for name in names])
        place = int(np.where(inside, worth, -np.inf).argmax())
        if inside.any() and (best is None or worth[place] > best[0]):
            best = float(worth[place]), run, int(used[place])
    return None if best is None else best[1:]


def snapshot(axes: Any, run: flockenv.Recording, sample: int) -> None:
    """Draw a frame: hulls as thick lines with a point at the bow."""
    p = run.parameters
    outer, inner = 90.0, 48.5
    for radius in (outer, inner):
        axes.add_patch(Circle((0, 0), radius, fill=False, linewidth=0.8))
    half = p.boat_radius_cm * p.boat_shape
    scale = 72.0 * axes.figure.get_figwidth() / 4 / (2 * outer) * 0.92
    for x, y, alpha in run.pose[sample]:
        step = half * np.array([math.cos(alpha), math.sin(alpha)])
        (x0, x1), (y0, y1) = x + step[0] * _ENDS, y + step[1] * _ENDS
        width = 2 * p.boat_radius_cm * scale
        axes.plot([x0, x1], [y0, y1], color="0.6", linewidth=width, solid_capstyle="round")
        axes.plot([x1], [y1], "o", color=COLORS[1], markersize=0.5 * width)
    axes.set(xlim=(-92, 92), ylim=(-92, 92), aspect="equal")
    axes.set_axis_off()


def script(options: Options) -> None:
    """Find and draw the four frames."""
    with picture(options, "fig04", height_cm=5.2) as figure:
        for axes, state, title, bw_s in zip(
            figure.subplots(1, 4), STATES, _TITLES, _NOISE_S, strict=False
        ):
            found = clearest(state, bw_s, 0.5 if options.trial else 16.0)
            axes.set_axis_off()
            axes.set_title(f"{title}: no frame")
            if found is not None:
                snapshot(axes, *found)
                psi_o = found[0].order.psi_o[found[1]]
                axes.set_title(f"{title}\nbw = {bw_s:g} s, Ψ_o = {psi_o:.2f}")


if __name__ == "__main__":
    main(script)
