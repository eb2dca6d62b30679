"""Beyond the paper: whether a larger flock needs a smaller proportion of leaders.

The paper's introduction cites Couzin, Krause, Franks and Levin (Nature 433, 2005): the larger the
group, the smaller the proportion of informed individuals that guides it. There, individuals turn
towards each other; here, boats do nothing but collide.
"""

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd

from flockenv.reproduce.claim import FEWEST_RUNS, CheckedClaim, Claim
from flockenv.reproduce.leader_fraction.design import (
    DENSITY,
    FULL,
    FractionDesign,
    Setup,
    within,
)
from flockenv.reproduce.leader_fraction.measured import GUIDED, Curve, exponent, line_p
from flockenv.reproduce.leader_fraction.pictures import picture
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings, designed
from flockenv.reproduce.transition.design import WAYS, Growth
from flockenv.statistics.intervals import interval, student_interval

__all__ = [
    "BETTER",
    "CONSTANT_NUMBER",
    "REPRODUCTIONS",
    "SMALLER",
    "fractions_table",
    "judge",
    "leader_fraction",
]

_EXPONENT = (
    f"exponent a of the proportion of leaders at which the mean signed order reaches {GUIDED:g}, "
    "proportional to n^a"
)
SMALLER = Claim(
    text="The larger the flock, the smaller the proportion of leaders that guides it",
    section="1, citing Couzin et al. (2005)",
    quantity=_EXPONENT,
    high=0.0,
)
CONSTANT_NUMBER = Claim(
    text="A constant number of leaders guides flocks of any size",
    section="beyond the paper",
    quantity=_EXPONENT,
    high=-1.0,
)
BETTER = Claim(
    text="Fewer leaders are needed than under the paper's law",
    section="beyond the paper",
    quantity=f"proportion of leaders for a signed order of {GUIDED:g}, over that under the law",
    high=1.0,
)

_UNLIKELY = 0.05
"""Probability of points below which they are not on a power law."""

Curves = Mapping[Setup, Curve]


def judge(design: FractionDesign, curves: Curves) -> list[CheckedClaim]:
    """Judge the exponent of every policy in every way of growing, then policies by size."""
    claims = []
    for policy in design.policies:
        for way in WAYS:
            growths = [Growth(way, n) for n in design.sizes]
            every = [curves[policy, each] for each in growths]
            judged = [curves[policy, each] for each in growths if design.runs[each] >= FEWEST_RUNS]
            known = [curve for curve in judged if not math.isnan(curve.replicates[0])]
            ends = interval(exponent(known))
            sizes = ", ".join(str(curve.n_boats) for curve in known) or "no"
            note = "" if len(known) == len(every) else f"of {sizes} boats"
            scope = f"{policy}, {way}"
            remarks = [note] if note else []
            if len(known) > 2 and math.isnan(ends[1]):
                remarks.append("more than half of the draws have no proportion at some size")
            if line_p(known) < _UNLIKELY:
                remarks.append(f"a power law does not describe the sizes, p = {line_p(known):.1g}")
            note = "; ".join(remarks)
            claims += [claim.check(*ends, scope, note) for claim in (SMALLER, CONSTANT_NUMBER)]
    law, *others = design.policies
    for policy, growth in design.leaders:
        if policy in others:
            ratio = curves[policy, growth].replicates / curves[law, growth].replicates
            scope = f"{policy}, {growth.n_boats} boats, {growth.way}"
            found, seeds = BETTER.check(*interval(ratio), scope), design.runs[growth]
            # Where a proportion is undefined, other numbers of leaders are missing and not seeds.
            if found.ends != "none":
                found = found.with_needs(seeds, "seeds")
            claims.append(found.of_seeds(seeds))
    return claims


def _analyze(design: FractionDesign, settings: Settings, results: Results) -> Outcome:
    curves = {}
    for policy, growth in design.leaders:
        specs = design.curve(settings, policy, growth)
        runs = {k: [results[spec] for spec in each] for k, each in specs.items()}
        draws_seed = next(iter(specs.values()))[0].draws_seed
        curves[policy, growth] = Curve.of_runs(growth.n_boats, runs, draws_seed)
    return Outcome(
        {"curves": _curves_table(curves), "fractions": fractions_table(curves)},
        {"leader-fraction": picture(design, curves)},
        judge(design, curves),
        [*_answers(design, curves), _drift_note(design, curves), *_notes(design, settings)],
        shown=["fractions"],
        data=["curves"],
        captions={
            "leader-fraction": "Above: mean signed order against the proportion of leaders, by "
            "policy. Below: proportion of leaders at which it reaches "
            f"{GUIDED:g}, by policy, against the number of boats; bars: 95 % intervals"
        },
    )


def _answers(design: FractionDesign, curves: Curves) -> list[str]:
    """Say how large the proportions are, since a power law may not describe them."""
    answers = []
    for way in WAYS:
        policies = []
        for policy in design.policies:
            points = []
            for n in design.sizes:
                value, low, high = interval(curves[policy, Growth(way, n)].replicates)
                if not math.isnan(low):
                    points.append(f"{value:.3f} ({low:.3f} to {high:.3f}) of {n} boats")
            policies.append(f"{', '.join(points) or 'unknown'} under the policy {policy}")
        answers.append(
            f"Where the {way} grows, the proportion of leaders that guides a flock is "
            f"{'; '.join(policies)}."
        )
    return answers


