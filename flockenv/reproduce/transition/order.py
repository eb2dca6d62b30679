"""Beyond the paper: whether the jamming–order transition is of first order.

Two numbers distinguish a jam from rotation. The rotation m = Ψ_o sin φ_o is 0 in a jam and ±1 in
rotation one way, but also 0 where streams in both directions share a long pool. Ψ_o cos φ_o, the
mean of cos φ over boats, is near 1 in a jam and near 0 in rotation in any direction.

The number of boats is fixed, so that a transition of first order is coexistence in space in a large
flock: one jam that holds a part of the boats, next to rotation, whose size grows in proportion to
the flock. Jams of a size of their own, however large the flock, are a gradual passage instead; what
looks like two states of a small flock is then a single jam that forms and dissolves. The size of
jams decides, from two starts that must come to the same. Persistence of both states, hysteresis
loops at three rates, lifetimes, and Binder's cumulants 1 - <m⁴>/(3<m²>²) stand beside it.
"""

import math
from collections.abc import Sequence
from itertools import product

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from flockenv.reproduce.claim import DOES_NOT_HOLD, HOLDS, CheckedClaim, Claim, number
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings, designed
from flockenv.reproduce.transition.design import (
    FINE_DT_S,
    FULL,
    LOOPS,
    SLOWER,
    STARTS,
    WAYS,
    Growth,
    TransitionDesign,
    within,
)
from flockenv.reproduce.transition.jam_map import JamMap, mapped
from flockenv.reproduce.transition.measured import (
    C_V_EDGES,
    CENTERS,
    FEWEST_CHANGES,
    JAMMED_ABOVE,
    M_EDGES,
    MANY_BOATS,
    NUCLEUS,
    ROTATING_BELOW,
    STATES,
    Jams,
    Loops,
    Measured,
    Stationary,
)
from flockenv.reproduce.transition.pictures import pictures
from flockenv.runs.protocols.hysteresis import DENSITY_RATIO
from flockenv.statistics.intervals import interval, student_interval

__all__ = [
    "BISTABILITY",
    "FORGOTTEN",
    "HYSTERESIS",
    "LIFETIMES",
    "NO_LAG",
    "ONE_PHASE",
    "OWN_SIZE",
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
    quantity="mean Ψ_o cos φ_o as density falls minus that as it rises, over the slowest loops",
    low=0.1,
)
NO_LAG = Claim(
    text="Loops in density do not close when run more slowly",
    section="5.2, left open",
    quantity=f"opening of the slowest loops minus 0.7 of that of {SLOWER:g} times as fast ones",
    low=0.0,
)

LIFETIMES = Claim(
    text="Lifetimes at coexistence grow with the number of boats",
    section="5.2, left open",
    quantity="slope of the logarithm of the mean dwell time per doubling of the number of boats, "
    "at the densities where flocks leave jam and rotation most alike",
    low=0.0,
)

_GROWTH = (
    f"exponent b of the mean size of jams, proportional to n^b, from {MANY_BOATS} boats on, both "
    "starts"
)
ONE_PHASE = Claim(
    text="Jams grow with the flock",
    section="5.2, left open",
    quantity=_GROWTH,
    low=0.75,
)
OWN_SIZE = Claim(
    text="Jams have a size of their own",
    section="5.2, left open",
    quantity=_GROWTH,
    high=0.25,
)
FORGOTTEN = Claim(
    text="Flocks forget whether they started in one jam",
    section="5.2, left open",
    quantity="mean size of jams of runs started in one jam, over that of runs started rotating",
    low=0.75,
    high=1.33,
)

_EARLY_MIN = 10.0
"""Until then a flock still forgets how its boats were placed."""

_JAMMED = 0.3
"""Mean Ψ_o cos φ_o from which a loop has reached the jam at its highest density."""

