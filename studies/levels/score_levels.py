"""Score all entries of suite v3, compare them in pairs, and write the table of docs/levels.md.

    python -m studies.levels.score_levels            # scores every policy in 512 flocks
    python -m studies.levels.score_levels --check    # fails if a committed row differs by a digit
    python -m studies.levels.score_levels --no-runs  # ranks.csv and the table, from what is there

The first two simulate 17 to 68 flock-hours for each policy, thousands in all, and say so first.
Entries that the table cannot take are named, the others are scored, and the exit code is 1.

The folder results has entries.csv (the rows of `flockenv compare --suite v3`), orders.csv (the
signed order of every flock), curves.csv and areas.csv (what was learned during the trainings, as
their files say), ranks.csv and pairs.csv. ranks.csv has the rank correlation of the entries of 30
flock-hours between the first level and each other one. Its 95 % interval are percentiles of a
bootstrap over each entry's trainings. For each pair of entries with a level and a budget in common,
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
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy import stats

from flockenv.comparison.levels import LEVELS
from flockenv.comparison.report import overlap_notes
from flockenv.comparison.suite_entry import SuiteEntry, scored
from flockenv.errors import FlockError
from flockenv.flock import STEP_STATISTICS
from flockenv.runs.store import RESULTS_VERSION
from flockenv.statistics import CONFIDENCE, bootstrap_interval, two_way_interval
from studies.levels import level_curves
from studies.store import StudyError, check_version, existing, resumed, write, write_table
from studies.study import run
from studies.suite.compare_grid import holm

HERE = Path(__file__).parent
ENTRIES, RESULTS = HERE / "entries", HERE / "results"
PAGE = HERE.parents[1] / "docs" / "levels.md"
BEGIN, END = "<!-- entries -->\n\n", "\n\n<!-- end -->"
TABLES = ("entries.csv", "orders.csv", "pairs.csv", "ranks.csv")
CURVES = ("curves.csv", "areas.csv")
"""Tables of what was measured during the trainings, in the results version of the trainings."""
FORM = "%.6g"
KEY = ["level", "budget", "entry"]


def entries(folder: Path) -> list[SuiteEntry]:
    """Return the entries of a folder that the table takes."""
    return [*entered(folder)[0].values()]


def entered(folder: Path) -> tuple[dict[Path, SuiteEntry], list[str]]:
    """Return the entries of a folder by their files, and why others are refused.

    Policies that execute code when they are read are refused, too.
    """
    found, refused = {}, []
    for path in sorted(folder.glob("*.toml")):
        try:
            found[path] = SuiteEntry.from_file(path)
        except FlockError as error:
            refused.append(str(error))
    if not found:
        words = "; ".join(refused) or "studies.levels.train_levels makes some"
        raise StudyError(f"{folder} holds no entry: {words}")
    return found, refused


def named_at_the_end(refused: Sequence[str]) -> None:
    """End with exit code 1 if entries were refused."""
    if refused:
        sys.exit(f"Error: not in the table: {'; '.join(refused)}")


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


# --- ranks of levels ------------------------------------------------------------------------------


def rank_correlation(first: Sequence[Any], second: Sequence[Any]) -> Any:
    """Return the rank correlation (Spearman) of two numbers of each entry, along the first axis."""
    places = (stats.rankdata(each, axis=0) for each in (first, second))
    ours, theirs = (each - each.mean(axis=0) for each in places)
    return (ours * theirs).sum(0) / np.sqrt((ours**2).sum(0) * (theirs**2).sum(0))


def ranks(orders: pd.DataFrame, budget: str = "30") -> pd.DataFrame:
    """Return how alike entries rank in the first level and in each other one.

    Orders of a level and its scores rank alike. Trainings of two levels are drawn separately.
    """
    means: dict[str, dict[str, np.ndarray]] = {}
    for (level, _, name), own in orders[orders["budget"] == budget].groupby(KEY, sort=False):
        means.setdefault(level, {})[name] = led(own).mean(axis=1)
    first, *others = (name for name in LEVELS if name in means)
    rows = []
    for level in others:
        both = [name for name in means[first] if name in means[level]]
        if len(both) < 3:
            continue

        def of(*drawn: np.ndarray, axis: int = -1, count: int = len(both)) -> Any:
            found = [each.mean(axis) for each in drawn]
            return rank_correlation(found[:count], found[count:])

        drawn = [means[name][entry] for name in (first, level) for entry in both]
        rows.append([level, first, len(both), float(of(*drawn)), *percentiles(drawn, of)])
    names = ["level", "compared_with", "entries", "rank_correlation", "low", "high"]
    return pd.DataFrame(rows, columns=names)


def percentiles(samples: Sequence[np.ndarray], of: Callable[..., Any]) -> tuple[float, float]:
    """Return the ends of the 95 % interval of a statistic that cannot exceed 1.

    Near 1 the correction of `bootstrap_interval` would move both ends up to it.
    """
    found = stats.bootstrap(
        samples,
        of,
        confidence_level=CONFIDENCE,
        method="percentile",
        rng=np.random.default_rng(0),
    )
    return tuple(found.confidence_interval)


# --- the table ------------------------------------------------------------------------------------


def lines(rows: pd.DataFrame) -> Iterator[str]:
    """Yield the lines of the table, of rows that `joined` returns."""
    header = "level | flock-hours | entry | class | sees | score | unlike flocks | area"
    header += " | trainings | processor s | files"
    yield f"| {header} |"
    yield f"|{' --- |' * (header.count('|') + 1)}"
    for row in rows.to_dict("records"):
        seconds = "unknown" if np.isnan(row["cpu_s"]) else f"{row['cpu_s']:.0f}"
        area = "unknown" if np.isnan(row["area"]) else f"{row['area']:.3f}"
        cells = [row["level"], row["budget"], row["entry"], row["class"], row["sees"]]
        cells += [_cell(row, "score"), _cell(row, "unlike"), area, row["trainings"], seconds]
        yield f"| {' | '.join(map(str, cells))} | {row['files']} |"


def joined(results: Path, given: Mapping[Path, SuiteEntry], page: Path) -> pd.DataFrame:
    """Return the committed rows with all that the table says, beside their scores.

    Scores in unlike flocks and areas are NaN if they are of fewer trainings. Files are linked from
    the page.
    """
    same = [*KEY, "trainings"]
    table = pd.read_csv(existing(results / "entries.csv"), dtype={"budget": str})
    kept = {"dtype": {"budget": str}}
    unlike = resumed(results / "unlike.csv", **kept)
    # Areas were measured during the trainings, whose results version may be an earlier one.
    path = existing(results / "areas.csv")
    areas = pd.read_csv(path, **kept) if path.exists() else pd.DataFrame()
    for other, columns in ((unlike, ["unlike", "unlike_low", "unlike_high"]), (areas, ["area"])):
        if other.empty:
            table = table.assign(**dict.fromkeys(columns, np.nan))
        else:
            table = table.merge(other[[*same, *columns]], "left", same)
    files = [
        [level, entry.budget, entry.name, len(own), _files(path, entry, level, page)]
        for path, entry in given.items()
        for level, own in entry.trainings.items()
    ]
    return table.merge(pd.DataFrame(files, columns=[*same, "files"]), "inner", same)


def _files(path: Path, entry: SuiteEntry, level: str, page: Path) -> str:
    """Return links to an entry and to what made it, with the commits that its policies name."""
    made = {each.provenance.get("commit", "unknown") for each in entry.trainings[level]}
    link = entry.link if entry.link.startswith("http") else f"../{entry.link}"
    toml = Path(os.path.relpath(path, page.parent)).as_posix()
    return f"[entry]({toml}), [code]({link}) of {', '.join(sorted(made))}"


def _cell(row: dict[str, Any], name: str) -> str:
    if np.isnan(row[name]):
        return "unknown"
    return f"{row[name]:.3f} ({row[f'{name}_low']:.3f} to {row[f'{name}_high']:.3f})"


def write_page(page: Path, results: Path, given: Mapping[Path, SuiteEntry]) -> None:
    """Write the table into the page, from the committed results."""
    before, _, rest = page.read_text("utf-8").partition(BEGIN)
    _, _, after = rest.partition(END)
    table = "\n".join(lines(joined(results, given, page)))
    write(page, f"{before}{BEGIN}{table}{END}{after}".encode())


def flock_hours(given: Iterable[SuiteEntry]) -> tuple[int, float]:
    """Return how many policies are scored, and what they simulate beside the references."""
    led = [(len(own), LEVELS[name]) for each in given for name, own in each.trainings.items()]
    return sum(count for count, _ in led), sum(count * each.flock_hours() for count, each in led)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--entries", type=Path, default=ENTRIES)
    parser.add_argument("--out", type=Path, default=RESULTS)
    parser.add_argument("--page", type=Path, default=PAGE)
    parser.add_argument("--check", action="store_true", help="write nothing")
    parser.add_argument("--no-runs", action="store_true", help="score nothing")
    options = parser.parse_args(arguments)
    given, refused = entered(options.entries)
    if not options.no_runs:
        has_curves = level_curves.trained_in(given.values()) <= {str(RESULTS_VERSION)}
        for name in (*TABLES, *(CURVES if has_curves else ())):
            check_version(options.out / name)
        refused += score(
            [*given.values()], options.out, is_checked=options.check, has_curves=has_curves
        )
    if not options.check:
        orders = pd.read_csv(existing(options.out / "orders.csv"), dtype={"budget": str})
        write_table(options.out / "ranks.csv", ranks(orders), "%.4f")
        write_page(options.page, options.out, given)
    named_at_the_end(refused)


def score(
    given: Sequence[SuiteEntry], out: Path, *, is_checked: bool, has_curves: bool
) -> list[str]:
    """Score entries, and write what follows or compare their rows with those that there are.

    Return why entries have no row. With `has_curves` their trainings are of this results version.
    """
    count, hours = flock_hours(given)
    print(f"{count} policies lead {hours:.0f} flock-hours", file=sys.stderr, flush=True)
    # The last has all of them.
    *_, (rows, flocks, broken) = scored(given, [*LEVELS])
    for line in overlap_notes(flocks):
        print(line, file=sys.stderr, flush=True)
    if is_checked:
        committed = pd.read_csv(out / "entries.csv", dtype=str, keep_default_na=False)
        if words := differing(rows, committed):
            sys.exit(f"Error: these rows are not what their entries score: {'; '.join(words)}")
        return [*broken]
    orders = flocks.drop(columns=[*STEP_STATISTICS])
    write_table(out / "entries.csv", rows, FORM)
    write_table(out / "orders.csv", orders, FORM)
    if has_curves:
        during = level_curves.points(given, orders)
        write_table(out / "curves.csv", during, FORM)
        write_table(out / "areas.csv", level_curves.areas(during), "%.4g")
    else:
        print("Trainings are of another results version: curves.csv and areas.csv stay")
    compared = pairs(rows, orders)
    write_table(out / "pairs.csv", compared, "%.4g")
    print(compared.round(3).to_string(index=False))
    for key, own in compared.groupby(KEY[:2], sort=False) if len(compared) else ():
        print(f"{', '.join(key)}: each two differ of {', '.join(told_apart(own)) or 'none'}")
    return [*broken]


if __name__ == "__main__":
    run(main, resumes=False)
