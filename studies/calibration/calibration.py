"""Search constants of the experiment, and judge them by a score card.

The hulls of 5 × 7.5 cm in the printed pool of 180 and 97 cm fit most of what the paper says of
its pool. CMA-ES (Hansen's covariance matrix adaptation, from the package cmaes) searches the
constants, its finalists meet the runs of Section 4, and the best of these is held against the
preset `experiment`. Search, choice and judgment have seeds of their own. Written before any run:

- a candidate replaces `experiment` if its misfit is smaller by the whole interval on the seeds of
  judgment, at least five of the ten numbers that `experiment` misses are matched, and no number
  that `experiment` matches is missed;
- otherwise no constants that were tried do, and `experiment` stays.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from cmaes import CMA

import flockenv
from flockenv.runs.seeds import POLICY_SEEDS
from studies import plots
from studies.calibration.score_card import (
    CARD,
    Means,
    Number,
    features,
    misfit,
    over_seeds,
    values_of,
)
from studies.claim import FAILS, HOLDS, Claims, Interval, unknown, write_claims
from studies.picture import COLORS, picture
from studies.section4.section4 import LEVELS_S
from studies.store import VERSION, StudyError
from studies.study import Options, Row, Study, main

FIXED: Row = {
    "boat_radius_cm": 2.5,
    "gyration_radius_cm": 2.37,
    "current_gain": 0.0,
    "leader_speed_factor": 1.0,
}
"""Half the size in all directions; no current, whose inertia would be one more constant; leaders as
fast as the others (Section 2.6)."""
RANGES = {
    "speed_cm_s": (13.0, 22.0),
    "reverse_speed_cm_s": (3.0, 15.0),
    "c0": (0.4, 2.0),
    "c2": (0.1, 1.0),
    "c3": (0.1, 1.0),
    "c4": (0.01, 0.4),
    "turning_bias": (0.002, 0.06),
    "speed_spread_cm_s": (0.3, 5.0),
}
"""Where constants are searched, by their logarithms."""
TURNS_RAD_S = (0.8, 1.2)
"""The rate at which a backing boat turns, 1 rad/s in Table 1, is searched here and gives c1: at
the rate w it is c1·w² = c3·v·c0²/(c0² + w²) (eqs. 8 and 9). The speed that is reached in the fw
phase, v0·(1 − exp(−c0·2 s)), lies in 15 ± 5 cm/s (Table 1); others are drawn again."""
PARTS = {
    "search": POLICY_SEEDS["calibration search"],
    "choice": POLICY_SEEDS["calibration choice"],
    "judgment": POLICY_SEEDS["calibration judgment"],
}
FIRST_SEEDS = {"search": 1000, "choice": 100, "judgment": 100}
"""Those before had an earlier search of 97 candidates; its verdict is why this one was made."""
EARLIER = (18.37, 5.472, 0.5676, 0.3057, 0.3708, 0.15, 0.004977, 0.4393)
"""What that search chose, with a turn of 1 rad/s: this one starts there."""
GENERATIONS, POPULATION, SEARCH_SEEDS, SPREAD = 40, 25, 2, 0.2
"""Candidates of a generation share their seeds, and each generation has others. SPREAD is the first
standard deviation, in parts of a range."""
MARGIN = 0.5
"""The search asks for ranges that are narrower by this many tolerances at both ends: a number at
the end of its range is not a match but undecided."""
OF_GENERATIONS, CHOICE_SEEDS, JUDGMENT_SEEDS = 18, 24, 48
"""Finalists are the best of each of the last generations, so that no lucky seeds give several, the
middle of the search, and what the earlier one chose."""
SEARCH_LEVELS_S = (0.0, 0.4, 0.8, 1.2, 1.4, 1.6, 1.8, 2.0, 2.4)
DT_S = 0.1
"""Step of all runs. With leapfrog and white noise statistics hardly depend on it; the headlines
hold with it as with the preset's 0.02 s."""
EXPERIMENT, MIDDLE, BEFORE = -1, -2, -3
"""Numbers of the preset, of the middle of the search, and of what the earlier one chose."""
NEEDED = 5
_COUNTS = (1, 2, 4)
_NUMBERED: Any = {"adaptive": True, "numbered": "candidate"}
"""Another version of cmaes may draw other candidates, which must not take the place of these."""


def constants_at(place: Sequence[float]) -> Row:
    """Return the constants at a place in the ranges, each part of it from 0 to 1."""
    low, high = np.log([*RANGES.values(), TURNS_RAD_S]).T
    *constants, turn = np.exp(low + np.asarray(place) * (high - low))
    found = {name: float(f"{v:.4g}") for name, v in zip(RANGES, constants, strict=True)}
    lag = found["c0"] ** 2 / (found["c0"] ** 2 + turn**2)
    c1 = float(f"{found['c3'] * found['reverse_speed_cm_s'] * lag / turn**2:.4g}")
    return FIXED | found | {"c1": c1}


