"""Beyond the paper: whether the jamming–order transition is of first order.

Two numbers tell a jam from rotation. The rotation m = Ψ_o sin φ_o is 0 in a jam and ±1 in rotation
one way, but also 0 where streams of both ways share a long pool. Ψ_o cos φ_o, the mean of cos φ
over boats, is near 1 in a jam and near 0 in rotation, whichever ways. Signs of first order are
looked for in the second: both states last at one density, each from its own start; loops in density
stay open; and they stay as open when run more slowly, which lag does not. Binder's cumulant
1 - <m⁴>/(3<m²>²) and that of C_v are shown with these: negative where few of the frames rotate,
which means coexistence only where runs forget their start.
"""

from collections.abc import Sequence

import pandas as pd

from flockenv.reproduce.claim import DOES_NOT_HOLD, HOLDS, CheckedClaim, Claim, number
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings
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
    M_EDGES,
    Loops,
    Measured,
    Still,
    student,
)
from flockenv.reproduce.transition.pictures import pictures
from flockenv.runs.protocols.hysteresis import DENSITY_RATIO
from flockenv.runs.protocols.initial_state import STARTS
from flockenv.statistics.block_bootstrap import interval

__all__ = [
    "BISTABILITY",
    "HYSTERESIS",
    "NO_LAG",
    "REPRODUCTIONS",
    "conclusion",
    "judge",
    "transition_order",
]

BISTABILITY = Claim(
    text="Jam and rotation both last at one density, each from its own start",
    section="5.2, left open",
    quantity="mean Ψ_o cos φ_o of runs begun jammed less that of runs begun rotating, second "
    "halves, at the density where this is largest",
    low=0.2,
)
HYSTERESIS = Claim(
    text="Loops in density stay open",
    section="5.2, left open",
    quantity="mean Ψ_o cos φ_o as density falls less that as it rises, over a slow loop",
    low=0.1,
)
NO_LAG = Claim(
    text="Loops in density do not close when run more slowly",
    section="5.2, left open",
    quantity=f"opening of loops run {SLOWER:g} times as slowly less 0.7 of the faster ones'",
    low=0.0,
)

_SIGNS = {
    BISTABILITY: "that both states last",
    HYSTERESIS: "that loops stay open",
    NO_LAG: "that slower loops do not close",
}

_JAMMED = 0.3
"""Mean Ψ_o cos φ_o from which a loop has reached the jam at its highest density."""

_CAPTIONS = {
    "transition-order": "Jam (Ψ_o cos φ_o) of runs begun rotating or jammed, against density; by "
    "how much loops stay open, against the number of boats",
    "loops": "Loops in density, run slowly, and in noise; dashed: on the way back; shaded: "
    "lowest to highest of the runs",
    "cumulants": "Binder cumulants of m and C_v against the number of boats, cut off below -1 and "
    "-2; dashed: begun jammed",
    "histograms_m": "Probability density of m; dashed: begun jammed",
    "histograms_c_v": "Probability density of C_v; dashed: begun jammed; rotation has two peaks, "
    "the boats' speeds at the end of fw and in nop",
}


def conclusion(claims: Sequence[CheckedClaim]) -> str:
    """Return what the claims for the larger sizes say: a rule settled before the runs.

    Parameters
    ----------
    claims
        `BISTABILITY`, `HYSTERESIS` and `NO_LAG` for the larger half of the sizes.
    """
    if all(claim.verdict == HOLDS for claim in claims):
        return "first order: both states last, and loops stay open, at all of the larger sizes"
    states = [claim for claim in claims if claim.claim is not NO_LAG]
    if all(claim.verdict == DOES_NOT_HOLD for claim in states):
        return "not first order: one state outlasts the other and loops close at the larger sizes"
    told = "; ".join(
        f"{scope}: "
        + ", ".join(
            f"{_SIGNS[claim.claim]}: {claim.verdict} ({_told(claim)})"
            for claim in claims
            if claim.scope == scope
        )
        for scope in dict.fromkeys(claim.scope for claim in claims)
    )
    return (
        f"inconclusive. {told}. It would take runs so long that flocks forget their start where "
        "they still differ by it, loops slow enough that being slower changes nothing, and more "
        "seeds where an interval is too wide"
    )


def _told(claim: CheckedClaim) -> str:
    return claim.note if claim.ends == "none" else f"{number(claim.measured)}, {claim.ends}"