_CAPTIONS = {
    "jams": "Above: mean size of the jam that a boat in a jam is in, against the number of boats, "
    "by density; a jam that grows with the flock would follow the gray line. Below: part of the "
    "boats in jams; dashed: started in one jam",
    "jam-maps": "Where boats point outward, around the pool and in time, in one run each: jams "
    "form, grow, shrink and merge",
    "transition-order": "Jam (Ψ_o cos φ_o) of runs started rotating or in one jam, against "
    "density; opening of loops, against the number of boats",
    "loops": "Loops in density, run most slowly, and in noise; dashed: on the way back; shaded: "
    "lowest to highest of the runs",
    "cumulants": "Binder cumulants of m and C_v against the number of boats, cut off below -1 and "
    "-2; dashed: started in one jam",
    "histograms_m": "Probability density of m; dashed: started in one jam",
    "histograms_c_v": "Probability density of C_v; dashed: started in one jam; rotation has two "
    "peaks, the boats' speeds at the end of fw and in nop",
}


def conclusion(growth: Sequence[CheckedClaim], forgotten: Sequence[CheckedClaim]) -> str:
    """Return what the claims about jams say, by a rule fixed before the runs.

    Parameters
    ----------
    growth
        `ONE_PHASE` and `OWN_SIZE` at each density.
    forgotten
        `FORGOTTEN` at each density, in the largest flocks.
    """
    sizes = {
        claim: [each for each in growth if each.claim is claim] for claim in (ONE_PHASE, OWN_SIZE)
    }
    if any(each.verdict == HOLDS for each in sizes[ONE_PHASE]):
        return "of first order: jams grow in proportion to the flock"
    open_questions = [each for each in (*sizes[OWN_SIZE], *forgotten) if each.verdict != HOLDS]
    if not open_questions:
        return (
            "not of first order: jams have a size of their own in flocks of any size, whether they "
            "started rotating or in one jam"
        )
    listed = "; ".join(
        f"{each.claim.text.lower()} ({each.scope}): {each.verdict}, {_measured(each)}"
        for each in open_questions
    )
    slower = all(each.verdict == DOES_NOT_HOLD for each in sizes[ONE_PHASE])
    though = ", though jams grow more slowly than the flock at every density" if slower else ""
    return f"inconclusive{though}. Open: {listed}"


def _measured(claim: CheckedClaim) -> str:
    return f"{number(claim.measured)}, {claim.ends}"


def _analyze(design: TransitionDesign, settings: Settings, results: Results) -> Outcome:
    stationary = {}
    for point in design.points():
        specs = design.stationary(settings, *point)
        stationary[point] = results.derive(Stationary, specs, specs[0].draws_seed)
    fine = {}
    for way, density, start in design.fine_points():
        growth, specs = design.fine(settings, way, density, start)
        fine[growth, density, start] = results.derive(Jams, specs)
    loops = {
        (growth, kind): results.derive(Loops, design.loop(settings, growth, kind))
        for growth in design.looped()
        for kind in LOOPS
    }
    measured = Measured(design, stationary, loops, fine)
    notes, claims = [], []
    for way in WAYS:
        growth_claims, forgotten = judge_jams(measured, way)
        found = conclusion(growth_claims, forgotten)
        notes.append(f"Where the {way} grows with the flock, the transition is {found}.")
        claims += [*growth_claims, *forgotten]
        for growth in design.growths():
            if growth.way == way:
                claims += judge(measured, growth)
        slope, sizes = measured.lifetime_growth(way)
        note = f"of {', '.join(map(str, sizes)) or 'no'} boats"
        claims.append(LIFETIMES.check(*interval(slope), way, note))
    notes += [_cumulants_note(measured), *_method_notes(design, settings)]
    tables = {
        "jams": _jams_table(measured),
        "nucleation": _nucleation_table(measured),
        "substeps": _substeps_table(measured),
        "transition": _points_table(measured),
        "loops": _loops_table(measured),
        "histograms": _histograms(measured),
        "lifetimes": _lifetimes_table(measured),
    }
    shown = ["jams", "nucleation", "substeps", "lifetimes"]
    maps = {
        (way, start): results.derive(JamMap, design.stationary(settings, *point)[:1])
        for way, start in product(WAYS, STARTS)
        for point in [mapped(design, way, start)]
    }
    return Outcome(tables, pictures(measured, maps), claims, notes, shown, _CAPTIONS)


