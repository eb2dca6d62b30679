"""Beyond the paper: whether the jamming–order transition is of first order.

Two numbers distinguish a jam from rotation. The rotation m = Ψ_o sin φ_o is 0 in a jam and ±1 in
rotation one way, but also 0 where streams in both directions share a long pool. Ψ_o cos φ_o, the
mean of cos φ over boats, is near 1 in a jam and near 0 in rotation in any direction. The second
number shows three signs of first order: both states persist at one density, each from its own
initial state; hysteresis loops in density stay open; and slower loops stay as open, which lag does
not. Binder's cumulant 1 - <m⁴>/(3<m²>²) and that of C_v are shown with these: they are negative
where few of the frames rotate, which means coexistence only where runs forget their initial state.
"""

import math
from collections.abc import Sequence
from itertools import product

import pandas as pd

from flockenv.reproduce.claim import DOES_NOT_HOLD, HOLDS, CheckedClaim, Claim, number
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings, designed
from flockenv.reproduce.transition.design import (
    FULL,
    LOOPS,
    SLOWER,
    WAYS,
    Growth,
    TransitionDesign,
    within,
)
from flockenv.reproduce.transition.measured import (
    C_V_EDGES,
    CENTERS,
    JAMMED_ABOVE,
    M_EDGES,
    ROTATING_BELOW,
    Loops,
    Measured,
    Stationary,
)
from flockenv.reproduce.transition.pictures import pictures
from flockenv.runs.protocols.hysteresis import DENSITY_RATIO
from flockenv.runs.protocols.initial_state import STARTS
from flockenv.statistics.intervals import interval, student_interval

__all__ = [
    "BISTABILITY",
    "HYSTERESIS",
    "LIFETIMES",
    "NO_LAG",
    "REPRODUCTIONS",
    "conclusion",
    "judge",
    "transition_order",
]

BISTABILITY = Claim(
    text="Jam and rotation both persist at one density, each from its own initial state",
    section="5.2, left open",
    quantity="mean Ψ_o cos φ_o of runs started jammed minus that of runs started rotating, "
    "second halves, at the density where this is largest",
    low=0.2,
)
HYSTERESIS = Claim(
    text="Loops in density stay open",
    section="5.2, left open",
    quantity="mean Ψ_o cos φ_o as density falls minus that as it rises, over a slow loop",
    low=0.1,
)
NO_LAG = Claim(
    text="Loops in density do not close when run more slowly",
    section="5.2, left open",
    quantity=f"opening of loops run {SLOWER:g} times as slowly minus 0.7 of the faster ones'",
    low=0.0,
)

LIFETIMES = Claim(
    text="Lifetimes at coexistence grow with the number of boats",
    section="5.2, left open",
    quantity="slope of the logarithm of the mean dwell time per doubling of the number of boats, "
    "at the densities where flocks leave jam and rotation most alike",
    low=0.0,
)

_SIGNS = {
    BISTABILITY: "both states persist",
    HYSTERESIS: "loops stay open",
    NO_LAG: "slower loops do not close",
}

_JAMMED = 0.3
"""Mean Ψ_o cos φ_o from which a loop has reached the jam at its highest density."""

_CAPTIONS = {
    "transition-order": "Jam (Ψ_o cos φ_o) of runs started rotating or jammed, against density; "
    "opening of loops, against the number of boats",
    "loops": "Loops in density, run slowly, and in noise; dashed: on the way back; shaded: "
    "lowest to highest of the runs",
    "cumulants": "Binder cumulants of m and C_v against the number of boats, cut off below -1 and "
    "-2; dashed: started jammed",
    "histograms_m": "Probability density of m; dashed: started jammed",
    "histograms_c_v": "Probability density of C_v; dashed: started jammed; rotation has two "
    "peaks, the boats' speeds at the end of fw and in nop",
}


def conclusion(claims: Sequence[CheckedClaim]) -> str:
    """Return what the claims for the larger sizes say, by a rule fixed before the runs.

    Parameters
    ----------
    claims
        `BISTABILITY`, `HYSTERESIS` and `NO_LAG` for the larger half of the sizes.
    """
    if all(claim.verdict == HOLDS for claim in claims):
        return "first order: both states persist and loops stay open at all of the larger sizes"
    states = [claim for claim in claims if claim.claim is not NO_LAG]
    if all(claim.verdict == DOES_NOT_HOLD for claim in states):
        return "not first order: one state outlasts the other and loops close at the larger sizes"
    verdicts = "; ".join(
        f"{scope}: "
        + ", ".join(
            f"{_SIGNS[claim.claim]} ({claim.verdict}: {_measured(claim)})"
            for claim in claims
            if claim.scope == scope
        )
        for scope in dict.fromkeys(claim.scope for claim in claims)
    )
    return (
        f"inconclusive. {verdicts}. A conclusion needs runs so long that flocks forget their "
        "initial state, loops so slow that slower ones open as far, and more seeds where an "
        "interval is too wide"
    )


