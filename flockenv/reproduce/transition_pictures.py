"""The pictures of `transition-order`: colour is the size or the density, the line the start."""

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from flockenv.block_bootstrap import interval
from flockenv.loops import DENSITY_RATIO
from flockenv.prepared_start import STARTS
from flockenv.reproduce.style import COLORS, column_figure, paper_style
from flockenv.reproduce.transition_design import LOOPS, WAYS, Growth, TransitionDesign
from flockenv.reproduce.transition_measured import (
    C_V_EDGES,
    CENTRES,
    M_EDGES,
    Measured,
    Still,
    student,
)

__all__ = ["pictures"]

_LINES = dict(zip(STARTS, ("-", "--"), strict=True))
_MARKS = ("o", "s", "^", "D", "v", "P")
_OUTWARD = r"mean $\Psi_o\,\cos\varphi_o$"
_QUANTITIES = {
    "m": (r"$m = \Psi_o\,\sin\varphi_o$", M_EDGES, ""),
    "c_v": (r"$C_v$ (cm²/s²)", C_V_EDGES, " (s²/cm²)"),
}


def pictures(measured: Measured) -> dict[str, Figure]:
    """Return the pictures: states and loops, cumulants against size, and histograms."""
    with paper_style():
        return {
            "transition-order": _states_and_loops(measured),
            "cumulants": _cumulants(measured),
            **{f"histograms_{name}": _histograms(measured, name) for name in _QUANTITIES},
        }


def _states_and_loops(measured: Measured) -> Figure:
    design = measured.design
    picture = column_figure(17.5)
    panels = picture.subplots(4, len(WAYS), sharey="row")
    for column, way in enumerate(WAYS):
        at_rest, density_loops, noise_loops, openings = panels[:, column]
        at_rest.set_title(f"growing the {way}")
        lowest = design.densities[way][0]
        for place, n in enumerate(design.sizes):
            growth, color = Growth(way, n), COLORS[place % len(COLORS)]
            for start in STARTS:
                _draw_states(at_rest, measured, growth, start, color)
            slow, noise = (measured.loops[growth, kind] for kind in ("slow density", "noise"))
            _draw_loop(density_loops, lowest * DENSITY_RATIO**CENTRES, slow.there, slow.back, color)
            _draw_loop(noise_loops, 0.6 * CENTRES, noise.there, noise.back, color)
        _draw_openings(openings, measured, way)
        for axes in (at_rest, density_loops):
            axes.set_xscale("log")
            _name_ticks(axes, design.densities[way])
            axes.set_xlabel("density (boats / pool)")
        noise_loops.set_xlabel("bw (s)")
        openings.set_xlabel("boats")
    for axes in panels[:3, 0]:
        axes.set_ylabel(_OUTWARD)
    panels[3, 0].set_ylabel("opening of loops")
    panels[3, 0].legend()
    _size_legend(panels[0, 0], design)
    _line_legend(panels[0, 1], {f"begun {start}": line for start, line in _LINES.items()})
    _line_legend(panels[1, 1], {"density rises": "-", "falls (slow loop)": "--"})
    _line_legend(panels[2, 1], {"bw rises": "-", "falls": "--"})
    return picture