def _drift_note(design: FractionDesign, curves: Curves) -> str:
    largest = design.sizes[-1]
    drifts = []
    for way in WAYS:
        of_way = [curves[policy, Growth(way, largest)].drift for policy in design.policies]
        value, low, high = student_interval(np.concatenate(of_way))
        drifts.append(f"{value:.3f} ({low:.3f} to {high:.3f}) where the {way} grows")
    return (
        f"Flocks of {largest} may not have come to rest after half a run: over all policies and "
        "numbers of leaders their mean signed order in the last quarter exceeds that in the third "
        f"by {' and by '.join(drifts)}."
    )


def _notes(design: FractionDesign, settings: Settings) -> list[str]:
    minutes = settings.duration_s(design.minutes) / 60
    runs = ", ".join(f"{runs} ({each.n_boats}, {each.way})" for each, runs in design.runs.items())
    return [
        "Each run starts at random and at rest, and its second half counts. A large flock orders "
        "without leaders too, in a direction of its own, and keeps this direction: its signed "
        "order is near 0.8 or -0.8, and the mean over runs says how often leaders decided the "
        "direction.",
        f"The density is {DENSITY:g} boats for each free area of the pool 500-boats, where these "
        "flocks are as dense as the paper's with 27 boats. The preset is simulation, bw 0.3 s "
        "included, with dt = 0.05 s. The tuned and the learned policy are those of 500-boats with "
        "three leaders among 27 boats, and were not searched for in larger flocks.",
        "The mean signed order over runs is made to grow with the number of leaders by isotonic "
        f"regression, and interpolated in the logarithm of the proportion to {GUIDED:g}. The "
        "exponent is the slope of a straight line through the logarithms, at three sizes or more. "
        "Intervals are a bootstrap over runs. A proportion is undefined where the order is on one "
        f"side of {GUIDED:g} at all numbers of leaders that were run. The table has the bound that "
        "follows, the exponent is that of the other sizes, and draws of the bootstrap without a "
        "proportion are left out, of which the table has the share; where they are the "
        "larger part, there is no interval. Claims hang on curves of at least "
        f"{FEWEST_RUNS} seeds. The first claim is wrong if the exponent is above 0: the proportion "
        "then grows with the flock.",
        f"The compute budget is {settings.budget_core_min:g} minutes of one core. The design has "
        f"{minutes:g} minutes per run, and for each number of leaders these seeds, by boats and "
        f"way: {runs}. It is estimated to take {design.core_minutes(settings):.0f} minutes, and "
        f"the full design {FULL.core_minutes(settings):.0f} (`--budget`).",
    ]


def _curves_table(curves: Curves) -> pd.DataFrame:
    rows = []
    for (policy, growth), curve in curves.items():
        for k, values in curve.signed_order.items():
            row: dict[str, object] = {"policy": policy, "way": growth.way}
            row |= {"n_boats": growth.n_boats, "n_leaders": k, "runs": len(values)}
            ends = student_interval(values)
            names = ("signed_order", "signed_order_low", "signed_order_high")
            right = {"right_way": float((values > 0.0).mean())}
            rows.append(row | dict(zip(names, ends, strict=True)) | right)
    return pd.DataFrame(rows)


def fractions_table(curves: Curves) -> pd.DataFrame:
    """Return the proportions of leaders, or bounds of them, as words."""
    rows = []
    for (policy, growth), curve in curves.items():
        value, low, high = interval(curve.replicates)
        row = {"policy": policy, "way": growth.way, "boats": str(growth.n_boats)}
        if math.isnan(value):
            side, leaders = _bound(curve)
            row |= {"fraction": f"{side} {leaders / growth.n_boats:.3f}", "interval": "none"}
            row["leaders"] = f"{side} {leaders}"
        else:
            row |= {"fraction": f"{value:.3f}", "interval": f"{low:.3f} to {high:.3f}"}
            row["leaders"] = f"{value * growth.n_boats:.1f}"
        undefined = np.isnan(curve.replicates[1:]).mean()
        rows.append(row | {"undefined draws": f"{undefined:.0%}"})
    return pd.DataFrame(rows)


def _bound(curve: Curve) -> tuple[str, int]:
    """Return a bound of the number of leaders where the order is on one side of `GUIDED`.

    The regression keeps the mean of the curve, which is therefore on that side too.
    """
    numbers = list(curve.signed_order)
    mean = np.mean([values.mean() for values in curve.signed_order.values()])
    return ("below", min(numbers)) if mean >= GUIDED else ("above", max(numbers))


def leader_fraction(design: FractionDesign | None = None) -> Reproduction:
    """Return the reproduction, by default in the largest design that the budget allows."""
    return designed(
        "leader-fraction",
        "Do larger flocks need a smaller proportion of leaders?",
        "1, citing Couzin et al. (2005)",
        within if design is None else lambda settings: design,
        _analyze,
    )


REPRODUCTIONS = (leader_fraction(),)
