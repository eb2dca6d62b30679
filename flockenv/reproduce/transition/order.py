"""Beyond the paper: whether the jamming–order transition is of first order.

Two numbers distinguish a jam from rotation. The rotation m = Ψ_o sin φ_o is 0 in a jam and ±1 in
rotation one way, but also 0 where streams in both directions share a long pool. Ψ_o cos φ_o, the
mean of cos φ over boats, is near 1 in a jam and near 0 in rotation in any direction.

The number of boats is fixed, so that a transition of first order is coexistence in space in a large
flock: one jam that holds a part of the boats, next to rotation, whose size grows in proportion to
the flock. Jams whose size the channel sets, however many boats there are, are a gradual passage
instead; what looks like two states of a small flock is then a single jam that forms and dissolves.
The size of jams decides, from two starts that must come to the same. Persistence of both states,
hysteresis loops at three rates, lifetimes, and Binder's cumulants 1 - <m⁴>/(3<m²>²) stand beside
it.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from flockenv.reproduce.claim import (
    DOES_NOT_HOLD,
    HOLDS,
    INCONCLUSIVE,
    CheckedClaim,
    Claim,
    number,
)
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings, designed
from flockenv.reproduce.transition.design import (
    FINE_DT_S,
    FULL,
    LONGER_ABOVE,
    LOOPS,
    SLOWER,
    STARTED,
    WAYS,
    WIDTH_EXPONENTS,
    Growth,
    TransitionDesign,
    within,
)
from flockenv.reproduce.transition.jam_map import JamMap, mapped
from flockenv.reproduce.transition.measured import (
    FEWEST_CHANGES,
    JAMMED_ABOVE,
    MANY_BOATS,
    NUCLEUS,
    ROTATING_BELOW,
    Jams,
    Loops,
    Measured,
    Stationary,
)
from flockenv.reproduce.transition.pictures import pictures
from flockenv.reproduce.transition.tables import tables
from flockenv.runs.protocols.hysteresis import DENSITY_RATIO
from flockenv.statistics.intervals import interval, student_interval

__all__ = [
    "BISTABILITY",
    "CHANNEL_SIZE",
    "FORGOTTEN",
    "HYSTERESIS",
    "LIFETIMES",
    "NO_LAG",
    "ONE_PHASE",
    "REPRODUCTIONS",
    "conclusion",
    "judge",
    "transition_order",
]

BISTABILITY = Claim(
    text="Jam and rotation both persist at one density, each from its own initial state",
    section="5.2, left open",
    quantity="mean Ψ_o cos φ_o of runs started in one jam minus that of runs started rotating, "
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

_GROWTH = f"exponent b of the mean size of jams, proportional to n^b, from {MANY_BOATS} boats on"
ONE_PHASE = Claim(
    text="Jams grow with the flock",
    section="5.2, left open",
    quantity=_GROWTH,
    low=0.75,
)
CHANNEL_SIZE = Claim(
    text="Jams grow with the width of the channel alone",
    section="5.2, left open",
    quantity=f"{_GROWTH}, less the exponent of the width",
    low=-0.25,
    high=0.25,
)
FORGOTTEN = Claim(
    text="Flocks forget whether they started in one jam",
    section="5.2, left open",
    quantity="mean size of jams of runs started rotating, over that of runs started in one jam",
    low=0.75,
    high=1.33,
)

_JAMMED = 0.3
"""Mean Ψ_o cos φ_o from which a loop has reached the jam at its highest density."""

_CAPTIONS = {
    "jams": "Above: mean size of the jam that a boat in a jam is in, against the number of boats, "
    "by density; gray: in proportion to the flock, and to the width of the channel. Below: part of "
    "the boats in jams; dashed: started in one jam",
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
        `ONE_PHASE` and `CHANNEL_SIZE` at each density.
    forgotten
        `FORGOTTEN` at each density, in the largest flocks.
    """
    sizes = {
        claim: [each for each in growth if each.claim is claim]
        for claim in (ONE_PHASE, CHANNEL_SIZE)
    }
    if any(each.verdict == HOLDS for each in sizes[ONE_PHASE]):
        return "of first order: jams grow in proportion to the flock"
    open_questions = [each for each in (*sizes[CHANNEL_SIZE], *forgotten) if each.verdict != HOLDS]
    if not open_questions:
        return (
            "not of first order: the channel sets the size of jams, whether flocks started "
            "rotating or in one jam"
        )
    listed = "; that ".join(
        f"{each.claim.text[0].lower()}{each.claim.text[1:]} ({each.scope}: {_measured(each)})"
        for each in open_questions
    )
    slower = all(each.verdict == DOES_NOT_HOLD for each in sizes[ONE_PHASE])
    though = ", though jams grow more slowly than the flock at every density" if slower else ""
    return f"inconclusive{though}. It is not shown that {listed}"