def place_of(constants: Sequence[float], turn: float = 1.0) -> list[float]:
    """Return where constants and a turn lie in the ranges."""
    low, high = np.log([*RANGES.values(), TURNS_RAD_S]).T
    return list((np.log([*constants, turn]) - low) / (high - low))


def is_fast_enough(constants: Row) -> bool:
    """Return whether the speed that the fw phase reaches lies in 15 ± 5 cm/s."""
    return 10.0 <= constants["speed_cm_s"] * (1.0 - np.exp(-2.0 * constants["c0"])) <= 20.0


def preset_constants() -> Row:
    """Return the same constants of the preset."""
    preset = flockenv.FlockParameters.preset("experiment").to_dict()
    return {name: preset[name] for name in (*FIXED, *RANGES, "c1")}


def row(candidate: int, constants: Row, use: str, seed: int) -> Row:
    """Return a row: all runs of one seed, or of a generation's seeds in the search."""
    first = PARTS[use].seeds(1, start=FIRST_SEEDS[use])[0]
    return (
        {"preset": "experiment", "candidate": candidate}
        | constants
        | {"dt_s": DT_S, "first_seed": first, "minutes": 8.0, "seed": seed}
    )


def searched(options: Options) -> tuple[pd.DataFrame, Row]:
    """Return the candidates with their numbers and misfits, and the middle of the search."""
    place = np.array(place_of(EARLIER))
    bounds = np.tile([0.0, 1.0], (len(place), 1))
    size = 4 if options.trial else POPULATION
    search = CMA(mean=place, sigma=SPREAD, bounds=bounds, seed=1, population_size=size)
    rows: list[Row] = []
    table = pd.DataFrame()
    for generation in range(2 if options.trial else GENERATIONS):
        places = []
        while len(places) < size:
            place = search.ask()
            if is_fast_enough(constants := constants_at(place)):
                rows.append(row(len(rows), constants, "search", generation))
                places.append(place)
        study = Study("calibration/search", lambda: rows, _search, **_NUMBERED)
        table = study.results(options)
        if len(table) != len(rows):
            raise StudyError("search.csv lacks runs; without --no-runs they are made")
        values = (table[number.name].to_numpy(float) for number in CARD)
        table["misfit"] = misfit(values, MARGIN)
        search.tell(list(zip(places, table["misfit"].tail(size), strict=True)))
    return table, constants_at(np.clip(search.mean, 0.0, 1.0))


def _search(row: Row) -> Row:
    """Return the numbers of a candidate by the seeds of its generation."""
    first = SEARCH_SEEDS * row["seed"]
    seeds = range(first, first + SEARCH_SEEDS)
    found = [features(row | {"seed": seed}, SEARCH_LEVELS_S, ()) for seed in seeds]
    means = Means(found[0], np.mean([list(each.values()) for each in found], axis=0))
    return {number.name: float(value) for number, value in zip(CARD, values_of(means), strict=True)}


def finalists(options: Options) -> list[Row]:
    """Return the candidates that meet the seeds of choice, with their numbers."""
    table, middle = searched(options)
    last = table[table["seed"] >= table["seed"].max() + 1 - OF_GENERATIONS]
    best = last.loc[last.groupby("seed")["misfit"].idxmin()]
    rows = best[["candidate", *FIXED, *RANGES, "c1"]].to_dict("records")
    rows = [each | {"candidate": int(each["candidate"])} for each in rows]
    earlier = constants_at(place_of(EARLIER))
    return [*rows, {"candidate": MIDDLE} | middle, {"candidate": BEFORE} | earlier]


def measured(
    options: Options, use: str, candidates: Sequence[Row], seeds: int
) -> dict[int, pd.DataFrame]:
    """Return the features of candidates by their number, a row for each seed."""
    rows = [
        row(each["candidate"], {n: each[n] for n in each if n != "candidate"}, use, seed)
        for each in candidates
        for seed in range(2 if options.trial else seeds)
    ]
    study = Study(
        f"calibration/{use}", lambda: rows, lambda r: features(r, LEVELS_S, _COUNTS), **_NUMBERED
    )
    table = study.results(options)
    names = [name for name in table if name not in (*rows[0], VERSION)]
    return {int(number): each[names] for number, each in table.groupby("candidate")}


def preset_row() -> Row:
    """Return the preset as a candidate."""
    return {"candidate": EXPERIMENT} | preset_constants()


def chosen(options: Options) -> Row:
    """Return the finalist that is worth the most on the seeds of choice."""
    rows = finalists(options)
    tables = measured(options, "choice", [*rows, preset_row()], CHOICE_SEEDS)
    theirs = card(tables[EXPERIMENT])

    def of(candidate: Row) -> tuple[float, float]:
        table = tables[candidate["candidate"]]
        return worth(Judgment(card(table), theirs, unknown()), total(table))

    return max(rows, key=of)


