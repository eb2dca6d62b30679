"""Score the entries of suite v3 in flocks unlike those that they learned in.

    python -m studies.levels.unlike_flocks      # about half an hour of one core in all

Rule, fixed before any policy was judged by it:

- Conditions. The twenty cells of `studies.other_flocks.beyond_one_noise`, which judged the policies
  of suite v2, each put upon a level: what a cell names replaces the level's own, and all else stays
  the level's, its observation, episode, target, control steps and coarse physics. No cell needs an
  observation of another size, since leaders see a fixed number of neighbors or none.
- Cells that are not conditions. "As trained" is the level's own flock. So are four leaders in
  `order-easy` and `order-noisy`. They leave 18 cells in those two levels and 19 in `order-narrow`
  and `order-wide`. Nothing stands in for them.
- Cells that say another thing here. The numbers of a cell are absolute: 15 boats are more than the
  ten of two levels and fewer than the 27 of the others. The scheme `paper` has its critical noise
  in the level's pool, and keeps its steps of 0.02 s, on which its noise depends. Targets alternate
  each quarter of an episode: every 2 min in `order-wide`, 1 min in `order-narrow`, else 30 s.
- Scale. Without steering and under the damped law a condition has 128 flocks, whose seeds follow
  from a hash of its name. The condition counts in a level if the 95 % interval of the law's gain,
  paired by flock, lies above 0.05 of order. Otherwise the law is not shown to lead, or so little
  that luck decides, and the condition is left out for every entry.
- Score of a training in a condition: (order - no steering) / (damped law - no steering). The order
  is the mean over the first eight of these flocks; the other two are means over all 128. The column
  is the mean over the level's conditions that count, each with the same weight. Its 95 % interval
  is over trainings and flocks, as the suite's. It leaves out the luck of the scale, which is common
  to all entries.
- Power, from the orders of the suite's own flocks. In score, the SD of what all trainings share in
  a flock is 0.5 in `order-easy` and `order-narrow` and 0.7 in the two others, and of the rest 0.55.
  With 15 conditions the luck of flocks alone has a half width of 0.11 and 0.16, of which 0.03 can
  change ranks of ten trainings, whose own luck is larger. Half widths of 0.05 would take 24 to 50
  flocks and more than an hour and a half. The rule said 24 flocks in levels of ten boats and 12 in
  the others, and was changed for what a run takes, when A2C had led 24 flocks in `order-easy` and
  before anybody looked at a score.
- Answer. What ranks best in its own flocks ranks best in unlike ones, in a level, if one entry of
  30 flock-hours has both highest scores. The rank correlation (Spearman) of the two scores of the
  entries has a 95 % interval by bootstrap over each entry's trainings (percentiles, as the scores
  cannot rank more alike than 1).

What a policy did in a condition is stored, by the digest of its weights, and not done again. The
folder results has the orders of laws and policies (unlike_laws.csv, unlike_orders.csv), what the
law gains (unlike_conditions.csv), the column (unlike.csv) and the answer (unlike_ranks.csv). The
table of docs/levels.md gets its column.
"""

import argparse
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from flockenv import FlockParameters
from flockenv.comparison import run_episodes
from flockenv.comparison.levels import LEVELS, NO_STEERING, REFERENCE, Level
from flockenv.comparison.suite_entry import SuiteEntry
from flockenv.runs.seeds import release_seeds
from flockenv.statistics import (
    mean_interval,
    paired_difference,
    two_way_interval,
)
from studies.levels import score_levels
from studies.levels.draw import trainings
from studies.other_flocks.beyond_one_noise import CELLS, Cell
from studies.store import write_table
from studies.study import HERE, Options, Row, Study, run

LAW_FLOCKS, LED_FLOCKS, MARGIN = 128, 8, 0.05
KEY, PLACE = ["level", "budget", "entry"], ["level", "what", "value"]
CONDITIONS = HERE / "levels" / "results" / "unlike_conditions.csv"
RANKED = "30"
"""Flock-hours of the entries whose ranks are compared."""


