"""Beyond the paper: leaders with opposite targets, in a flock that only collides.

Couzin, Krause, Franks and Levin (Nature 433, 2005) gave two informed minorities of a group
different directions: the group follows the larger one, however little larger it is, and where the
directions differ enough it chooses one instead of the mean of both. There, individuals turn towards
each other; here, boats do nothing but collide.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from flockenv.reproduce.claim import DOES_NOT_HOLD, HOLDS, CheckedClaim, Claim
from flockenv.reproduce.conflicting_targets.design import (
    AGAINST,
    FULL,
    LEADERLESS,
    POOLS,
    ConflictDesign,
    Match,
    Setup,
    within,
)
from flockenv.reproduce.conflicting_targets.measured import (
    HELD_MIN,
    MOVING,
    WON,
    Measured,
    cumulant,
    lifetime_min,
    slope,
    time_ratio,
)
from flockenv.reproduce.conflicting_targets.pictures import histograms, picture
from flockenv.reproduce.reproduction import Outcome, Reproduction, Results, Settings, designed
from flockenv.statistics.intervals import interval, student_interval

__all__ = [
    "BETTER",
    "CHOOSES",
    "DIFFERENCE",
    "KEEPS",
    "LARGER",
    "NUMBER",
    "PROPORTION",
    "REPRODUCTIONS",
    "SOONER",
    "STALLS",
    "conflicting_targets",
    "judge",
]

_NAME = "conflicting-targets"
_COUZIN = "1, citing Couzin et al. (2005)"
_BEYOND = "beyond the paper"

LARGER = Claim(
    text="The flock follows the larger side",
    section=_COUZIN,
    quantity="mean signed order towards the larger side",
    low=0.0,
)
DIFFERENCE = Claim(
    text="The flock follows the larger side the more, the larger its majority",
    section=_COUZIN,
    quantity="slope of the mean signed order against (k1 - k2)/(k1 + k2) at the most leaders",
    low=0.0,
)
PROPORTION = Claim(
    text="The proportion of the sides decides, not their number",
    section=_BEYOND,
    quantity="mean signed order of 4 against 2, minus that of 2 against 1, over that of 6 alone",
    low=-0.2,
    high=0.2,
)
NUMBER = Claim(
    text="The difference of the sides decides, not their proportion",
    section=_BEYOND,
    quantity="mean signed order of 3 against 2, minus that of 1 alone, over that of 6 alone",
    low=-0.2,
    high=0.2,
)
SOONER = Claim(
    text="A larger majority has the flock sooner",
    section=_BEYOND,
    quantity="mean minutes until 5 against 1 have the flock, over those of 4 against 2",
    high=1.0,
)
CHOOSES = Claim(
    text="Between equal sides the flock goes one way or the other",
    section=_COUZIN,
    quantity="Binder's cumulant of the minutes' rotation",
    low=0.4,
)
STALLS = Claim(
    text="Between equal sides the flock stalls more than without leaders",
    section=_BEYOND,
    quantity=f"share of minutes with |m| below {MOVING:g}, minus that without leaders",
    low=0.0,
)
KEEPS = Claim(
    text="Between equal sides the flock keeps its way as long as without leaders",
    section=_BEYOND,
    quantity="mean time that a way lasts, over that without leaders",
    low=1.0,
)
BETTER = Claim(
    text="Learned leaders prevail over those of the paper's law",
    section=_BEYOND,
    quantity="mean signed order towards the learned side",
    low=0.0,
)

Found = Mapping[tuple[Setup, Match], Measured]


def judge(design: ConflictDesign, found: Found) -> list[CheckedClaim]:
    """Judge every claim in every setup, those with one policy on both sides first."""
    alike = [setup for setup in design.setups() if setup.policy != AGAINST]
    claims = [claim for setup in alike for claim in _judge_alike(design, setup, found)]
    for setup in design.setups():
        if setup.policy == AGAINST:
            claims += [
                _judged(
                    BETTER,
                    _order(found[setup, match]),
                    f"{setup.words}, {_versus(match)}",
                    design.runs[setup.policy],
                )
                for match in design.matches(setup)
            ]
    return claims


def _judge_alike(design: ConflictDesign, setup: Setup, found: Found) -> list[CheckedClaim]:
    def of(k1: int, k2: int) -> Measured:
        return found[setup, (setup.scale * k1, setup.scale * k2)]

    def order(k1: int, k2: int) -> NDArray[np.float64]:
        return of(k1, k2).means["signed_order"]

    runs, matches = design.runs[setup.policy], design.matches(setup)
    claims = [
        _judged(
            LARGER,
            _order(found[setup, match]),
            f"{setup.words}, {_versus(match)}",
            runs,
        )
        for match in matches
        if match[0] > match[1] > 0
    ]
    most = [(3, 3), (4, 2), (5, 1), (6, 0)]
    shares = [(k1 - k2) / (k1 + k2) for k1, k2 in most]
    rising = slope(shares, [order(*match) for match in most])
    for claim, values in (
        (DIFFERENCE, rising),
        (PROPORTION, (order(4, 2) - order(2, 1)) / order(6, 0)),
        (NUMBER, (order(3, 2) - order(1, 0)) / order(6, 0)),
        (SOONER, time_ratio(of(5, 1), of(4, 2))),
    ):
        claims.append(_judged(claim, interval(values), setup.words, runs))
    alone = found[setup, LEADERLESS]
    without = f"without leaders {cumulant(alone)[0]:.2f}"
    for match in matches:
        if match[0] == match[1]:
            tie, scope = found[setup, match], f"{setup.words}, {_versus(match)}"
            stalled = tie.means["still"] - alone.means["still"]
            mean_life = lifetime_min(tie) / lifetime_min(alone)
            claims += [
                _judged(CHOOSES, interval(cumulant(tie)), scope, runs, without),
                _judged(STALLS, interval(stalled), scope, runs),
                _judged(KEEPS, interval(mean_life), scope, runs),
            ]
    return claims


def _judged(
    claim: Claim, found: tuple[float, float, float], scope: str, runs: int, note: str = ""
) -> CheckedClaim:
    return claim.check(*found, scope, note).with_needs(runs, "runs for each match")


def _order(found: Measured) -> tuple[float, float, float]:
    return student_interval(found.signed_order)


def _versus(match: Match) -> str:
    return f"{match[0]} against {match[1]}"


def _analyze(design: ConflictDesign, settings: Settings, results: Results) -> Outcome:
    found = {}
    for setup in design.setups():
        for match in (LEADERLESS, *design.matches(setup)):
            specs = design.specs(settings, setup, match)
            runs = [results[spec] for spec in specs]
            found[setup, match] = Measured.of_runs(runs, specs[0].draws_seed)
    claims = judge(design, found)
    sizes = {f"{_NAME}-{n}" if place else _NAME: n for place, n in enumerate(design.sizes)}
    return Outcome(
        {"matches": _matches_table(found), "minutes": _minutes_table(found)},
        {
            **{name: picture(design, found, n) for name, n in sizes.items()},
            "rotation": histograms(design, found),
        },
        claims,
        [_answer(claims), *_notes(design, settings)],
        shown=["matches"],
        captions={
            **{
                name: "Above: mean signed order towards the larger side against the majority "
                f"(k1 - k2)/(k1 + k2), of flocks of {n}; bars: 95 % intervals. Below: mean minutes "
                "until the larger side has the flock, the length of the run where it never does. "
                f"Filled: {6 * Setup(design.policies[0], POOLS[0], n).scale} leaders; open: fewer"
                for name, n in sizes.items()
            },
            "rotation": "How the minutes' rotation m of flocks of 27 is distributed without "
            "leaders, between equal sides and with a majority",
        },
    )


def _answer(claims: Sequence[CheckedClaim]) -> str:
    def of(claim: Claim, verdict: str) -> str:
        every = [each.verdict for each in claims if each.claim is claim]
        return f"{every.count(verdict)} of {len(every)}"

    return (
        f"The flock follows the larger side in {of(LARGER, HOLDS)} matches of unequal sides, and "
        "shows the opposite with certainty in "
        f"{of(LARGER, DOES_NOT_HOLD)}. Between equal sides it stalls more than without leaders in "
        f"{of(STALLS, HOLDS)} matches, keeps its way for a shorter time than without leaders in "
        f"{of(KEEPS, DOES_NOT_HOLD)}, and goes one way or the other in {of(CHOOSES, HOLDS)}. What "
        "is missing to these numbers is inconclusive or the opposite; the table of claims says "
        "which."
    )


def _notes(design: ConflictDesign, settings: Settings) -> list[str]:
    minutes = settings.duration_s(design.minutes) / 60
    seeds = ", ".join(f"{runs} ({policy})" for policy, runs in design.runs.items())
    small = [Setup(design.policies[0], pool, min(design.sizes)) for pool in POOLS]
    noise = [f"{each.parameters(LEADERLESS).bw_s:g} s in {each.pool}" for each in small]
    return [
        "Of the leaders, k1 head clockwise and k2 counter-clockwise (`target=[...]`), each by the "
        "same policy. The physics is symmetric under reflection, so that the larger side is always "
        "the clockwise one. Each run starts at random and at rest. Signed order is Ψ_o sin φ_o of "
        "the normal boats towards the larger side, in the analysis window of the second half.",
        f"The preset is simulation with dt = 0.05 s, and the noise the critical one of 27 boats, "
        f"bw {' and '.join(noise)}. "
        "Flocks of 100 have pools of the same shape and density, and four times as many leaders. "
        "The tuned and the learned policy are those of the pool; they were made for three leaders "
        "with one target among 27 boats.",
        f"A side has the flock from the first minute whose mean signed order is at least {WON:g} "
        f"and which {HELD_MIN} minutes above zero follow; times are compared where both sides get "
        "it in at least half of the runs. A flock goes one way in minutes with "
        f"|m| of at least {MOVING:g}, and stalls in the others, m = Ψ_o sin φ_o. Binder's cumulant "
        "1 - <m⁴>/(3 <m²>²) is 2/3 where m has one size and either sign, 0.4 where all m up to a "
        "size are as frequent, and 0 where m is normal about 0; a compromise between opposite "
        "directions is a stall.",
        "Intervals of means over runs are Student's, the others a bootstrap over runs. A claim "
        "about the proportion or the difference of the sides holds only if both orders are equal "
        "within a fifth of the order that six leaders reach alone, over the whole interval. Where "
        "both claims hold, these flocks do not distinguish them. Where a flock without leaders "
        "does not reach the cumulant of a choice either, that between equal sides says nothing "
        "about their conflict.",
        "In the table, `after min` is the mean time until the larger side has the flock, with the "
        "length of the run where it never does; its intervals are 95 % ones.",
        f"The compute budget is {settings.budget_core_min:g} minutes of one core. The design has "
        f"{seeds} seeds for each match, {minutes:g} minutes per run, and flocks of up to "
        f"{max(design.sizes)} boats. It is estimated to take "
        f"{design.core_minutes(settings):.0f} minutes, and the full design "
        f"{FULL.core_minutes(settings):.0f} (`--budget`).",
    ]


def _matches_table(found: Found) -> pd.DataFrame:
    rows = []
    for (setup, match), each in found.items():
        value, low, high = _order(each)
        mean_life = interval(lifetime_min(each))
        rows.append(
            {
                "policy": setup.policy if match != LEADERLESS else "no leaders",
                "pool": setup.pool,
                "boats": setup.n_boats,
                "k1": match[0],
                "k2": match[1],
                "signed order": f"{value:.2f} ({low:.2f} to {high:.2f})",
                "right way": f"{(each.signed_order > 0.0).mean():.2f}",
                "had the flock": f"{each.means['won'][0]:.2f}",
                "after min": f"{each.means['decision_min'][0]:.1f}",
                "stalled": f"{each.means['still'][0]:.2f}",
                "cumulant": f"{cumulant(each)[0]:.2f}",
                "a way lasts min": f"{mean_life[0]:.1f}",
            }
        )
    # Flocks without leaders are the same under every policy.
    return pd.DataFrame(rows).drop_duplicates(ignore_index=True)


def _minutes_table(found: Found) -> pd.DataFrame:
    rows = [
        {
            "policy": setup.policy,
            "pool": setup.pool,
            "n_boats": setup.n_boats,
            "k1": match[0],
            "k2": match[1],
            "run": run,
            "minute": minute,
            "rotation": value,
        }
        for (setup, match), each in found.items()
        for run, minutes in enumerate(each.minutes)
        for minute, value in enumerate(minutes.tolist())
    ]
    return pd.DataFrame(rows)


def conflicting_targets(design: ConflictDesign | None = None) -> Reproduction:
    """Return the reproduction, by default in the largest design that the budget allows."""
    return designed(
        _NAME,
        "Which of two informed minorities does a flock follow?",
        _COUZIN,
        within if design is None else lambda settings: design,
        _analyze,
    )


REPRODUCTIONS = (conflicting_targets(),)