def worth(found: "Judgment", misfit: float) -> tuple[float, float]:
    """Return how many misses a candidate mends, and its misfit, so that the larger is better.

    One that loses a match comes after all others.
    """
    return -math.inf if found.lost() else len(found.mended()), -misfit


def total(table: pd.DataFrame) -> float:
    """Return the misfit of means over all seeds."""
    return float(misfit(values_of(Means(table, table.to_numpy(float).mean(0)))))


def card(table: pd.DataFrame) -> list[Interval]:
    """Return each number of the card with its interval."""
    return [over_seeds([table], each.of) for each in CARD]


@dataclass(frozen=True)
class Judgment:
    """A candidate against the preset on the seeds of judgment.

    Attributes
    ----------
    ours, theirs
        The card of the candidate and that of the preset.
    less
        Misfit of the candidate minus that of the preset.
    """

    ours: Sequence[Interval]
    theirs: Sequence[Interval]
    less: Interval

    def mended(self) -> list[str]:
        """Return the numbers of the ten misses that the candidate matches."""
        pairs = zip(CARD, self.ours, strict=True)
        return [each.name for each, found in pairs if each.missed and each.verdict(found) == HOLDS]

    def lost(self) -> list[str]:
        """Return the numbers that the preset matches and the candidate misses."""
        pairs = zip(CARD, self.ours, self.theirs, strict=True)
        return [
            each.name
            for each, ours, theirs in pairs
            if (each.verdict(ours), each.verdict(theirs)) == (FAILS, HOLDS)
        ]

    def replaces(self) -> bool:
        """Return whether the candidate replaces the preset, by the rule above."""
        return self.less[2] < 0.0 and len(self.mended()) >= NEEDED and not self.lost()


def judged(tables: dict[int, pd.DataFrame], candidate: int) -> Judgment:
    """Judge the features of a candidate and of the preset."""
    both = [tables[candidate], tables[EXPERIMENT]]
    less = over_seeds(both, lambda a, b: misfit(values_of(a)) - misfit(values_of(b)))
    return Judgment(card(both[0]), card(both[1]), less)


def claims_of(found: Judgment, candidate: int) -> Claims:
    """Return the lines of both cards, and of the misfit."""
    claims = Claims("", "", ours=True)
    for name, numbers in ((f"candidate {candidate}", found.ours), ("experiment", found.theirs)):
        claims.reading = f"{name}, narrow, n = 27"
        for each, value in zip(CARD, numbers, strict=True):
            claims.section = each.section
            claims.add(each.name, each.quantity, value, least=each.least, most=each.most)
    claims.section, claims.reading = "4, 6", f"candidate {candidate} minus experiment"
    claims.add(
        "The candidate fits better than the preset",
        "misfit over all numbers of the card, same seeds",
        found.less,
        most=0.0,
    )
    return claims


def draw(options: Options, found: Judgment, candidate: int) -> None:
    """Draw how far each number lies outside of its range, for both sets of constants."""
    series = {
        name: {each.name: _shown(each, value) for each, value in zip(CARD, numbers, strict=True)}
        for name, numbers in (
            ("experiment", found.theirs),
            (f"candidate {candidate}, hulls of 5 × 7.5 cm", found.ours),
        )
    }
    colors = dict(zip(series, COLORS, strict=False))
    with picture(options, "score_card", width_cm=15.0, height_cm=15.0) as figure:
        axes = figure.subplots()
        axes.axvspan(-0.15, 0.15, color="0.9", lw=0)
        plots.grouped(axes, series, colors, reference=0.0)
        axes.set_xlim(-_MOST_SHOWN - 0.5, _MOST_SHOWN + 0.5)
        axes.set_xlabel("distance from the claimed range in tolerances (0: inside)")
        figure.legend(loc="outside upper center", ncols=2)


_MOST_SHOWN = 6.0


def _shown(number: Number, found: Interval) -> tuple[float, float, float]:
    away = np.nan_to_num([number.away(value) for value in found], nan=-_MOST_SHOWN)
    value, low, high = np.clip(away, -_MOST_SHOWN, _MOST_SHOWN)
    return float(value), float(min(low, value)), float(max(high, value))


def script(options: Options) -> None:
    """Search, choose and judge."""
    finalist = chosen(options)
    candidate = finalist["candidate"]
    tables = measured(options, "judgment", (finalist, preset_row()), JUDGMENT_SEEDS)
    found = judged(tables, candidate)
    write_claims(options, "calibration", claims_of(found, candidate))
    print("Constants:", ", ".join(f"{name} {value:g}" for name, value in finalist.items()))
    print(f"Misses of experiment that it matches: {', '.join(found.mended()) or 'none'}")
    print(f"Matches of experiment that it misses: {', '.join(found.lost()) or 'none'}")
    print(f"It {'replaces' if found.replaces() else 'does not replace'} experiment.")
    draw(options, found, candidate)


if __name__ == "__main__":
    main(script)