@dataclass(frozen=True)
class Condition:
    """A cell put upon a level."""

    cell: Cell
    flock: FlockParameters
    #: Options of the environment.
    options: Mapping[str, Any]

    @classmethod
    def from_cell(cls, cell: Cell, level: Level) -> "Condition":
        """Return what a cell changes in a level."""
        own, changes = level.parameters, {**cell.parameters}
        if cell.preset != "simulation":
            changes = {name: getattr(own, name) for name in ("pool", "n_boats", "n_leaders")}
            changes["bw_s"] = FlockParameters.critical_bw_s(cell.preset, own.pool)
            own = FlockParameters.preset(cell.preset)
        return cls(cell, own.replace(**changes), {**level.environment, **cell.options})

    def is_of(self, level: Level) -> bool:
        """Return whether these are the level's own flocks."""
        return self.flock == level.parameters and self.options == level.environment


def conditions(level: Level) -> list[Condition]:
    """Return the conditions that are unlike the level's own flocks."""
    found = (Condition.from_cell(cell, level) for cell in CELLS)
    return [each for each in found if not each.is_of(level)]


# --- runs ----------------------------------------------------------------------------------------


def run_of(level: str, condition: Condition, flocks: int, steers: str) -> Row:
    """Return all that a run depends on, by the name of the policy with its digest."""
    cell = condition.cell
    made = {"level": level, "what": cell.what, "value": cell.value}
    return made | {"flocks": flocks, "policy": steers}


def measured(row: Row, steers: Any) -> Row:
    """Return the signed orders of the flocks of a row."""
    level = LEVELS[row["level"]]
    (found,) = (
        each
        for each in conditions(level)
        if (each.cell.what, each.cell.value) == (row["what"], row["value"])
    )
    seeds = release_seeds(f"suite v3, {row['what']}: {row['value']}", LAW_FLOCKS)[: row["flocks"]]
    orders = run_episodes(found.flock, steers, seeds, level.episode_s, options=found.options)
    return {"orders": " ".join(f"{order:.4f}" for order in orders["signed_order"])}


def led_by_laws(options: Options, levels: Sequence[str]) -> pd.DataFrame:
    """Return the orders of every condition without steering and under the damped law."""
    rows = [
        run_of(name, condition, LAW_FLOCKS, law)
        for name in levels
        for condition in conditions(LEVELS[name])
        for law in (NO_STEERING, REFERENCE)
    ]
    study = Study(
        "levels/unlike_laws",
        lambda: rows,
        lambda row: measured(row, row["policy"]),
        adaptive=True,
    )
    return _with_orders(rows, study.results(options))