def _cumulants_note(measured: Measured) -> str:
    lowest = []
    for way in WAYS:
        growth = measured.design.largest(way)
        for start in STARTS:
            ends = [
                (*interval(measured.stationary[growth, density, start].binder_m), density)
                for density in measured.design.densities_of(growth)
            ]
            value, low, high, density = min(ends)
            lowest.append(
                f"{value:.2f} ({low:.2f} to {high:.2f}) with {growth.n_boats} boats at density "
                f"{density} started {start}, {way}"
            )
    return (
        "The lowest Binder cumulants of the rotation m = Ψ_o sin φ_o in the largest flocks are: "
        f"{'; '.join(lowest)}. Where runs from the two "
        "initial states differ, the runs have not reached equilibrium: the cumulant describes the "
        "state that they have not left, and proves nothing about the transition."
    )


def _method_notes(design: TransitionDesign, settings: Settings) -> list[str]:
    stationary, loop = (
        settings.duration_s(m) / 60 for m in (design.stationary_minutes, design.loop_minutes)
    )
    lengths = ", ".join(f"{loop * times:g}" for times in dict.fromkeys(LOOPS.values()))
    beyond = (
        f"Those above {design.largest_throughout} run at the highest density alone, and not where "
        "the circumference grows, because jams vanish in a long ring, whose wall is nearly "
        "straight. "
        if design.sizes[-1] > design.largest_throughout
        else ""
    )
    sizes = "; ".join(f"{design.largest(way).n_boats} where the {way} grows" for way in WAYS)
    return [
        "A jam is a cluster of at least three boats with gaps below 0.5 cm that point outward "
        "within 60°. Its mean size is that of the jam which a boat in a jam is in: the sum of "
        "squared sizes over the sum of sizes, over all frames of a run's second half. By the rule, "
        "which was fixed before the runs, the transition is of first order if the exponent is at "
        f"least {ONE_PHASE.low:g} at some density with its whole interval. It is not of first "
        f"order if the exponent is at most {OWN_SIZE.high:g} at every density with its whole "
        "interval, and the largest flocks have forgotten their start at every density. Anything "
        "else is inconclusive. Runs of up to 800 boats, of other seeds, suggested that the size of "
        f"jams decides. The first jam of a flock that started rotating is the first one of "
        f"{NUCLEUS} boats; the table has its median over the runs with one.",
        "The density is the number of boats per area of water as large as that of the pool "
        "500-boats. Runs at one density never back up (bw = 0), so that the angular noise c4 is "
        "their only noise. They start with all boats rotating, or standing side by side in one "
        "stretch of the outer wall. Loops in density go from the lowest "
        f"density to {DENSITY_RATIO:g} times that and back. Loops in noise go from bw = 0 "
        "to 0.6 s and back at the lowest density. All loops start from rotation. The preset is "
        "simulation with dt = 0.1 s; the table of substeps shows what a finer one changes. "
        "Intervals of loops and of persistence are Student's t intervals over seeds, those of jams "
        "a bootstrap over runs, and those of cumulants one over runs and blocks within them.",
        "A flock as a whole counts as jammed from where Ψ_o cos φ_o, averaged over 30 s, exceeds "
        f"{JAMMED_ABOVE:g} to where it falls below {ROTATING_BELOW:g}. The lifetime is the "
        "geometric mean of the mean dwell times in both states, at the density where flocks leave "
        "both most alike; half a change is added to each count. Its interval follows from "
        f"Poisson's counts. Sizes with fewer than {FEWEST_CHANGES} changes out of either state are "
        "left out of the claim.",
        f"The compute budget is {settings.budget_core_min:g} minutes of one core. The design has "
        f"{design.runs} seeds, {stationary:g} minutes per run, whose second half counts, and loops "
        f"of {lengths} minutes with up to {design.largest_loop} boats. The largest flocks are: "
        f"{sizes}. {beyond}The design is estimated to take "
        f"{design.core_minutes(settings):.0f} minutes, and the full design "
        f"{FULL.core_minutes(settings):.0f} (`--budget`).",
    ]


