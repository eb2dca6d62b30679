"""Figures 14 to 17 of Section 5: presets side by side, 60 minutes a run."""

from collections.abc import Callable, Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flockenv.reproduce.order_statistics import OrderStatistics, block_length_s
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings
from flockenv.reproduce.series_panels import (
    density_map,
    density_rows,
    draw_curve,
    interval_ends,
    series_rows,
)
from flockenv.reproduce.simulation.claims import Evidence, check
from flockenv.reproduce.simulation.design import FIGURES, PRESETS
from flockenv.reproduce.style import COLORS, column_figure, paper_style
from flockenv.runs.spec import RunSpec
from flockenv.statistics.intervals import CONFIDENCE, RESAMPLES

__all__ = ["REPRODUCTIONS"]

_SIZES = (20, 50)
_BW = "backward time bw (s)"
_PHI_LABEL = r"$\varphi_o$ (rad)"


def interval_note(settings: Settings, runs: int) -> str:
    """Return how intervals were made, in a sentence."""
    length = block_length_s(settings.duration_s(60.0))
    return (
        f"Intervals ({CONFIDENCE:.0%}) are of a bootstrap in two stages, {runs} seeds at each "
        f"point and blocks of {length:g} s within each run, with {RESAMPLES} resamples. The frames "
        "are those at 10 Hz in the analysis window after the first tenth of a run. With so few "
        "seeds, intervals are rough where runs stay in one state throughout."
    )


def _noise_runs(settings: Settings) -> list[RunSpec]:
    series = (
        FIGURES.noise_series(settings, model, n, led)
        for model in PRESETS
        for n in _SIZES
        for led in (False, True)
    )
    return [spec for points in series for point in points for spec in point]


def _density_runs(settings: Settings) -> list[RunSpec]:
    points = (point for model in PRESETS for point in FIGURES.density_series(settings, model))
    return [spec for point in points for spec in point]


def _evidence(settings: Settings, results: Results) -> list[Evidence]:
    return [Evidence(settings, results, model, FIGURES) for model in PRESETS]


def _finish(
    name: str,
    settings: Settings,
    evidence: Sequence[Evidence],
    table: pd.DataFrame,
    picture: Figure,
) -> Outcome:
    claims = [claim for each in evidence for claim in check(each, [name])]
    notes = [interval_note(settings, FIGURES.runs)]
    return Outcome({name: table}, {name: picture}, claims, notes)


def _figure14(settings: Settings, results: Results) -> Outcome:
    evidence = _evidence(settings, results)
    cases = [(n, led) for n in _SIZES for led in (False, True)]
    tables = []
    with paper_style():
        picture = column_figure(15.0)
        panels = picture.subplots(len(cases), len(PRESETS), sharex=True, sharey=True)
        for row, (n, led) in enumerate(cases):
            leaders = round(0.2 * n) if led else 0
            for column, each in enumerate(evidence):
                series = each.noise(n, led)
                axes = panels[row, column]
                mesh = density_map(axes, series, "phi_o", 2.0)
                title = f"n = {n}, k = {leaders}"
                axes.set_title(f"{each.model.name}, {title}" if row == 0 else title)
                keys = {"preset": each.model.name, "n_boats": n, "n_leaders": leaders}
                tables.append(density_rows(series, "phi_o", keys, "bw_s"))
        for axes in panels[-1]:
            axes.set_xlabel(_BW)
        for axes in panels[:, 0]:
            axes.set_ylabel(_PHI_LABEL)
        bar = picture.colorbar(
            mesh, ax=panels, location="bottom", extend="max", fraction=0.03, aspect=40
        )
        bar.set_label("probability density (1/rad)")
    return _finish("fig14", settings, evidence, pd.concat(tables), picture)


