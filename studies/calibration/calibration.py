"""Constants of the experiment by a score card, in the reading of the pool that fits the most.

Hulls of 5 × 7.5 cm in the printed pool of 180 and 97 cm. Candidates are drawn at random, then near
the best ones, and meet one short run at each point; the best of them meet the runs of Section 4,
and the best of these is held against the preset `experiment`. Search, choice and judgment have
seeds of their own. Written before any run:

- a candidate replaces `experiment` if its misfit is smaller by the whole interval on the seeds of
  judgment, at least five of the ten numbers that `experiment` misses are matched, and no number
  that `experiment` matches is missed;
- otherwise no constants that were tried do, and `experiment` stays.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

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
from studies.claim import FAILS, HOLDS, Claims, Interval, write_claims
from studies.section4.section4 import LEVELS_S
from studies.study import COLORS, VERSION, Options, Row, Study, main, picture

FIXED: Row = {
    "boat_radius_cm": 2.5,
    "gyration_radius_cm": 2.37,
    "current_gain": 0.0,
    "leader_speed_factor": 1.0,
}
"""Half the size in all directions; no current, as the one that was measured has inertia, which the
model's has not; leaders as fast as the others (Section 2.6)."""
RANGES = {
    "speed_cm_s": (13.0, 22.0),
    "reverse_speed_cm_s": (3.0, 15.0),
    "c0": (0.4, 2.0),
    "c2": (0.1, 1.0),
    "c3": (0.1, 1.0),
    "c4": (0.01, 0.15),
    "turning_bias": (0.002, 0.06),
    "speed_spread_cm_s": (0.3, 5.0),
}
"""Where the others are drawn, equal ratios with equal chances. c1 follows from them: a backing boat
turns at w = ±1 rad/s (Table 1), where c1·w² = c3·v·c0²/(c0² + w²) (eqs. 8 and 9). The speed that is
reached in the fw phase, v0·(1 − exp(−c0·2 s)), lies in 15 ± 5 cm/s (Table 1); others are drawn
again."""
PARTS = {
    "search": POLICY_SEEDS["calibration search"],
    "choice": POLICY_SEEDS["calibration choice"],
    "judgment": POLICY_SEEDS["calibration judgment"],
}
PILOTS = tuple(
    dict(zip(RANGES, (*constants, bias, 1.0), strict=True))
    for constants in (
        (16.2, 5.24, 0.872, 0.288, 0.300, 0.024),
        (17.0, 6.47, 0.609, 0.574, 0.256, 0.070),
    )
    for bias in (0.003, 0.01)
)
"""The two best of 79 random candidates of a pilot with other seeds, at two strengths of the bias:
the first candidates here."""
GENERATIONS, PARENTS, STEP = (60, 30, 7), 8, 0.12
"""Candidates of a generation; how many of the best the next ones are drawn near, and how far, in
parts of the ranges' logarithms (standard deviation)."""
FINALISTS, CHOICE_SEEDS, JUDGMENT_SEEDS = 3, 4, 12
"""Before any run of choice or judgment these were 5, 6 and 24, and the last generation had 20: the
search was cut for want of processor time."""
SEARCH_LEVELS_S = (0.0, 0.4, 0.8, 1.2, 1.4, 1.6, 1.8, 2.0, 2.4)
DT_S = 0.1
"""Step of all runs. With leapfrog and white noise statistics hardly depend on it; the headlines
hold with it as with the preset's 0.02 s."""
EXPERIMENT = -1
"""The number of the preset among the candidates."""
NEEDED = 5
_COUNTS = (1, 2, 4)


def drawn(candidate: int, parents: Sequence[Row]) -> Row:
    """Return the constants of a candidate: a pilot's, drawn in the ranges, or near a parent."""
    if candidate < len(PILOTS):
        return _with_c1(PILOTS[candidate])
    random = np.random.default_rng(candidate)
    low, high = np.log(np.array(list(RANGES.values()))).T
    while True:
        if parents:
            parent = parents[random.integers(len(parents))]
            middle = np.log([parent[name] for name in RANGES])
            logs = np.clip(random.normal(middle, STEP * (high - low)), low, high)
        else:
            logs = random.uniform(low, high)
        found = {n: float(f"{v:.4g}") for n, v in zip(RANGES, np.exp(logs), strict=True)}
        fw_speed = found["speed_cm_s"] * (1.0 - np.exp(-2.0 * found["c0"]))
        if 10.0 <= fw_speed <= 20.0:
            break
    return _with_c1(found)


