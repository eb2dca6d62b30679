"""Score all entries of suite v3, compare them in pairs, and write the table of docs/levels.md.

    python -m studies.levels.score_levels            # some minutes of one core
    python -m studies.levels.score_levels --check    # fails if a committed row differs by a digit

The folder results has entries.csv (the rows of `flockenv compare --suite v3`), orders.csv (the
signed order of every flock), curves.csv and areas.csv (what was learned during the trainings, as
their files say) and pairs.csv. For each pair of entries with a level and a budget in common,
pairs.csv has:

- difference: of the mean scores, with its 95 % interval over trainings and flocks. Trainings are
  paired by their place, so that those that only one of both has do not count here.
- improvement: how often a training of the first is better than one of the second, with its 95 %
  interval over trainings.
- p: by all permutations of the trainings, and corrected for all pairs of the level and budget
  (Holm). With three trainings each it is 0.1 at least.
"""

import argparse
import io
import itertools
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy import stats

from flockenv.comparison.levels import LEVELS
from flockenv.comparison.suite_entry import SuiteEntry, scored
from flockenv.statistics import bootstrap_interval, two_way_interval
from studies.levels import level_curves
from studies.study import StudyError, existing, resumed, run, write, write_table
from studies.suite.compare_grid import holm

HERE = Path(__file__).parent
ENTRIES, RESULTS = HERE / "entries", HERE / "results"
PAGE = HERE.parents[1] / "docs" / "levels.md"
BEGIN, END = "<!-- entries -->\n\n", "\n\n<!-- end -->"
FORM = "%.6g"
KEY = ["level", "budget", "entry"]


def entries(folder: Path) -> list[SuiteEntry]:
    """Return all entries of a folder."""
    found = [SuiteEntry.from_file(path) for path in sorted(folder.glob("*.toml"))]
    if not found:
        raise StudyError(f"{folder} holds no entry: studies.levels.train_levels makes some")
    return found


def rounded(rows: pd.DataFrame) -> pd.DataFrame:
    """Return rows as a file has them."""
    text = rows.to_csv(index=False, float_format=FORM)
    return pd.read_csv(io.StringIO(text), dtype=str, keep_default_na=False)


def differing(found: pd.DataFrame, committed: pd.DataFrame) -> list[str]:
    """Return the rows that differ by a digit, or that only one of both has, in words."""
    both = [each.set_index(KEY).sort_index() for each in (rounded(found), committed)]
    every = sorted({*both[0].index, *both[1].index})
    return [
        ", ".join(key)
        for key in every
        if not all(key in each.index for each in both)
        or not both[0].loc[key].equals(both[1].loc[key, both[0].columns])
    ]


# --- pairs ----------------------------------------------------------------------------------------


def better(ours: Any, theirs: Any, axis: int = -1) -> Any:
    """Return how often a value of ours is above one of theirs; equal ones count half."""
    ours, theirs = np.moveaxis(ours, axis, -1), np.moveaxis(theirs, axis, -1)
    away = ours[..., :, None] - theirs[..., None, :]
    return ((away > 0.0) + 0.5 * (away == 0.0)).mean(axis=(-2, -1))


def pair(ours: np.ndarray, theirs: np.ndarray, scale: float) -> dict[str, float]:
    """Compare two entries by the orders of their trainings, shape (trainings, flocks)."""
    both = min(len(ours), len(theirs))
    difference = np.array(two_way_interval(ours[:both] - theirs[:both])) / scale
    means = ours.mean(axis=1), theirs.mean(axis=1)
    improved = bootstrap_interval(means, better, paired=False)
    permuted = stats.permutation_test(
        means, lambda a, b, axis: a.mean(axis) - b.mean(axis), vectorized=True, n_resamples=200_000
    )
    names = [f"{name}{end}" for name in ("difference", "improvement") for end in ("", *ENDS)]
    values = [*difference, *improved]
    return dict(zip(names, values, strict=True)) | {"p": float(permuted.pvalue)}


ENDS = ("_low", "_high")


def led(orders: pd.DataFrame) -> np.ndarray:
    """Return the orders of an entry's trainings, shape (trainings, flocks)."""
    return np.array([each.to_numpy() for _, each in orders.groupby("policy")["signed_order"]])