def _curves(name: str, quantity: str, label: str, settings: Settings, results: Results) -> Outcome:
    evidence = _evidence(settings, results)
    tables = []
    with paper_style():
        picture = column_figure(9.0)
        panels = picture.subplots(len(_SIZES), len(PRESETS), sharex=True, sharey=True)
        for row, n in enumerate(_SIZES):
            for column, each in enumerate(evidence):
                axes = panels[row, column]
                for led in (False, True):
                    leaders = round(0.2 * n) if led else 0
                    series = each.noise(n, led)
                    draw_curve(axes, series, quantity, f"k = {leaders}", led)
                    keys = {"preset": each.model.name, "n_boats": n, "n_leaders": leaders}
                    tables.append(series_rows(series, [quantity], keys, "bw_s"))
                axes.set_title(f"{each.model.name}, n = {n}")
                axes.legend(loc="best", handlelength=1.5)
        for axes in panels[-1]:
            axes.set_xlabel(_BW)
        for axes in panels[:, 0]:
            axes.set_ylabel(label)
    outcome = _finish(name, settings, evidence, pd.concat(tables), picture)
    outcome.notes.append(
        f"Points and bars are means with their {CONFIDENCE:.0%} intervals. The shaded range is the "
        "mean plus and minus one standard deviation of the frames."
    )
    return outcome


def _figure15(settings: Settings, results: Results) -> Outcome:
    return _curves("fig15", "psi_o", r"$\Psi_o$", settings, results)


def _figure16(settings: Settings, results: Results) -> Outcome:
    return _curves("fig16", "c_v", r"$C_v$ (cm²/s²)", settings, results)


def _figure17(settings: Settings, results: Results) -> Outcome:
    evidence = _evidence(settings, results)
    tables, states = [], []
    with paper_style():
        picture = column_figure(12.0)
        panels = picture.subplots(3, len(PRESETS), sharex=True, sharey="row")
        for column, each in enumerate(evidence):
            series = each.density
            keys: dict[str, object] = {"preset": each.model.name}
            for row, (name, highest, gamma) in enumerate(
                (("psi_o", 20.0, 0.5), ("phi_o", 2.0, 1.0))
            ):
                axes = panels[row, column]
                mesh = density_map(axes, series, name, highest, gamma)
                tables.append(density_rows(series, name, keys, "n_boats"))
                if column == len(PRESETS) - 1:
                    label = "density" if name == "psi_o" else "density (1/rad)"
                    picture.colorbar(mesh, ax=axes, extend="max").set_label(label)
            panels[0, column].set_title(each.model.name)
            _draw_states(panels[2, column], series)
            states.append(series_rows(series, ["jammed", "rotating"], keys, "n_boats"))
        panels[0, 0].set_ylabel(r"$\Psi_o$")
        panels[1, 0].set_ylabel(_PHI_LABEL)
        panels[2, 0].set_ylabel("share of frames")
        panels[2, 0].legend(loc="best")
        for axes in panels[-1]:
            axes.set_xlabel("number of boats n")
            axes.set_xticks(range(20, 51, 10))
    outcome = _finish("fig17", settings, evidence, pd.concat(tables), picture)
    outcome.tables["fig17_states"] = pd.concat(states)
    return outcome


def _draw_states(axes: Axes, series: OrderStatistics) -> None:
    for name, color, mark in (("jammed", COLORS[1], "^--"), ("rotating", COLORS[0], "o-")):
        share = series.mean(name)
        axes.fill_between(series.x, *interval_ends(share), color=color, alpha=0.2, lw=0)
        axes.plot(series.x, share[:, 0], mark, color=color, label=name)


def _reproduction(
    name: str,
    title: str,
    runs: Callable[[Settings], list[RunSpec]],
    analyze: Callable[[Settings, Results], Outcome],
) -> Reproduction:
    return Reproduction(name=name, title=title, section="5.2", runs=runs, analyze=analyze)


REPRODUCTIONS = (
    _reproduction(
        "fig14", "Probability density of φ_o against backward motion time", _noise_runs, _figure14
    ),
    _reproduction("fig15", "Ψ_o against backward motion time", _noise_runs, _figure15),
    _reproduction("fig16", "C_v against backward motion time", _noise_runs, _figure16),
    _reproduction(
        "fig17", "Probability densities of Ψ_o and φ_o against n", _density_runs, _figure17
    ),
)
