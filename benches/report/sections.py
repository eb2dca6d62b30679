"""The tables of the report."""

from __future__ import annotations

import numpy as np
import pandas as pd
from formats import plain, table, times
from measurements import OURS, RAPIER, STEP_S, Measurements, ours


def _at_step(m: Measurements) -> list[tuple]:
    """Return every engine and solver at the reference step, flockenv first."""
    rows = m.settings()
    rows = rows[rows.dt_s == STEP_S].copy()
    rows["place"] = rows.engine.ne("flockenv")
    return list(rows.sort_values(["place", "engine"], kind="stable").itertuples())


def _name(row: tuple) -> str:
    name = f"{row.engine}: {row.setting}".replace("flockenv: ", "")
    return name.replace("block-pivoting", "exact")


def speeds(m: Measurements) -> str:
    """Return the speed of every engine at the reference step."""

    def with_spread(middle: float, low: float, high: float) -> str:
        return f"{plain(middle)} ({plain(low)} – {plain(high)})"

    rows = [
        [
            _name(row),
            with_spread(row.jam_us_per_step, row.jam_us_q1, row.jam_us_q3),
            times(row.jam_faster),
            plain(row.jam_times_real_time),
            with_spread(row.cycle_us_per_step, row.cycle_us_q1, row.cycle_us_q3),
            times(row.cycle_faster),
            plain(row.cycle_times_real_time),
        ]
        for row in _at_step(m)
    ]
    half = ["µs per step (middle half)", "speed", "× real time"]
    header = ["engine, setting", *(f"jam: {name}" for name in half)]
    return table([*header, *(f"cycle: {name}" for name in half)], rows)


ERRORS = [
    "overlap mean cm", "overlap max cm", "residual cm/s", "force error", "momentum drift",
    "angular drift", "slide cm", "jam 0.5 s cm", "cycle 0.5 s cm",
]  # fmt: skip


def errors(m: Measurements) -> str:
    """Return the errors of every engine at the reference step."""
    rows = ([_name(row), *_errors_of(row)] for row in _at_step(m))
    return table(["engine, setting", *ERRORS], rows)


def _errors_of(row: tuple) -> list[str]:
    found = [
        row.jam_overlap_mean_cm,
        row.jam_overlap_max_cm,
        np.fmax(row.jam_residual_cm_s, row.cycle_residual_cm_s),
        row.force_error,
        row.momentum_drift,
        row.angular_momentum_drift,
        row.slide_median_cm,
        row.jam_half_second_cm,
        row.cycle_half_second_cm,
    ]
    return [plain(value) for value in found]


def every_setting(m: Measurements) -> str:
    """Return every setting at every step."""
    header = ["engine, setting", "dt s", "jam µs", "cycle µs", "jam speed", "cycle speed"]
    rows = [
        [
            _name(row),
            f"{row.dt_s:g}",
            plain(row.jam_us_per_step),
            plain(row.cycle_us_per_step),
            times(row.jam_faster),
            times(row.cycle_faster),
            *_errors_of(row),
        ]
        for row in m.settings().itertuples()
    ]
    return table([*header, *ERRORS], rows)


def larger_flocks(m: Measurements) -> str:
    """Return jams of up to 1000 boats at the reference step."""
    jam = m.speed[(m.speed.scene == "jam") & (m.speed.dt_s == STEP_S)]
    deep = m.overlap[(m.overlap.scene == "jam") & (m.overlap.dt_s == STEP_S)]
    sizes = sorted(jam.n.unique())
    present = jam[jam.n == max(sizes)][["engine", "setting"]].itertuples(index=False)
    rows = []
    for who in present:
        cells = [f"{who.engine}: {who.setting}"]
        for boats in sizes:
            row = _only(jam, who, boats)
            cells.append(f"{plain(row.us_per_step)} ({times(row.faster)})")
        cells.append(plain(_only(deep, who, max(sizes)).overlap_mean_cm))
        rows.append(cells)
    header = ["µs per step (speed against rapier2d-f64)", *(f"n = {n}" for n in sizes)]
    return table([*header, f"overlap at n = {max(sizes)}, cm"], rows)


def _only(rows: pd.DataFrame, who: tuple, boats: int) -> pd.Series:
    chosen = (rows.engine == who.engine) & (rows.setting == who.setting) & (rows.n == boats)
    return rows[chosen].iloc[0]


def solvers(m: Measurements) -> str:
    """Return the times and residuals of the contact problem alone."""
    rows = []
    for solver in m.solvers.solver.unique():
        own = m.solvers[m.solvers.solver == solver]
        rows.append([solver, *(plain(value) for value in own.us_per_solve)])
        worst = (f"{plain(row.residual_worst)}" for row in own.itertuples())
        rows.append([f"{solver}: worst residual, cm/s", *worst])
    exact = m.solvers[m.solvers.solver == "block-pivoting"]
    rows.append(["contacts and near-contacts", *(plain(value, 3) for value in exact.contacts)])
    return table(["µs per solve", *(f"n = {n}" for n in exact.n)], rows)


def profile(m: Measurements) -> str:
    """Return the parts of a step's time, and a lower bound for this algorithm."""
    rows = []
    for row in m.profile.itertuples():
        parts = [row.noise_us, row.free_us, row.find_us, row.solve_us]
        rest = row.whole_us - sum(parts)
        least = row.whole_us - row.solve_us + row.solve_known_us
        rows.append([str(row.n), *(plain(value) for value in [row.whole_us, *parts, rest, least])])
    header = ["boats", "whole step", "noise", "free motion", "finding contacts", "contact problem"]
    return table([*header, "rest", "with known contacts"], rows)


