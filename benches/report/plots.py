"""The figures: colors and shapes tell the series apart."""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.ticker import NullLocator
from measurements import BOX2D, RAPIER, Measurements, in_words, ours

from docs.scripts.plots import page_style, write_png
from flockenv.rendering.palette import OKABE_ITO

# Name: engine and setting, color, marker, whether filled.
SERIES = {
    "leapfrog, gaps solved once": (ours("leapfrog", "linear"), OKABE_ITO["blue"], "o", True),
    "leapfrog, gaps to 1e-4 cm": (ours("leapfrog", "1e-4 cm"), "#7B5FB8", "o", False),
    "leapfrog, gaps to 1e-6 cm": (ours("leapfrog", "1e-6 cm"), OKABE_ITO["sky blue"], "o", False),
    "leapfrog, gaps to 1e-9 cm": (ours("leapfrog", "1e-9 cm"), OKABE_ITO["green"], "o", False),
    "moreau, gaps solved once": (ours("moreau", "linear"), OKABE_ITO["orange"], "s", True),
    "paper's scheme, gaps solved once": (ours("paper", "linear"), OKABE_ITO["purple"], "^", True),
    "rapier2d-f64": (RAPIER, OKABE_ITO["vermilion"], "D", True),
    "Box2D": (BOX2D, OKABE_ITO["black"], "v", True),
    "pymunk (Chipmunk)": (("pymunk", "10 iterations"), "#999999", "P", True),
    "MuJoCo": (("MuJoCo", "Newton"), "#B8A400", "X", True),
    "Drake": (("Drake", "SAP"), "#7A4B2A", "p", True),
}


def draw_all(m: Measurements, folder: Path) -> None:
    """Write every figure into a folder."""
    with mpl.rc_context(page_style()):
        for name, draw in [
            ("pareto", _pareto),
            ("tolerance", _tolerance),
            ("order_of_schemes", _order_of_schemes),
            ("order_parameters", _order_parameters),
            ("growth", _growth),
            ("parts", _parts),
        ]:
            figure = draw(m)
            write_png(figure, folder / f"{name}.png", 150)
            plt.close(figure)


def _rows(table: pd.DataFrame, who: tuple[str, str]) -> pd.DataFrame:
    chosen = table[(table.engine == who[0]) & (table.setting == who[1])]
    return chosen.sort_values("dt_s")


def _line(color: str, marker: str, filled: bool) -> dict:
    face = color if filled else "white"
    line = {"color": color, "linewidth": 1}
    return {**line, "marker": marker, "markerfacecolor": face, "markersize": 7}


def _pareto(m: Measurements) -> plt.Figure:
    settings = m.settings()
    figure, axes = plt.subplots(2, 2, figsize=(8.6, 8.8), layout="constrained")
    panels = [
        ("jam", "jam_overlap_mean_cm", "mean overlap in the jam [cm]"),
        ("jam", "slide_median_cm", "error after sliding for 2 s [cm]"),
        ("jam", "jam_half_second_cm", "error after 0.5 s of the jam [cm]"),
        ("cycle", "cycle_half_second_cm", "error after 0.5 s of the cycle [cm]"),
    ]
    for axis, (scene, column, label) in zip(axes.flat, panels, strict=True):
        for name, (who, *style) in SERIES.items():
            rows = _rows(settings, who)
            cost = rows[f"{scene}_us_per_step"] / rows.dt_s / 1000
            if len(rows):
                axis.plot(cost, rows[column], label=name, **_line(*style))
        axis.set(xscale="log", yscale="log", ylabel=label)
        axis.set_xlabel(f"computing [ms] for 1 s of the {scene}")
    handles, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    figure.suptitle(
        "Lower left is better. From right to left each line goes through\n"
        "dt = 0.005, 0.01, 0.02 s and, for flockenv, 0.05 and 0.1 s"
    )
    return figure


def _tolerance(m: Measurements) -> plt.Figure:
    """Draw time and errors of the default scheme against the tolerance, a line for each step."""
    settings = m.settings()
    ours = settings[(settings.scheme == "leapfrog") & (settings.solver == "block-pivoting")]
    # In the table the cell of an infinite tolerance is empty.
    ours = ours.assign(tolerance_cm=ours.tolerance_cm.fillna(math.inf))
    finite = sorted(cm for cm in ours.tolerance_cm.unique() if math.isfinite(cm))
    # Gaps that are linearized once have an infinite tolerance, drawn right of the largest one.
    once_cm = 100 * finite[-1]
    figure, axes = plt.subplots(1, 3, figsize=(8.6, 4.2), layout="constrained")
    panels = [
        ("jam_us_per_step", "µs per step of the jam"),
        ("jam_overlap_max_cm", "deepest overlap in the jam [cm]"),
        ("jam_half_second_cm", "error after 0.5 s of the jam [cm]"),
    ]
    colors = ("blue", "sky blue", "green", "orange", "vermilion")
    for axis, (column, label) in zip(axes, panels, strict=True):
        for color, (dt_s, rows) in zip(colors, ours.groupby("dt_s"), strict=True):
            rows = rows.sort_values("tolerance_cm")
            tolerances = rows.tolerance_cm.replace(math.inf, once_cm)
            axis.plot(
                tolerances, rows[column], label=f"{dt_s:g} s", **_line(OKABE_ITO[color], "o", True)
            )
        axis.set(xscale="log", yscale="log", ylabel=label, xlabel="tolerance_cm")
        names = [f"{cm:.0e}".replace("e-0", "e-") for cm in finite]
        axis.set_xticks([*finite, once_cm], [*names, "once"])
        axis.xaxis.set_minor_locator(NullLocator())
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, title="dt", loc="outside lower center", ncols=len(colors))
    return figure