def _measured(claim: CheckedClaim) -> str:
    return claim.note if claim.ends == "none" else f"{number(claim.measured)}, {claim.ends}"


def _analyze(design: TransitionDesign, settings: Settings, results: Results) -> Outcome:
    stationary = {}
    for growth in design.growths():
        for density, start in product(design.densities[growth.way], STARTS):
            specs = design.stationary(settings, growth, density, start)
            runs = results.derive(Stationary, specs, specs[0].draws_seed)
            stationary[growth, density, start] = runs
    loops = {
        (growth, kind): results.derive(Loops, design.loop(settings, growth, kind))
        for growth in design.growths()
        for kind in LOOPS
    }
    measured = Measured(design, stationary, loops)
    notes, claims = [], []
    for way in WAYS:
        judged = [judge(measured, Growth(way, n)) for n in design.sizes]
        larger = judged[len(judged) // 2 :]
        found = conclusion([claim for triple in larger for claim in triple])
        notes.append(f"The result where the {way} grows with the flock is {found}.")
        claims += [claim for triple in judged for claim in triple]
        claims.append(LIFETIMES.check(*interval(measured.lifetime_growth(way)), way))
    notes += [_cumulants_note(measured), *_method_notes(design, settings)]
    tables = {
        "transition": _points_table(measured),
        "loops": _loops_table(measured),
        "histograms": _histograms(measured),
        "lifetimes": _lifetimes_table(measured),
    }
    shown = ["lifetimes"]
    return Outcome(tables, pictures(measured), claims, notes, shown, _CAPTIONS)


def _cumulants_note(measured: Measured) -> str:
    lowest = []
    for way in WAYS:
        growth = Growth(way, measured.design.sizes[-1])
        for start in STARTS:
            ends = [
                (*interval(measured.stationary[growth, density, start].binder_m), density)
                for density in measured.design.densities[way]
            ]
            value, low, high, density = min(ends)
            lowest.append(
                f"{value:.2f} ({low:.2f} to {high:.2f}) at density {density} started {start}, {way}"
            )
    return (
        "The lowest Binder cumulants of the rotation m = Ψ_o sin φ_o with "
        f"{measured.design.sizes[-1]} boats are: {'; '.join(lowest)}. Where runs from the two "
        "initial states differ, the runs have not reached equilibrium: the cumulant describes the "
        "state that they have not left, and proves nothing about the transition."
    )


def _method_notes(design: TransitionDesign, settings: Settings) -> list[str]:
    stationary, loop = (
        settings.duration_s(m) / 60 for m in (design.stationary_minutes, design.loop_minutes)
    )
    return [
        "The density is the number of boats per area of water as large as that of the pool "
        "500-boats. Runs at one density never back up (bw = 0), so that the angular noise c4 is "
        "their only noise, and their second half counts. Loops in density go from the lowest "
        f"density to {DENSITY_RATIO:g} times that and back. Loops in noise go from bw = 0 "
        "to 0.6 s and back at the lowest density. All loops start from rotation. The preset is "
        "simulation with dt = 0.05 s. Intervals are Student's t intervals over seeds. Those of "
        "cumulants are a bootstrap over runs and blocks within them, and are too narrow with so "
        "few runs. Shorter runs of seeds 0 to 2 and 1000 fixed the densities and the criteria.",
        "A flock counts as jammed from where Ψ_o cos φ_o, averaged over 30 s, exceeds "
        f"{JAMMED_ABOVE:g} to where it falls below {ROTATING_BELOW:g}. The lifetime is the "
        "geometric mean of the mean dwell times in both states, at the density where flocks leave "
        "both most alike; half a change is added to each count. Its interval follows from "
        "Poisson's counts. Lifetimes that grow are expected at both kinds of transition: as a "
        "power of the size at a continuous one, and exponentially at one of first order.",
        f"The compute budget is {settings.budget_core_min:g} minutes of one core. The design has "
        f"{design.runs} seeds, {stationary:g} minutes per run, {loop:g} minutes per loop and "
        f"{SLOWER * loop:g} per slow loop, and {len(design.sizes)} sizes up to {max(design.sizes)} "
        f"boats. It is estimated to take {design.core_minutes(settings):.0f} minutes, and the full "
        f"design {FULL.core_minutes(settings):.0f} (`--budget`).",
    ]


def judge(measured: Measured, growth: Growth) -> tuple[CheckedClaim, ...]:
    """Judge all three claims for one size in one way of growing."""
    scope = f"{growth.n_boats} boats, {growth.way}"
    # The density is chosen once, by the data as measured.
    densities = measured.design.densities[growth.way]
    gap, density = max((measured.gap(growth, density), density) for density in densities)
    slow, fast = (measured.loops[growth, kind] for kind in ("slow density", "density"))
    nothing = (float("nan"),) * 3
    # A loop on which nothing jammed is closed whatever the transition, and one that never opened
    # cannot close.
    jammed = bool(slow.at_turn.mean() >= _JAMMED)
    opened = jammed and student_interval(fast.openings)[0] >= HYSTERESIS.low
    return (
        BISTABILITY.check(*gap, scope, f"at density {density}"),
        HYSTERESIS.check(
            *(student_interval(slow.openings) if jammed else nothing),
            scope,
            "" if jammed else "the loop never left rotation",
        ),
        NO_LAG.check(
            *(student_interval(slow.openings - 0.7 * fast.openings) if opened else nothing),
            scope,
            "" if opened else "the faster loop did not open",
        ),
    )


def _points_table(measured: Measured) -> pd.DataFrame:
    rows = []
    for (growth, density, start), stationary in measured.stationary.items():
        row: dict[str, object] = {"way": growth.way, "n_boats": growth.n_boats}
        row |= {"density": density, "start": start}
        for name, ends in (
            ("outward", student_interval(stationary.outward)),
            ("binder_m", interval(stationary.binder_m)),
            ("binder_c_v", interval(stationary.binder_c_v)),
        ):
            row |= dict(zip((name, f"{name}_low", f"{name}_high"), ends, strict=True))
        rows.append(row)
    return pd.DataFrame(rows)


def _loops_table(measured: Measured) -> pd.DataFrame:
    tables = []
    for (growth, kind), loop in measured.loops.items():
        keys = {"way": growth.way, "n_boats": growth.n_boats, "loop": kind}
        value, low, high = student_interval(loop.openings)
        columns = {"position": CENTERS, "there": loop.there, "back": loop.back}
        ends = {"opening": value, "opening_low": low, "opening_high": high}
        tables.append(pd.DataFrame({**keys, **columns, **ends}))
    return pd.concat(tables)


def _lifetimes_table(measured: Measured) -> pd.DataFrame:
    rows = []
    for growth in measured.design.growths():
        found = measured.lifetime(growth)
        value, low, high = (math.exp(end) / 60 for end in interval(found.log_s))
        row: dict[str, object] = {"way": growth.way, "boats": growth.n_boats}
        row |= {"density": found.density, "lifetime, min": number(value)}
        row["interval"] = f"{number(low)} to {number(high)}"
        for state, time_s, changes in zip(
            STARTS, found.dwell.time_s, found.dwell.changes.sum(axis=1), strict=True
        ):
            row |= {f"{state}, min": number(time_s / 60), f"changes from {state}": int(changes)}
        rows.append(row)
    return pd.DataFrame(rows)


def _histograms(measured: Measured) -> pd.DataFrame:
    tables = []
    for (growth, density, start), stationary in measured.stationary.items():
        keys = {"way": growth.way, "n_boats": growth.n_boats, "density": density, "start": start}
        for name, edges in (("m", M_EDGES), ("c_v", C_V_EDGES)):
            bins = {"bin_low": edges[:-1], "bin_high": edges[1:]}
            heights = {"probability_density": getattr(stationary, f"{name}_density")}
            tables.append(pd.DataFrame({**keys, "quantity": name, **bins, **heights}))
    return pd.concat(tables)


def transition_order(design: TransitionDesign | None = None) -> Reproduction:
    """Return the reproduction, by default in the largest design that the budget allows."""
    return designed(
        "transition-order",
        "Is the jamming–order transition of first order?",
        "5.2, left open",
        within if design is None else lambda settings: design,
        _analyze,
    )


REPRODUCTIONS = (transition_order(),)