def _with_orders(rows: Sequence[Row], table: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of a design with their orders, as arrays of numbers."""
    orders = [np.array(text.split(), float) for text in table["orders"]]
    return pd.DataFrame(rows).assign(orders=orders)


def gains(led: pd.DataFrame) -> pd.DataFrame:
    """Return what the damped law gains in each condition, and whether the condition counts."""
    rows = []
    for key, own in led.groupby(PLACE, sort=False):
        none, law = (
            own[own["policy"] == name]["orders"].item() for name in (NO_STEERING, REFERENCE)
        )
        gain = paired_difference(law, none)
        ends = {"no_steering": none.mean(), "damped_law": law.mean(), "gain": gain.mean}
        ends |= {"gain_low": gain.low, "gain_high": gain.high, "counts": gain.low > MARGIN}
        rows.append(dict(zip(PLACE, key, strict=True)) | ends)
    return pd.DataFrame(rows)


def led_by_entries(
    options: Options, entries: Sequence[SuiteEntry], found: pd.DataFrame
) -> pd.DataFrame:
    """Return the orders by all policies of entries, in the conditions that count."""
    counted = {tuple(each) for each in found[found["counts"]][PLACE].to_numpy()}
    steers, rows = {}, []
    for entry in entries:
        for level, own in entry.trainings.items():
            for training in own:
                name = training.policy.name
                steers[name] = training.policy
                named = {"budget": entry.budget, "entry": entry.name, "training": training.given}
                rows += [
                    run_of(level, each, LED_FLOCKS, name) | named
                    for each in conditions(LEVELS[level])
                    if (level, each.cell.what, each.cell.value) in counted
                ]
    study = Study(
        "levels/unlike_orders",
        lambda: rows,
        lambda row: measured(row, steers[row["policy"]]),
        adaptive=True,
    )
    return _with_orders(rows, study.results(options))


# --- scores --------------------------------------------------------------------------------------


def scored(led: pd.DataFrame, found: pd.DataFrame) -> dict[tuple[str, str, str], pd.DataFrame]:
    """Return the scores of each entry's trainings, a row each, in the flocks of all conditions.

    A number is the mean over conditions of the scores in a flock, which are other flocks in each.
    """
    scale = found.set_index(PLACE)[["no_steering", "gain"]]
    every = {}
    for key, own in led.groupby(KEY, sort=False):
        rows = {}
        for training, runs in own.groupby("training", sort=False):
            ends = scale.loc[list(map(tuple, runs[PLACE].to_numpy()))].to_numpy()
            rows[training] = ((np.stack(runs["orders"]) - ends[:, :1]) / ends[:, 1:]).mean(axis=0)
        every[key] = pd.DataFrame(rows).T
    return every


def column(
    scores: Mapping[tuple[str, str, str], pd.DataFrame], found: pd.DataFrame
) -> pd.DataFrame:
    """Return the score of each entry in unlike flocks, with its interval."""
    counts = found.groupby("level")["counts"].sum()
    rows = []
    for key, each in scores.items():
        table = each.to_numpy()
        ends = two_way_interval(table) if len(table) > 1 else mean_interval(table[0])
        sizes = len(table), int(counts[key[0]]), table.shape[1]
        rows.append([*key, *sizes, *ends])
    names = ["trainings", "conditions", "flocks", "unlike", "unlike_low", "unlike_high"]
    return pd.DataFrame(rows, columns=[*KEY, *names])


def correlation(own: Sequence[np.ndarray], unlike: Sequence[np.ndarray]) -> Callable[..., Any]:
    """Return the rank correlation of two mean scores of entries, for trainings that are drawn.

    Each entry has an array of the scores of its trainings, and a drawn one of their indices.
    """

    def of(*drawn: np.ndarray, axis: int = -1) -> Any:
        means = (
            [each[at.astype(int)].mean(axis) for each, at in zip(scores, drawn, strict=True)]
            for scores in (own, unlike)
        )
        return score_levels.rank_correlation(*means)

    return of


def ranks(scores: Mapping[tuple[str, str, str], pd.DataFrame], own: pd.DataFrame) -> pd.DataFrame:
    """Return, for each level, whether entries rank in unlike flocks as in its own."""
    rows = []
    for level in dict.fromkeys(key[0] for key in scores):
        pairs = {}
        for key, each in scores.items():
            if key[0] != level or key[1] != RANKED:
                continue
            here = own[(own[KEY] == list(key)).all(axis=1)].set_index("policy")["score"]
            pairs[key[2]] = here.loc[each.index].to_numpy(), each.mean(axis=1).to_numpy()
        if len(pairs) < 2:
            continue
        sides = [*zip(*pairs.values(), strict=True)]
        drawn = [np.arange(len(each)) for each in sides[0]]
        of = correlation(*sides)
        best = (max(pairs, key=lambda name: pairs[name][side].mean()) for side in (0, 1))
        ends = score_levels.percentiles(drawn, of)
        rows.append([level, len(pairs), *best, float(of(*drawn)), *ends])
    names = ["entries", "best_own", "best_unlike", "rank_correlation", "low", "high"]
    return pd.DataFrame(rows, columns=["level", *names])


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--entries", type=Path, default=score_levels.ENTRIES)
    parser.add_argument("--levels", nargs="+", choices=[*LEVELS], default=[*LEVELS])
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=HERE, help="folder of the folder levels")
    parser.add_argument("--page", type=Path, default=score_levels.PAGE)
    given = parser.parse_args(arguments)
    options = Options(workers=given.workers, out=given.out, study="levels")
    entries, refused = score_levels.entered(given.entries)
    results = options.folder / "results"
    found = gains(led_by_laws(options, given.levels))
    write_table(results / "unlike_conditions.csv", found, "%.4f")
    scores = scored(led_by_entries(options, [*entries.values()], found), found)
    table = column(scores, found)
    write_table(results / "unlike.csv", table, score_levels.FORM)
    answer = ranks(scores, trainings(results).astype({"budget": str}))
    write_table(results / "unlike_ranks.csv", answer, "%.3f")
    score_levels.write_page(given.page, results, entries)
    for each in (found, table, answer):
        print(each.round(3).to_string(index=False))
    score_levels.named_at_the_end(refused)


if __name__ == "__main__":
    run(main)