def _with_c1(found: Row) -> Row:
    lag = found["c0"] ** 2 / (found["c0"] ** 2 + 1.0)
    c1 = float(f"{found['c3'] * found['reverse_speed_cm_s'] * lag:.4g}")
    return FIXED | found | {"c1": c1}


def preset_constants() -> Row:
    """Return the same constants of the preset."""
    preset = flockenv.FlockParameters.preset("experiment").to_dict()
    return {name: preset[name] for name in (*FIXED, *RANGES, "c1")}


def row(candidate: int, constants: Row, use: str, seed: int) -> Row:
    """Return a row of the search, the choice or the judgment: all runs of one seed."""
    # Each candidate of the search has its own seed, so that no lucky seed makes several the best.
    first = PARTS[use].seeds(1, start=candidate if use == "search" else 0)[0]
    return (
        {"preset": "experiment", "candidate": candidate}
        | constants
        | {"dt_s": DT_S, "first_seed": first, "minutes": 8.0, "seed": seed}
    )


def searched(options: Options) -> pd.DataFrame:
    """Return the candidates with their numbers, one seed each, generation by generation."""
    rows: list[Row] = []
    table = pd.DataFrame()
    for count in (5, 1, 1) if options.trial else GENERATIONS:
        parents = best(table, PARENTS) if len(table) else []
        for candidate in range(len(rows), len(rows) + count):
            rows.append(row(candidate, drawn(candidate, parents), "search", 0))
        table = Study("calibration/search", lambda: rows, _search, adaptive=True).results(options)
    return table


def _search(row: Row) -> Row:
    found = features(row, SEARCH_LEVELS_S, ())
    values = values_of(Means(found, list(found.values())))
    return {number.name: float(value) for number, value in zip(CARD, values, strict=True)}


def best(table: pd.DataFrame, count: int) -> list[Row]:
    """Return the constants of the candidates with the least misfit, the best first."""
    found = table.assign(misfit=misfit(table[number.name].to_numpy(float) for number in CARD))
    columns = ["candidate", *FIXED, *RANGES, "c1"]
    rows = found.sort_values("misfit", kind="stable")[columns].head(count).to_dict("records")
    return [{**each, "candidate": int(each["candidate"])} for each in rows]


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
        f"calibration/{use}", lambda: rows, lambda r: features(r, LEVELS_S, _COUNTS), adaptive=True
    )
    table = study.results(options)
    names = [name for name in table if name not in (*rows[0], VERSION)]
    return {int(number): each[names] for number, each in table.groupby("candidate")}


def chosen(options: Options) -> Row:
    """Return the constants of the finalist with the least misfit on the seeds of choice."""
    finalists = best(searched(options), 2 if options.trial else FINALISTS)
    tables = measured(options, "choice", finalists, CHOICE_SEEDS)
    return min(finalists, key=lambda each: float(total(tables[each["candidate"]])))


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
    experiment = {"candidate": EXPERIMENT} | preset_constants()
    tables = measured(options, "judgment", (finalist, experiment), JUDGMENT_SEEDS)
    found = judged(tables, candidate)
    write_claims(options, "calibration", claims_of(found, candidate))
    print("Constants:", ", ".join(f"{name} {value:g}" for name, value in finalist.items()))
    print(f"Misses of experiment that it matches: {', '.join(found.mended()) or 'none'}")
    print(f"Matches of experiment that it misses: {', '.join(found.lost()) or 'none'}")
    print(f"It {'replaces' if found.replaces() else 'does not replace'} experiment.")
    draw(options, found, candidate)


if __name__ == "__main__":
    main(script)