def _measured(claim: CheckedClaim) -> str:
    value = number(claim.measured)
    return f"{value} ({claim.ends})" if claim.ends != "none" else claim.note or "undefined"


def _analyze(design: TransitionDesign, settings: Settings, results: Results) -> Outcome:
    stationary = {}
    for point in design.points():
        specs = design.stationary(settings, *point)
        stationary[point] = results.derive(Stationary, specs, specs[0].draws_seed)
    fine = {}
    for point in design.fine_points():
        fine[point] = results.derive(Jams, design.stationary(settings, *point, FINE_DT_S))
    loops = {
        (growth, kind): results.derive(Loops, design.loop(settings, growth, kind))
        for growth in design.looped()
        for kind in LOOPS
    }
    measured = Measured(design, stationary, loops, fine)
    notes, claims = [], []
    for way in WAYS:
        growth_claims, forgotten = (
            [claim.of_seeds(design.runs) for claim in each] for each in judge_jams(measured, way)
        )
        found = conclusion(growth_claims, forgotten)
        notes.append(f"Where the {way} grows with the flock, the transition is {found}.")
        claims += [*growth_claims, *forgotten]
        for growth in design.growths(way):
            claims += [claim.of_seeds(design.runs) for claim in judge(measured, growth)]
        claims.append(judge_lifetimes(measured, way).of_seeds(design.runs))
    notes += [_dissolution_note(measured), _cumulants_note(measured)]
    notes += _method_notes(design, settings)
    shown = ["jams", "nucleation", "dissolution", "substeps", "lifetimes"]
    maps = {
        (way, start): results.derive(
            JamMap, design.stationary(settings, *mapped(design, way), start)[:1]
        )
        for way, start in product(WAYS, STARTED)
    }
    return Outcome(
        tables(measured),
        pictures(measured, maps),
        claims,
        notes,
        shown,
        _CAPTIONS,
        data=["transition", "loops"],
    )


def judge_lifetimes(measured: Measured, way: str) -> CheckedClaim:
    """Judge how lifetimes grow; those of sizes that are left out may be the longest ones."""
    slope, sizes = measured.lifetime_growth(way)
    found = LIFETIMES.check(*interval(slope), way, f"of {', '.join(map(str, sizes)) or 'no'} boats")
    left_out = [str(n) for n in measured.design.sizes if n not in sizes]
    if found.verdict != DOES_NOT_HOLD or not left_out:
        return found
    note = f"{found.note}; lifetimes with {', '.join(left_out)} are too long to be measured"
    return replace(found, verdict=INCONCLUSIVE, note=note)


def _dissolution_note(measured: Measured) -> str:
    """Say how the time until one jam has lost half of its boats grows with the flock."""
    found = []
    for way in WAYS:
        for density in measured.design.densities[way]:
            value, low, high = interval(measured.dissolution_growth(way, density))
            known = f"{value:.2f} ({low:.2f} to {high:.2f})" if np.isfinite(low) else "unknown"
            found.append(f"{known} at density {density}, {way}")
    return (
        f"From {MANY_BOATS} boats on, the time after which one jam has lost half of its boats "
        "(geometric mean over runs) grows with the number of boats to the power "
        f"{', '.join(found)}. A run has to last several times as long before it forgets that start."
    )