def _order_of_schemes(m: Measurements) -> plt.Figure:
    figure, axis = plt.subplots(figsize=(7, 5), layout="constrained")
    names = {
        "leapfrog": (OKABE_ITO["blue"], "o"),
        "moreau": (OKABE_ITO["orange"], "s"),
        "paper": (OKABE_ITO["purple"], "^"),
    }
    for scheme, style in names.items():
        rows = _rows(m.slide, ours(scheme, "1e-9 cm"))
        axis.plot(
            rows.dt_s,
            rows.slide_median_cm,
            label={"paper": "paper's scheme"}.get(scheme, scheme),
            **_line(*style, True),
        )
    for name in ("rapier2d-f64", "Box2D", "pymunk (Chipmunk)", "MuJoCo", "Drake"):
        who, *style = SERIES[name]
        rows = _rows(m.slide, who)
        axis.plot(rows.dt_s, rows.slide_median_cm, label=name, **_line(*style))
    axis.set(xscale="log", yscale="log", xlabel="dt in s")
    axis.set_ylabel("error of one boat after sliding for 2 s, in cm")
    axis.legend()
    return figure


def _order_parameters(m: Measurements) -> plt.Figure:
    rows = m.order[(m.order.first_seed == 1)].iloc[1:].iloc[::-1]
    names = [f"{in_words(r.engine, r.setting)}, dt {r.dt_s:g} s" for r in rows.itertuples()]
    figure, axes = plt.subplots(1, 2, figsize=(8.6, 5.2), layout="constrained", sharey=True)
    for axis, value, width, label in [
        (axes[0], "psi_o_error", "psi_o_half_width", "error of Ψ_o"),
        (axes[1], "c_v_error_cm2_s2", "c_v_half_width_cm2_s2", "error of C_v [cm²/s²]"),
    ]:
        axis.axvline(0, color="black", linewidth=1)
        axis.errorbar(
            rows[value], names, xerr=rows[width], fmt="o", color=OKABE_ITO["blue"], capsize=3
        )
        axis.set_xlabel(label)
    return figure


def _growth(m: Measurements) -> plt.Figure:
    figure, axes = plt.subplots(1, 2, figsize=(8.6, 5.2), layout="constrained")
    jam = m.speed[(m.speed.scene == "jam") & (m.speed.dt_s == 0.01)]
    for name, (who, *style) in SERIES.items():
        rows = jam[(jam.engine == who[0]) & (jam.setting == who[1])].sort_values("n")
        if len(rows) > 1:
            axes[0].plot(rows.n, rows.us_per_step, label=name, **_line(*style))
    axes[0].set(ylabel="µs per step, jam, dt = 0.01 s")
    axes[0].legend(loc="upper center", bbox_to_anchor=(0.45, -0.16))
    factor_bytes = 8 * m.growth.factor_entries_per_boat
    for values, label, color, marker in [
        (m.growth.bytes_per_boat, "held, with room to grow", OKABE_ITO["black"], "s"),
        (
            m.growth.bytes_in_use_per_boat - factor_bytes,
            "in use, besides the factor",
            OKABE_ITO["blue"],
            "o",
        ),
        (factor_bytes, "in use, of the factor", OKABE_ITO["vermilion"], "D"),
    ]:
        axes[1].plot(m.growth.n, values, label=label, **_line(color, marker, True))
    axes[1].set(ylabel="bytes per boat, jam, dt = 0.02 s")
    axes[1].legend(loc="upper center", bbox_to_anchor=(0.45, -0.16))
    for axis in axes:
        axis.set(xscale="log", yscale="log", xlabel="boats")
    return figure


def _parts(m: Measurements) -> plt.Figure:
    rows = m.parts.iloc[::-1]
    figure, axis = plt.subplots(figsize=(7.6, 4.2), layout="constrained")
    spread = [rows.us_per_step - rows.us_q1, rows.us_q3 - rows.us_per_step]
    axis.barh(rows.scene, rows.us_per_step, xerr=spread, color=OKABE_ITO["sky blue"], capsize=3)
    axis.set_xlabel("µs per step of 0.01 s: 27 boats, leapfrog, phases of 2, 1, 2, 1 s")
    return figure