def judge_jams(measured: Measured, way: str) -> tuple[list[CheckedClaim], list[CheckedClaim]]:
    """Judge the size of jams at each density, and whether the largest flocks forget their start."""
    growth, forgotten = [], []
    for density in measured.design.densities[way]:
        largest = Growth(way, measured.design.sizes_at(way, density)[-1])
        scope = f"density {density}, {way}"
        ends = interval(measured.jam_growth(way, density))
        growth += [claim.check(*ends, scope) for claim in (ONE_PHASE, OWN_SIZE)]
        ratio = interval(measured.memory(largest, density))
        forgotten.append(FORGOTTEN.check(*ratio, f"{largest.n_boats} boats, {scope}"))
    return growth, forgotten


def judge(measured: Measured, growth: Growth) -> tuple[CheckedClaim, ...]:
    """Judge the states of whole flocks, and the loops that were run, for one size in one way."""
    scope = f"{growth.n_boats} boats, {growth.way}"
    # The density is chosen once, by the data as measured.
    densities = measured.design.densities_of(growth)
    gap, density = max((measured.gap(growth, density), density) for density in densities)
    states = BISTABILITY.check(*gap, scope, f"at density {density}")
    if growth not in measured.design.looped():
        return (states,)
    fast, slow = (measured.loops[growth, f"{how} density"] for how in ("slow", "slowest"))
    nothing = (float("nan"),) * 3
    # A loop on which nothing jammed is closed whatever the transition, and one that never opened
    # cannot close.
    jammed = bool(slow.at_turn.mean() >= _JAMMED)
    opened = jammed and student_interval(fast.openings)[0] >= HYSTERESIS.low
    return (
        states,
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


def _jams_table(measured: Measured) -> pd.DataFrame:
    rows: list[dict[str, object]] = []
    for (growth, density, start), stationary in measured.stationary.items():
        rows.append(
            {
                "way": growth.way,
                "density": density,
                "boats": growth.n_boats,
                "start": start,
                **_jam_columns(stationary.jams),
            }
        )
    return pd.DataFrame(rows).sort_values(
        ["way", "density"], kind="stable", ascending=[False, True]
    )


def _jam_columns(jams: Jams) -> dict[str, str]:
    named = {"in jams": jams.share, "mean size": jams.mean_size, "largest": jams.largest}
    return {name: _with_error(values) for name, values in named.items()}


def _with_error(values: NDArray[np.float64]) -> str:
    error = values.std(ddof=1) / len(values) ** 0.5
    return f"{number(values.mean())} ± {error:.2g}"


def _nucleation_table(measured: Measured) -> pd.DataFrame:
    """When flocks that started rotating have their first jam."""
    rows: list[dict[str, object]] = []
    for (growth, density, start), stationary in measured.stationary.items():
        if start != STARTS[0]:
            continue
        jams = stationary.jams
        first_min = np.sort(jams.first_s[jams.nucleated]) / 60.0
        early = int((first_min < _EARLY_MIN).sum())
        rows.append(
            {
                "way": growth.way,
                "density": density,
                "boats": growth.n_boats,
                "runs": len(jams.nucleated),
                f"with a jam before {_EARLY_MIN:g} min": early,
                "with one later": len(first_min) - early,
                "first jam, min": number(
                    float(np.median(first_min)) if len(first_min) else math.nan
                ),
            }
        )
    return _by_density(rows)


def _by_density(rows: list[dict[str, object]]) -> pd.DataFrame:
    return pd.DataFrame(rows).sort_values(
        ["way", "density"], kind="stable", ascending=[False, True]
    )


def _substeps_table(measured: Measured) -> pd.DataFrame:
    rows = []
    for (growth, density, start), fine in measured.fine.items():
        point = {"way": growth.way, "density": density, "boats": growth.n_boats, "start": start}
        usual = measured.stationary[growth, density, start].jams
        dt_s = growth.parameters(density).dt_s
        for step_s, jams in ((FINE_DT_S, fine), (dt_s, usual)):
            rows.append(point | {"substep, s": f"{step_s:g}"} | _jam_columns(jams))
    return pd.DataFrame(rows)


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
            STATES, found.dwell.time_s, found.dwell.changes.sum(axis=1), strict=True
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
