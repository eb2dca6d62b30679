"""The pictures of `transition-order`: color is the size or the density, the line the start."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from flockenv.reproduce.style import COLORS, column_figure, paper_style
from flockenv.reproduce.transition.design import (
    LOOP_BW_S,
    LOOPS,
    STARTED,
    WAYS,
    WIDTH_EXPONENTS,
    Growth,
    TransitionDesign,
)
from flockenv.reproduce.transition.jam_map import JamMap
from flockenv.reproduce.transition.measured import (
    C_V_EDGES,
    CENTERS,
    M_EDGES,
    MANY_BOATS,
    Loops,
    Measured,
    Stationary,
)
from flockenv.runs.protocols.hysteresis import DENSITY_RATIO
from flockenv.statistics.intervals import interval, student_interval

__all__ = ["pictures"]

_LINES = dict(zip(STARTED, ("-", "--"), strict=True))
_MARKS = ("o", "s", "^", "D", "v", "P")
_TIGHT: dict[str, Any] = {"columnspacing": 0.8, "handlelength": 1.2, "handletextpad": 0.4}
_OUTWARD = r"mean $\Psi_o\,\cos\varphi_o$"
_QUANTITIES = {
    "m": (r"$m = \Psi_o\,\sin\varphi_o$", M_EDGES, ""),
    "c_v": (r"$C_v$ (cm²/s²)", C_V_EDGES, " (s²/cm²)"),
}


def pictures(measured: Measured, maps: Mapping[tuple[str, str], JamMap]) -> dict[str, Figure]:
    """Return the pictures: jams, states, loops, cumulants against size, and histograms.

    `maps` are those of a run in each way of growing from each start.
    """
    with paper_style():
        return {
            "jams": _jams(measured),
            "jam-maps": _jam_maps(maps),
            "transition-order": _states_and_openings(measured),
            "loops": _loops(measured),
            "cumulants": _cumulants(measured),
            **{f"histograms_{name}": _histograms(measured, name) for name in _QUANTITIES},
        }


def _jams(measured: Measured) -> Figure:
    design = measured.design
    picture = column_figure(10.0)
    panels = picture.subplots(2, len(WAYS), sharey="row", sharex=True)
    for column, way in enumerate(WAYS):
        panels[0, column].set_title(f"{way} grows")
        for place, density in enumerate(design.densities[way]):
            sizes = np.array(design.sizes)
            for start in STARTED:
                found = [measured.stationary[Growth(way, n), density, start].jams for n in sizes]
                for axes, name in zip(panels[:, column], ("mean_size", "share"), strict=True):
                    ends = np.array([student_interval(getattr(each, name)) for each in found])
                    bars = [ends[:, 0] - ends[:, 1], ends[:, 2] - ends[:, 0]]
                    line = f"{_MARKS[place]}{_LINES[start]}"
                    label = str(density) if start == "rotating" else None
                    color = COLORS[place]
                    x = sizes * 1.05 ** (place - 1)
                    axes.errorbar(
                        x, ends[:, 0], bars, fmt=line, color=color, elinewidth=0.6, label=label
                    )
        many = np.array([n for n in design.sizes if n >= MANY_BOATS])
        if len(many):
            for power in (1.0, WIDTH_EXPONENTS[way]):
                line = 40.0 * (many / many[0]) ** power
                panels[0, column].plot(many, line, color="0.6", lw=0.8, zorder=0)
        panels[0, column].set_yscale("log")
        # Room for the legend above the points; runs without jams are below.
        panels[0, column].set_ylim(1.0, 700.0)
        panels[0, column].set_xscale("log")
        _name_ticks(panels[0, column], design.sizes)
        panels[0, column].legend(
            title="density", ncols=3, title_fontsize=6.5, loc="upper left", **_TIGHT
        )
        panels[1, column].set_xlabel("boats")
    panels[0, 0].set_ylabel("mean size of jams (boats)")
    panels[1, 0].set_ylabel("part of the boats in jams")
    handles = _starts()
    picture.legend(handles=handles, loc="outside upper center", ncols=2)
    return picture


def _jam_maps(maps: Mapping[tuple[str, str], JamMap]) -> Figure:
    picture = column_figure(11.0)
    panels = picture.subplots(len(STARTED), len(WAYS), sharex=True, sharey=True)
    for row, start in enumerate(STARTED):
        for column, way in enumerate(WAYS):
            axes, found = panels[row, column], maps[way, start]
            axes.imshow(
                found.share,
                origin="lower",
                aspect="auto",
                extent=(0.0, 360.0, 0.0, found.minutes),
                cmap="gray_r",
                vmin=0.0,
                vmax=2.0,
                interpolation="nearest",
            )
            axes.set_title(f"{found.n_boats} boats, {way}\n{STARTED[start]}")
    for axes in panels[-1]:
        axes.set_xticks([0, 120, 240, 360])
        axes.set_xlabel("polar angle (°)")
    for axes in panels[:, 0]:
        axes.set_ylabel("time (min)")
    return picture


def _states_and_openings(measured: Measured) -> Figure:
    design = measured.design
    picture = column_figure(10.5)
    panels = picture.subplots(2, len(WAYS), sharey="row")
    for column, way in enumerate(WAYS):
        states, openings = panels[:, column]
        states.set_title(f"{way} grows")
        for place, n in enumerate(design.sizes):
            for start in STARTED:
                _draw_states(states, measured, Growth(way, n), start, COLORS[place % len(COLORS)])
        states.set_xscale("log")
        _name_ticks(states, design.densities[way])
        states.set_xlabel("density (boats / pool)")
        _draw_openings(openings, measured, way)
        openings.set_xlabel("boats")
    panels[0, 0].set_ylabel(_OUTWARD)
    panels[1, 0].set_ylabel("opening of loops")
    handles = [*_sizes(design), *_starts()]
    picture.legend(handles=handles, loc="outside upper center", ncols=3)
    picture.legend(*panels[1, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return picture


def _loops(measured: Measured) -> Figure:
    design = measured.design
    picture = column_figure(10.0)
    panels = picture.subplots(2, len(WAYS), sharey="row")
    for column, way in enumerate(WAYS):
        density, noise = panels[:, column]
        density.set_title(f"{way} grows")
        lowest = design.densities[way][0]
        for place, n in enumerate(design.sizes):
            if Growth(way, n) not in design.looped():
                continue
            color = COLORS[place % len(COLORS)]
            loop = measured.loops[Growth(way, n), "slowest density"]
            _draw_loop(density, lowest * DENSITY_RATIO**CENTERS, loop, color)
            _draw_loop(noise, LOOP_BW_S * CENTERS, measured.loops[Growth(way, n), "noise"], color)
        density.set_xscale("log")
        _name_ticks(density, design.densities[way])
        density.set_xlabel("density (boats / pool)")
        noise.set_xlabel(f"bw (s) at density {lowest}")
    for axes in panels[:, 0]:
        axes.set_ylabel(_OUTWARD)
    handles = _sizes(design)[: len(design.looped()) // len(WAYS)]
    handles += _styles({"rising": "-", "falling": "--"})
    picture.legend(handles=handles, loc="outside upper center", ncols=3)
    return picture


def _draw_states(axes: Axes, measured: Measured, growth: Growth, start: str, color: str) -> None:
    densities = measured.design.densities[growth.way]
    ends = np.array(
        [student_interval(measured.stationary[growth, d, start].outward) for d in densities]
    )
    bars = [ends[:, 0] - ends[:, 1], ends[:, 2] - ends[:, 0]]
    # Sizes side by side, or their bars hide each other.
    shift = 1.04 ** (measured.design.sizes.index(growth.n_boats) - len(measured.design.sizes) // 2)
    x = np.array(densities) * shift
    axes.errorbar(x, ends[:, 0], bars, fmt=f"o{_LINES[start]}", color=color, elinewidth=0.6)


def _draw_loop(axes: Axes, x: NDArray[np.float64], loop: Loops, color: str) -> None:
    for branch, band, line in zip((loop.there, loop.back), loop.bands, ("-", "--"), strict=True):
        axes.plot(x, branch, line, color=color)
        axes.fill_between(x, *band, color=color, alpha=0.15, lw=0)


def _draw_openings(axes: Axes, measured: Measured, way: str) -> None:
    sizes = [each.n_boats for each in measured.design.looped() if each.way == way]
    for place, kind in enumerate(LOOPS):
        ends = np.array(
            [student_interval(measured.loops[Growth(way, n), kind].openings) for n in sizes]
        )
        bars = [ends[:, 0] - ends[:, 1], ends[:, 2] - ends[:, 0]]
        x = np.array(sizes) * 1.12 ** (place - 1)
        marker, color = f"{_MARKS[place]}-", COLORS[(place + 3) % len(COLORS)]
        axes.errorbar(x, ends[:, 0], bars, fmt=marker, color=color, elinewidth=0.6, label=kind)
    axes.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    axes.set_xscale("log")
    _name_ticks(axes, sizes)


def _cumulants(measured: Measured) -> Figure:
    design = measured.design
    picture = column_figure(10.5)
    panels = picture.subplots(2, len(WAYS), sharey="row", sharex=True)
    chosen: tuple[tuple[str, Callable[[Stationary], NDArray[np.float64]]], ...] = (
        ("$m$", lambda stationary: stationary.binder_m),
        ("$C_v$", lambda stationary: stationary.binder_c_v),
    )
    for column, way in enumerate(WAYS):
        panels[0, column].set_title(f"{way} grows")
        for row, (name, cumulant) in enumerate(chosen):
            axes = panels[row, column]
            for place, density in enumerate(design.densities[way]):
                sizes = design.sizes
                for start in STARTED:
                    values = [
                        cumulant(measured.stationary[Growth(way, n), density, start]) for n in sizes
                    ]
                    label = str(density) if start == "rotating" else None
                    line = f"{_MARKS[place % len(_MARKS)]}{_LINES[start]}"
                    ends = np.array([interval(each) for each in values])
                    _draw_cumulant(axes, sizes, ends, line, place, label)
            axes.set_xscale("log")
            _name_ticks(axes, design.sizes)
            panels[row, 0].set_ylabel(f"Binder cumulant of {name}")
        panels[0, column].legend(title="density", ncols=3, title_fontsize=6.5, **_TIGHT)
        panels[1, column].set_xlabel("boats")
    # Heavy tails about 0 make cumulants as low as -10, which would hide all others.
    for axes, lowest in zip(panels[:, 0], (-1.0, -2.0), strict=True):
        axes.set_ylim(lowest, 0.8)
    handles = _starts()
    picture.legend(handles=handles, loc="outside upper center", ncols=2)
    return picture


def _draw_cumulant(
    axes: Axes,
    sizes: Sequence[int],
    ends: NDArray[np.float64],
    line: str,
    place: int,
    label: str | None,
) -> None:
    color = COLORS[place % len(COLORS)]
    bars = [ends[:, 0] - ends[:, 1], ends[:, 2] - ends[:, 0]]
    x = np.array(sizes) * 1.06 ** (place - 1)
    axes.errorbar(x, ends[:, 0], np.abs(bars), fmt=line, color=color, elinewidth=0.6, label=label)


def _histograms(measured: Measured, name: str) -> Figure:
    design = measured.design
    label, edges, unit = _QUANTITIES[name]
    picture = column_figure(3.2 * len(design.sizes) + 1.0)
    panels = picture.subplots(len(design.sizes), len(WAYS), sharex=True, squeeze=False)
    for column, way in enumerate(WAYS):
        for row, n in enumerate(design.sizes):
            axes = panels[row, column]
            for place, density in enumerate(design.densities[way]):
                for start in STARTED:
                    heights = getattr(
                        measured.stationary[Growth(way, n), density, start], f"{name}_density"
                    )
                    axes.stairs(
                        heights,
                        edges,
                        color=COLORS[place % len(COLORS)],
                        ls=_LINES[start],
                        lw=0.9,
                        label=str(density) if start == "rotating" else None,
                    )
            axes.set_yscale("log")
            head = f"{way} grows\n" if row == 0 else ""
            axes.set_title(f"{head}{n} boats")
        panels[-1, column].set_xlabel(label)
        # Room above the bars.
        panels[0, column].set_ylim(top=50 * panels[0, column].get_ylim()[1])
        panels[0, column].legend(title="density", ncols=3, title_fontsize=6.5, **_TIGHT)
    picture.supylabel(f"probability density{unit}", fontsize=7)
    handles = _starts()
    picture.legend(handles=handles, loc="outside upper center", ncols=2)
    return picture


def _name_ticks(axes: Axes, values: Sequence[int]) -> None:
    axes.set_xticks(values, [str(value) for value in values])
    axes.set_xticks([], minor=True)


def _sizes(design: TransitionDesign) -> list[Line2D]:
    return [
        Line2D([], [], color=COLORS[place % len(COLORS)], label=f"{n} boats")
        for place, n in enumerate(design.sizes)
    ]


def _starts() -> list[Line2D]:
    return _styles({words: _LINES[start] for start, words in STARTED.items()})


def _styles(lines: dict[str, str]) -> list[Line2D]:
    return [Line2D([], [], color="0.3", ls=line, label=label) for label, line in lines.items()]