def parts(m: Measurements) -> str:
    """Return the cost of each part of a scene."""
    whole = m.parts.set_index("scene").us_per_step["both walls"]
    rows = [
        [
            row.scene,
            plain(row.us_per_step),
            f"{plain(row.us_q1)} – {plain(row.us_q3)}",
            times(row.us_per_step / whole),
            plain(row.contacts_per_step),
        ]
        for row in m.parts.itertuples()
    ]
    header = ["scene", "µs per step", "middle half", "of the whole scene", "contacts per step"]
    return table(header, rows)


def growth(m: Measurements) -> str:
    """Return time and memory against the number of boats."""
    columns = {
        "boats": m.growth.n.map(str),
        "µs per step": m.growth.us_per_step.map(plain),
        "× real time": m.growth.times_real_time.map(plain),
        "contacts per step": m.growth.contacts_per_step.map(lambda value: plain(value, 3)),
        "bytes per boat in use, without factor": (
            m.growth.bytes_in_use_per_boat - 8 * m.growth.factor_entries_per_boat
        ).map(lambda value: plain(value, 3)),
        "bytes per boat held": m.growth.bytes_per_boat.map(lambda value: plain(value, 3)),
        "factor entries": m.growth.factor_entries.map(plain),
        "factor bytes per boat": (8 * m.growth.factor_entries_per_boat).map(plain),
    }
    if "two_threads_faster" not in m.growth:
        return table(columns, zip(*columns.values(), strict=True))
    columns["speed on two threads"] = m.growth.two_threads_faster.map(times)
    return table(columns, zip(*columns.values(), strict=True)) + (
        "\n\nTimes are those of one thread. The speed on two threads (`Flock.threads`) compares "
        "the same motion, turn by turn; flocks of fewer than 200 boats keep to one."
    )


def order_parameters(m: Measurements) -> str:
    """Return means of Ψ_o and C_v, and their errors."""

    def interval(value: float, width: float) -> str:
        if width == 0:
            return "reference"
        mark = "" if abs(value) <= width else " *"
        return f"{value:+.3g} ± {width:.2g}{mark}"

    rows = []
    for row in m.order.itertuples():
        name = f"{row.engine}: {row.setting}".replace("flockenv: ", "")
        runs = f"{row.seeds} × {plain(row.run_s / 60)} min"
        if row.first_seed != 1:
            name += " (other seeds)"
        if row.psi_o_half_width == 0:
            runs = f"4 × {runs}"
        rows.append(
            [
                name,
                f"{row.dt_s:g}",
                runs,
                f"{row.psi_o:.3f}",
                interval(row.psi_o_error, row.psi_o_half_width),
                f"{row.c_v_cm2_s2:.2f}",
                interval(row.c_v_error_cm2_s2, row.c_v_half_width_cm2_s2),
            ]
        )
    header = ["engine, setting", "dt s", "runs", "Ψ_o", "error", "C_v cm²/s²", "error"]
    return table(header, rows)


def order_of_schemes(m: Measurements) -> str:
    """Return the exponents of errors in the step, over the smallest steps."""
    settings = m.settings()
    found = []
    for scheme in ("leapfrog", "moreau", "paper"):
        who = ours(scheme, 2)
        slide = _steps_of(m.slide, who).head(4)
        whole = _steps_of(settings, who).head(3)
        found.append(
            [
                scheme,
                _exponent(slide, "slide_median_cm"),
                _exponent(whole, "jam_half_second_cm"),
                _exponent(whole, "cycle_half_second_cm"),
            ]
        )
    return table(["scheme", "sliding", "0.5 s of the jam", "0.5 s of the cycle"], found)


def _steps_of(rows: pd.DataFrame, who: tuple[str, str]) -> pd.DataFrame:
    return rows[(rows.engine == who[0]) & (rows.setting == who[1])].sort_values("dt_s")


def _exponent(rows: pd.DataFrame, column: str) -> str:
    return f"{np.polyfit(np.log(rows.dt_s), np.log(rows[column]), 1)[0]:+.2f}"


def lost(m: Measurements) -> str:
    """Return the settings whose motion diverged."""
    rows = m.speed[m.speed.lost > 0]
    if rows.empty:
        return "No run diverged."
    names = [f"{row.setting} at {row.dt_s:g} s ({row.scene})" for row in rows.itertuples()]
    return (
        "A dash among the times marks a setting whose motion diverged on at least one seed, which "
        f"raises an error that names the step: {', '.join(names)}."
    )


def spread(m: Measurements) -> str:
    """Return the spread of the turns of the reference."""
    rows = m.speed[(m.speed.engine == RAPIER[0]) & (m.speed.setting == RAPIER[1])]
    row = rows[(rows.dt_s == STEP_S) & (rows.scene == "jam") & (rows.n == 27)].iloc[0]
    share = 100 * (row.us_q3 - row.us_q1) / row.us_per_step
    return f"{share:.0f} %"


def call_only(m: Measurements) -> str:
    """Return the ratios against rapier's step call alone."""
    cells = []
    for scene, boats in [("jam", 27), ("cycle", 27), ("jam", 1000)]:
        rows = m.speed[(m.speed.engine == OURS[0]) & (m.speed.setting == OURS[1])]
        row = rows[(rows.scene == scene) & (rows.n == boats) & (rows.dt_s == STEP_S)].iloc[0]
        cells.append(f"{times(row.call_faster)} ({scene}, {boats} boats)")
    return ", ".join(cells)
