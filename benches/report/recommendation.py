"""Recommended settings, by rules that the page states."""

from __future__ import annotations

import pandas as pd
from formats import plain, times
from measurements import RAPIER, Measurements, pick

# Overlaps in cm that are too small to see, and too small for any published number.
VISIBLE_CM = 0.01
EXACT_CM = 1e-6
# Of half-widths of 95 % intervals: with so many settings one in twenty would fail by chance.
THREE_SIGMA = 1.5


def recommendation(m: Measurements) -> str:
    """Return two settings, each with its numbers."""
    settings = m.settings()
    exact = settings[(settings.engine == "flockenv") & (settings.solver == "block-pivoting")]
    leapfrog = exact[exact.scheme == "leapfrog"].copy()
    leapfrog["deepest"] = leapfrog[["jam_overlap_max_cm", "cycle_overlap_max_cm"]].max(axis=1)
    leapfrog["cost"] = leapfrog.cycle_us_per_step / leapfrog.dt_s
    unbiased = leapfrog[[_is_unbiased(m, row) for row in leapfrog.itertuples()]]
    training = _cheapest(unbiased[unbiased.deepest <= VISIBLE_CM])
    paper = _cheapest(leapfrog[(leapfrog.deepest <= EXACT_CM) & (leapfrog.dt_s <= 0.01)])
    return "\n".join(
        [
            f"- **Training:** {_named(training)} is the cheapest leapfrog setting that never "
            f"overlapped by more than {plain(VISIBLE_CM)} cm in either scene and whose Ψ_o and C_v "
            "lie within three standard errors of the reference's "
            f"(95 % interval of Ψ_o: ± {_resolution(m)}). {_numbers(m, training)}",
            f"- **Publications:** {_named(paper)} is the cheapest leapfrog setting at "
            f"dt ≤ 0.01 s that never overlapped by more than {plain(EXACT_CM)} cm. "
            f"{_numbers(m, paper)}",
            "- **Comparisons:** `moreau` is first order and otherwise like `leapfrog`. `paper` "
            "reproduces what the appendix prints and does not converge. The other solvers are "
            "slower and no more exact, and serve to check the exact one.",
        ]
    )


def _resolution(m: Measurements) -> str:
    rows = m.order[(m.order.engine == "flockenv") & (m.order.first_seed == 1)]
    return plain(rows.psi_o_half_width[rows.psi_o_half_width > 0].median(), 1)


def _is_unbiased(m: Measurements, row: tuple) -> bool:
    # A setting that was not measured does not count as unbiased.
    rows = m.order[(m.order.setting == row.setting) & (m.order.first_seed == 1)]
    rows = rows[rows.dt_s == row.dt_s]
    psi_o = rows.psi_o_error.abs() <= THREE_SIGMA * rows.psi_o_half_width
    c_v = rows.c_v_error_cm2_s2.abs() <= THREE_SIGMA * rows.c_v_half_width_cm2_s2
    return bool((psi_o & c_v).all()) and len(rows) == 1


def _cheapest(rows: pd.DataFrame) -> pd.Series | None:
    return None if rows.empty else rows.sort_values("cost").iloc[0]


def _named(row: pd.Series | None) -> str:
    if row is None:
        return "No setting"
    return f'`scheme="leapfrog"`, `dt_s={row.dt_s:g}`, `relinearizations={row.relinearizations:g}`'


def _numbers(m: Measurements, row: pd.Series | None) -> str:
    if row is None:
        return ""
    theirs = pick(m.settings(), RAPIER)
    cost = theirs.cycle_us_per_step / theirs.dt_s / row.cost
    return (
        f"With 27 boats it runs at {plain(row.cycle_times_real_time)} times real time in the cycle "
        f"({times(cost)} as fast as rapier2d-f64 at 0.01 s) and at "
        f"{plain(row.jam_times_real_time)} times in the jam. Its deepest overlap is "
        f"{plain(row.deepest)} cm, its error is {plain(row.slide_median_cm)} cm after sliding for "
        f"2 s, and {plain(row.cycle_half_second_cm)} cm over all poses after half a second of the "
        "cycle."
    )