def pairs(rows: pd.DataFrame, orders: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each two entries of a level and budget, the better one first."""
    own = {key: led(each) for key, each in orders.groupby(KEY, sort=False)}
    parts = []
    for (level, budget), entered in rows.groupby(KEY[:2], sort=False):
        ends = own[level, "0", "reference"].mean(axis=1)
        every = {name: own[level, budget, name] for name in entered["entry"]}
        every = {name: each for name, each in every.items() if len(each) > 1}
        scale = abs(ends[0] - ends[1])
        found = [
            {"level": level, "budget": budget, "better": first, "worse": second}
            | pair(every[first], every[second], scale)
            for first, second in itertools.combinations(every, 2)
        ]
        if found:
            table = pd.DataFrame(found)
            parts.append(table.assign(p_of_all_pairs=holm(table["p"].to_numpy())))
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()


def told_apart(compared: pd.DataFrame) -> list[str]:
    """Return the most entries of a level and budget of which each two differ.

    Two differ if the interval of their difference leaves out 0.
    """
    differ = (compared["difference_low"] > 0.0) | (compared["difference_high"] < 0.0)
    told = {frozenset(each) for each in compared[differ][["better", "worse"]].to_numpy()}
    names = [*dict.fromkeys(compared[["better", "worse"]].to_numpy().ravel())]
    for size in range(len(names), 1, -1):
        for some in itertools.combinations(names, size):
            if all(frozenset(two) in told for two in itertools.combinations(some, 2)):
                return [*some]
    return []


# --- the table ------------------------------------------------------------------------------------


def lines(rows: pd.DataFrame, unlike: pd.DataFrame) -> Iterator[str]:
    """Yield the lines of the table, with the scores in unlike flocks of the same trainings."""
    header = "level | flock-hours | entry | class | sees | score | unlike flocks | trainings"
    header += " | processor s | files"
    yield f"| {header} |"
    yield f"|{' --- |' * (header.count('|') + 1)}"
    for row in _with_unlike(rows, unlike).to_dict("records"):
        seconds = "unknown" if np.isnan(row["cpu_s"]) else f"{row['cpu_s']:.0f}"
        link = row["link"] if row["link"].startswith("http") else f"../{row['link']}"
        cells = [row["level"], row["budget"], row["entry"], row["class"], row["sees"]]
        cells += [_cell(row, "score"), _cell(row, "unlike"), row["trainings"], seconds]
        yield f"| {' | '.join(map(str, cells))} | [link]({link}) |"


def _with_unlike(rows: pd.DataFrame, unlike: pd.DataFrame) -> pd.DataFrame:
    """Return rows with the scores in unlike flocks; NaN if they are of fewer trainings."""
    if unlike.empty:
        return rows.assign(unlike=np.nan)
    same = [*KEY, "trainings"]
    return rows.astype({"budget": str}).merge(unlike.astype({"budget": str}), "left", same)


def _cell(row: dict[str, Any], name: str) -> str:
    if np.isnan(row[name]):
        return "unknown"
    return f"{row[name]:.3f} ({row[f'{name}_low']:.3f} to {row[f'{name}_high']:.3f})"


def page(rows: pd.DataFrame, text: str, unlike: pd.DataFrame) -> str:
    """Return the text of the page with the table of these rows."""
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}{chr(10).join(lines(rows, unlike))}{END}{after}"


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--entries", type=Path, default=ENTRIES)
    parser.add_argument("--out", type=Path, default=RESULTS)
    parser.add_argument("--page", type=Path, default=PAGE)
    parser.add_argument("--check", action="store_true", help="write nothing")
    options = parser.parse_args(arguments)
    given = entries(options.entries)
    # The last has all of them.
    *_, (rows, orders) = scored(given, [*LEVELS])
    if options.check:
        committed = pd.read_csv(options.out / "entries.csv", dtype=str, keep_default_na=False)
        if words := differing(rows, committed):
            sys.exit(f"Error: these rows are not what their entries score: {'; '.join(words)}")
        return
    write_table(options.out / "entries.csv", rows, FORM)
    write_table(options.out / "orders.csv", orders, FORM)
    during = level_curves.points(given, orders)
    write_table(options.out / "curves.csv", during, FORM)
    write_table(options.out / "areas.csv", level_curves.areas(during), "%.4g")
    compared = pairs(rows, orders)
    write_table(options.out / "pairs.csv", compared, "%.4g")
    stored = pd.read_csv(existing(options.out / "entries.csv"))
    unlike = resumed(options.out / "unlike.csv")
    write(options.page, page(stored, options.page.read_text("utf-8"), unlike).encode())
    print(compared.round(3).to_string(index=False))
    for key, own in compared.groupby(KEY[:2], sort=False) if len(compared) else ():
        print(f"{', '.join(key)}: each two differ of {', '.join(told_apart(own)) or 'none'}")


if __name__ == "__main__":
    run(main, resumes=False)