def _cumulants_note(measured: Measured) -> str:
    lowest = []
    for way in WAYS:
        growth = measured.design.growths(way)[-1]
        for start in STARTED:
            ends = [
                (*interval(measured.stationary[growth, density, start].binder_m), density)
                for density in measured.design.densities[way]
            ]
            value, low, high, density = min(ends)
            lowest.append(
                f"{value:.2f} ({low:.2f} to {high:.2f}) with {growth.n_boats} boats at density "
                f"{density} {STARTED[start]}, {way}"
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
    return [
        "A jam is a cluster of at least three boats with gaps below 0.5 cm that point outward "
        "within 60°. Its mean size is that of the jam which a boat in a jam is in: the sum of "
        "squared sizes over the sum of sizes, over all frames of the second halves of runs. By the "
        "rule, the transition is of first order if the exponent is at least "
        f"{ONE_PHASE.low:g} at some density with its whole interval. It is not of first order if "
        "at every density the exponent, less that of the channel's width, is within "
        f"{CHANNEL_SIZE.high:g} with its whole interval, and the largest flocks have forgotten "
        "their start. The width grows with the square root of the number of boats where the whole "
        "pool grows, and not at all where the circumference does. Anything else is inconclusive. "
        "Earlier runs, of other seeds and of 40 minutes, suggested the rule: their jams shrank "
        "from the whole flock to a size that grew like the width.",
        "The first jam of a flock that started rotating is the first one of at least "
        f"{NUCLEUS} boats. A flock that started in one jam has dissolved from when its largest jam "
        "has fewer than half of the boats. The tables have medians over the runs where this "
        "happened. In the tables of jams, `in jams` is the part of the boats that are in jams, "
        "`mean size` the mean size just defined, in boats, and `largest` the mean over frames of "
        "the largest jam, in boats; frames without a jam lower `largest` alone. Numbers after ± "
        "are standard errors over runs.",
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
        "left out of the claim. A stay that lasts longer than a run is therefore not measured: "
        "where sizes are left out, the claim cannot be refuted. The claim that loops do not close "
        f"allows {SLOWER:g} times as slow ones to lose 30 % of their opening.",
        f"The compute budget is {settings.budget_core_min:g} minutes of one core. The design has "
        f"{design.runs} seeds, runs of {stationary:g} minutes, longer in proportion to the number "
        f"of boats above {LONGER_ABOVE}, whose second half counts, and loops of {lengths} minutes "
        f"with up to {design.largest_loop} boats. The design is "
        f"estimated to take {design.core_minutes(settings):.0f} minutes, and the full design "
        f"{FULL.core_minutes(settings):.0f} (`--budget`).",
    ]


def judge_jams(measured: Measured, way: str) -> tuple[list[CheckedClaim], list[CheckedClaim]]:
    """Judge the size of jams at each density, and whether the largest flocks forget their start."""
    growth, forgotten = [], []
    for density in measured.design.densities[way]:
        largest = measured.design.growths(way)[-1]
        scope = f"density {density}, {way}"
        exponent = measured.jam_growth(way, density)
        beyond = exponent - WIDTH_EXPONENTS[way]
        growth += [
            claim.check(*interval(each), scope).with_needs(measured.design.runs, "seeds")
            for claim, each in ((ONE_PHASE, exponent), (CHANNEL_SIZE, beyond))
        ]
        ratio = interval(measured.memory(largest, density))
        note = ""
        if ratio[2] == 0.0:
            # Runs without any jam have no spread, and say nothing about how rare jams are.
            ratio = (ratio[0], math.nan, math.nan)
            note = "inconclusive: needs longer runs, since those that started rotating had no jams"
        scope = f"{largest.n_boats} boats, {scope}"
        found = FORGOTTEN.check(*ratio, scope, note)
        if found.verdict == DOES_NOT_HOLD:
            found = replace(found, note="needs longer runs to know jams in equilibrium")
        forgotten.append(found if note else found.with_needs(measured.design.runs, "seeds"))
    return growth, forgotten


def judge(measured: Measured, growth: Growth) -> tuple[CheckedClaim, ...]:
    """Judge the states of whole flocks, and the loops that were run, for one size in one way."""
    scope = f"{growth.n_boats} boats, {growth.way}"
    # The density is chosen once, by the data as measured.
    densities = measured.design.densities[growth.way]
    gap, density = max((measured.gap(growth, density), density) for density in densities)
    runs = measured.design.runs
    states = BISTABILITY.check(*gap, scope, f"at density {density}").with_needs(runs, "seeds")
    if growth not in measured.design.looped():
        return (states,)
    fast, slow = (measured.loops[growth, f"{how} density"] for how in ("slow", "slowest"))
    nothing = (float("nan"),) * 3
    # A loop on which nothing jammed is closed whatever the transition, and one that never opened
    # cannot close.
    jammed = bool(slow.at_turn.mean() >= _JAMMED)
    opened = jammed and student_interval(fast.openings)[0] >= HYSTERESIS.low
    loops = (
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
    return (states, *(each if each.note else each.with_needs(runs, "seeds") for each in loops))


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
