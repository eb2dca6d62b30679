"""Which setting for what, by rules that are stated with it."""

from __future__ import annotations

import pandas as pd
from formats import plain, times
from measurements import RAPIER, Measurements, pick

# Overlaps in cm that nobody sees, and that no published number depends on.
VISIBLE_CM = 0.01
EXACT_CM = 1e-6
# Of half-widths of 95 % intervals: with so many settings one in twenty would fail by chance.
THREE_SIGMA = 1.5


def recommendation(m: Measurements) -> str:
    """Two settings, each with its numbers."""
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
            f"- **Training:** {_named(training)}. The cheapest leapfrog setting that never "
            f"overlapped by more than {plain(VISIBLE_CM)} cm in either scene and whose Ψ_o and C_v "
            "lie within three standard errors of the reference's "
            f"(95 % interval of Ψ_o: ± {_resolution(m)}): {_numbers(m, training)}",
            f"- **A paper:** {_named(paper)}. The cheapest leapfrog setting at dt ≤ 0.01 s that "
            f"never overlapped by more than {plain(EXACT_CM)} cm: {_numbers(m, paper)}",
            "- `moreau` is there to be compared with, first order and otherwise alike; `paper` "
            "reproduces what the appendix prints and does not converge. The other solvers are "
            "slower and no more exact: they are there to check the exact one.",
        ]
    )


def _resolution(m: Measurements) -> str:
    rows = m.order[(m.order.engine == "flockenv") & (m.order.first_seed == 1)]
    return plain(rows.psi_o_half_width[rows.psi_o_half_width > 0].median(), 1)


def _is_unbiased(m: Measurements, row: tuple) -> bool:
    # A setting that was not measured is not taken for right.
    rows = m.order[(m.order.setting == row.setting) & (m.order.first_seed == 1)]
    rows = rows[rows.dt_s == row.dt_s]
    psi_o = rows.psi_o_error.abs() <= THREE_SIGMA * rows.psi_o_half_width
    c_v = rows.c_v_error_cm2_s2.abs() <= THREE_SIGMA * rows.c_v_half_width_cm2_s2
    return bool((psi_o & c_v).all()) and len(rows) == 1


def _cheapest(rows: pd.DataFrame) -> pd.Series | None:
    return None if rows.empty else rows.sort_values("cost").iloc[0]


def _named(row: pd.Series | None) -> str:
    if row is None:
        return "no setting meets the rule"
    return f'`scheme="leapfrog"`, `dt_s={row.dt_s:g}`, `relinearizations={row.relinearizations:g}`'


def _numbers(m: Measurements, row: pd.Series | None) -> str:
    if row is None:
        return "none."
    theirs = pick(m.settings(), RAPIER)
    cost = theirs.cycle_us_per_step / theirs.dt_s / row.cost
    return (
        f"{plain(row.cycle_times_real_time)} times real time in the cycle and "
        f"{plain(row.jam_times_real_time)} in the jam with 27 boats, {times(cost)} as fast in the "
        f"cycle as rapier2d-f64 at 0.01 s; deepest overlap {plain(row.deepest)} cm, sliding "
        f"{plain(row.slide_median_cm)} cm off after 2 s, all poses "
        f"{plain(row.cycle_half_second_cm)} cm off after half a second of the cycle."
    )