def _analyse(design: TransitionDesign, settings: Settings, results: Results) -> Outcome:
    still = {
        (growth, density, start): results.derive(
            Still, design.still(settings, growth, density, start)
        )
        for growth in design.growths()
        for density in design.densities[growth.way]
        for start in STARTS
    }
    loops = {
        (growth, kind): results.derive(Loops, design.loop(settings, growth, kind))
        for growth in design.growths()
        for kind in LOOPS
    }
    measured = Measured(design, still, loops)
    notes, claims = [], []
    for way in WAYS:
        judged = [judge(measured, Growth(way, n)) for n in design.sizes]
        larger = judged[len(judged) // 2 :]
        told = conclusion([claim for triple in larger for claim in triple])
        notes.append(f"Growing the {way}: {told}.")
        claims += [claim for triple in judged for claim in triple]
    notes += [_cumulants_note(measured), *_method_notes(design, settings)]
    tables = {
        "transition": _points_table(measured),
        "loops": _loops_table(measured),
        "histograms": _histograms(measured),
    }
    return Outcome(tables, pictures(measured), claims, notes, captions=_CAPTIONS)


def _cumulants_note(measured: Measured) -> str:
    told = []
    for way in WAYS:
        growth = Growth(way, measured.design.sizes[-1])
        for start in STARTS:
            ends = [
                (*interval(measured.still[growth, density, start].binder_m), density)
                for density in measured.design.densities[way]
            ]
            value, low, high, density = min(ends)
            told.append(
                f"{value:.2f} ({low:.2f} to {high:.2f}) at density {density} begun {start}, {way}"
            )
    return (
        f"Lowest Binder cumulant of m with {measured.design.sizes[-1]} boats: {'; '.join(told)}. "
        "Where the two starts differ it belongs to a state that runs have not left, not to "
        "equilibrium, and proves nothing."
    )


def _method_notes(design: TransitionDesign, settings: Settings) -> list[str]:
    still, loop = (settings.duration_s(m) / 60 for m in (design.still_minutes, design.loop_minutes))
    return [
        "Density: boats for each free area of the pool 500-boats. Runs at one density have no "
        "noise but c4 and count in their second half; loops in density go from the lowest density "
        f"to {DENSITY_RATIO:g} times that and back, loops in noise from bw = 0 to 0.6 s and back "
        "at the lowest density, all from rotation. Preset simulation, dt = 0.05 s. Intervals are "
        "Student's over seeds; those of cumulants a bootstrap over runs and blocks within them, "
        "too narrow with so few runs. Densities and criteria were settled with shorter runs of "
        "seeds 0 to 2 and 1000.",
        f"Compute budget: {settings.budget_core_min:g} minutes of one core. This design: "
        f"{design.runs} seeds, {still:g} minutes a run, {loop:g} minutes a loop and "
        f"{SLOWER * loop:g} a slow one, {len(design.sizes)} sizes up to {max(design.sizes)} boats, "
        f"estimated to take {design.core_minutes(settings):.0f}; the full one takes "
        f"{FULL.core_minutes(settings):.0f} (`--budget`).",
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
    opened = jammed and student(fast.openings)[0] >= HYSTERESIS.low
    return (
        BISTABILITY.check(*gap, scope, f"at density {density}"),
        HYSTERESIS.check(
            *(student(slow.openings) if jammed else nothing),
            scope,
            "" if jammed else "the loop never left rotation",
        ),
        NO_LAG.check(
            *(student(slow.openings - 0.7 * fast.openings) if opened else nothing),
            scope,
            "" if opened else "the faster loop did not open",
        ),
    )


def _points_table(measured: Measured) -> pd.DataFrame:
    rows = []
    for (growth, density, start), still in measured.still.items():
        row: dict[str, object] = {"way": growth.way, "n_boats": growth.n_boats}
        row |= {"density": density, "start": start}
        for name, ends in (
            ("outward", student(still.outward)),
            ("binder_m", interval(still.binder_m)),
            ("binder_c_v", interval(still.binder_c_v)),
        ):
            row |= dict(zip((name, f"{name}_low", f"{name}_high"), ends, strict=True))
        rows.append(row)
    return pd.DataFrame(rows)


def _loops_table(measured: Measured) -> pd.DataFrame:
    tables = []
    for (growth, kind), loop in measured.loops.items():
        keys = {"way": growth.way, "n_boats": growth.n_boats, "loop": kind}
        value, low, high = student(loop.openings)
        columns = {"position": CENTERS, "there": loop.there, "back": loop.back}
        ends = {"opening": value, "opening_low": low, "opening_high": high}
        tables.append(pd.DataFrame({**keys, **columns, **ends}))
    return pd.concat(tables)


def _histograms(measured: Measured) -> pd.DataFrame:
    tables = []
    for (growth, density, start), still in measured.still.items():
        keys = {"way": growth.way, "n_boats": growth.n_boats, "density": density, "start": start}
        for name, edges in (("m", M_EDGES), ("c_v", C_V_EDGES)):
            bins = {"bin_low": edges[:-1], "bin_high": edges[1:]}
            heights = {"probability_density": getattr(still, f"{name}_density")}
            tables.append(pd.DataFrame({**keys, "quantity": name, **bins, **heights}))
    return pd.concat(tables)


def transition_order(design: TransitionDesign | None = None) -> Reproduction:
    """Return the reproduction, by default in the largest design that the budget allows."""

    def chosen(settings: Settings) -> TransitionDesign:
        return within(settings) if design is None else design

    return Reproduction(
        name="transition-order",
        title="Is the jamming–order transition of first order?",
        section="5.2, left open",
        runs=lambda settings: chosen(settings).all_runs(settings),
        analyze=lambda settings, results: _analyse(chosen(settings), settings, results),
    )


REPRODUCTIONS = (transition_order(),)