def _draw_states(axes: Axes, measured: Measured, growth: Growth, start: str, color: str) -> None:
    densities = measured.design.densities[growth.way]
    ends = np.array([student(measured.still[growth, d, start].outward) for d in densities])
    bars = [ends[:, 0] - ends[:, 1], ends[:, 2] - ends[:, 0]]
    # Sizes side by side, or their bars hide each other.
    shift = 1.04 ** (measured.design.sizes.index(growth.n_boats) - len(measured.design.sizes) // 2)
    x = np.array(densities) * shift
    axes.errorbar(x, ends[:, 0], bars, fmt=f"o{_LINES[start]}", color=color, elinewidth=0.6)


def _draw_loop(
    axes: Axes,
    x: NDArray[np.float64],
    there: NDArray[np.float64],
    back: NDArray[np.float64],
    color: str,
) -> None:
    axes.plot(x, there, "-", color=color)
    axes.plot(x, back, "--", color=color)


def _draw_openings(axes: Axes, measured: Measured, way: str) -> None:
    sizes = measured.design.sizes
    for place, kind in enumerate(LOOPS):
        ends = np.array([student(measured.loops[Growth(way, n), kind].openings) for n in sizes])
        bars = [ends[:, 0] - ends[:, 1], ends[:, 2] - ends[:, 0]]
        x = np.array(sizes) * 1.12 ** (place - 1)
        marker, color = f"{_MARKS[place]}-", COLORS[place + 3]
        axes.errorbar(x, ends[:, 0], bars, fmt=marker, color=color, elinewidth=0.6, label=kind)
    axes.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    axes.set_xscale("log")
    _name_ticks(axes, sizes)


def _cumulants(measured: Measured) -> Figure:
    design = measured.design
    picture = column_figure(9.5)
    panels = picture.subplots(2, len(WAYS), sharey="row", sharex=True)
    chosen: tuple[tuple[str, Callable[[Still], NDArray[np.float64]]], ...] = (
        ("m", lambda still: still.binder_m),
        (r"$C_v$", lambda still: still.binder_c_v),
    )
    for column, way in enumerate(WAYS):
        panels[0, column].set_title(f"growing the {way}")
        for row, (name, cumulant) in enumerate(chosen):
            axes = panels[row, column]
            for place, density in enumerate(design.densities[way]):
                for start in STARTS:
                    ends = np.array(
                        [
                            interval(cumulant(measured.still[Growth(way, n), density, start]))
                            for n in design.sizes
                        ]
                    )
                    label = str(density) if start == STARTS[0] else None
                    line = f"{_MARKS[place % len(_MARKS)]}{_LINES[start]}"
                    _draw_cumulant(axes, design, ends, line, place, label)
            axes.axhline(2 / 3, color="0.6", lw=0.6, zorder=0)
            axes.set_xscale("log")
            _name_ticks(axes, design.sizes)
            panels[row, 0].set_ylabel(f"Binder cumulant of {name}")
        panels[0, column].legend(title="density", ncols=2, title_fontsize=6.5)
        panels[1, column].set_xlabel("boats")
    # Heavy tails about 0 make cumulants as low as -10, which would hide all others.
    for axes in panels[:, 0]:
        axes.set_ylim(-2.0, 0.8)
    _line_legend(panels[1, 1], {f"begun {start}": line for start, line in _LINES.items()})
    return picture


def _draw_cumulant(
    axes: Axes,
    design: TransitionDesign,
    ends: NDArray[np.float64],
    line: str,
    place: int,
    label: str | None,
) -> None:
    color = COLORS[place % len(COLORS)]
    bars = [ends[:, 0] - ends[:, 1], ends[:, 2] - ends[:, 0]]
    x = np.array(design.sizes) * 1.06 ** (place - 1)
    axes.errorbar(x, ends[:, 0], np.abs(bars), fmt=line, color=color, elinewidth=0.6, label=label)


def _histograms(measured: Measured, name: str) -> Figure:
    design = measured.design
    label, edges, unit = _QUANTITIES[name]
    picture = column_figure(3.2 * len(design.sizes) + 1.0)
    panels = picture.subplots(len(design.sizes), len(WAYS), sharex=True, squeeze=False)
    for column, way in enumerate(WAYS):
        panels[0, column].set_title(f"growing the {way}")
        for row, n in enumerate(design.sizes):
            axes = panels[row, column]
            for place, density in enumerate(design.densities[way]):
                for start in STARTS:
                    heights = getattr(
                        measured.still[Growth(way, n), density, start], f"{name}_density"
                    )
                    axes.stairs(
                        heights,
                        edges,
                        color=COLORS[place % len(COLORS)],
                        ls=_LINES[start],
                        lw=0.9,
                        label=str(density) if start == STARTS[0] else None,
                    )
            axes.set_yscale("log")
            axes.text(0.5, 0.97, f"{n} boats", transform=axes.transAxes, ha="center", va="top")
            panels[row, 0].set_ylabel(f"probability density{unit}")
        panels[-1, column].set_xlabel(label)
        panels[0, column].legend(title="density", title_fontsize=6.5, loc="upper left")
    return picture


def _name_ticks(axes: Axes, values: Sequence[int]) -> None:
    axes.set_xticks(values, [str(value) for value in values])
    axes.set_xticks([], minor=True)


def _size_legend(axes: Axes, design: TransitionDesign) -> None:
    handles = [
        Line2D([], [], color=COLORS[place % len(COLORS)], label=str(n))
        for place, n in enumerate(design.sizes)
    ]
    axes.legend(handles=handles, title="boats", title_fontsize=6.5)


def _line_legend(axes: Axes, lines: dict[str, str]) -> None:
    handles = [Line2D([], [], color="0.3", ls=line, label=label) for label, line in lines.items()]
    axes.legend(handles=handles)
