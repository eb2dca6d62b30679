"""Compare the algorithms of the suite's grid with each other, over their trainings.

    python -m studies.suite.compare_grid    # from results/grid-100.csv, some seconds

A row of the grid compares one cell with the tuned law, and its interval holds the luck of 120
flocks that all policies share. Between algorithms that luck mostly cancels. Each training counts
once, by its interquartile mean; an algorithm has 15, five seeds with each of three inputs. Chosen
after the grid had been seen:

- Whether algorithms differ: the one-way F, with p by permutations of the trainings among the
  algorithms, within each input.
- Which differ: the difference of their means, with p by permutations within each input, and with
  p of Holm's correction for all pairs.

The answers hold for these 120 flocks and one setting of each algorithm. The folder results
has
grid-100-algorithms.csv (means with their standard errors, and the spread over seeds with the same
input) and grid-100-pairs.csv.
"""

import argparse
import itertools
from pathlib import Path

import numpy as np
import pandas as pd

from studies.store import version_of, write_table
from studies.study import run

PERMUTATIONS = 9999


def f_statistic(values: np.ndarray, algorithm: np.ndarray) -> float:
    """Return the one-way F: variance between the algorithms over that within them."""
    groups = [values[algorithm == name] for name in np.unique(algorithm)]
    between = sum(len(each) * (each.mean() - values.mean()) ** 2 for each in groups)
    within = sum(((each - each.mean()) ** 2).sum() for each in groups)
    return float(between / (len(groups) - 1) / (within / (len(values) - len(groups))))


def difference(values: np.ndarray, algorithm: np.ndarray) -> float:
    """Return the absolute difference of the means of two algorithms."""
    first, second = (values[algorithm == name].mean() for name in np.unique(algorithm))
    return float(abs(first - second))


def permuted(trainings: pd.DataFrame, statistic: object, seed: int = 0) -> tuple[float, float]:
    """Return a statistic of trainings, and how often one as large comes by permutation.

    Trainings change places among the algorithms with the same input.
    """
    assert callable(statistic)
    random, values = np.random.default_rng(seed), trainings["iqm"].to_numpy(float)
    algorithm = trainings["algorithm"].to_numpy(str)
    inputs = [np.flatnonzero(trainings["input"] == name) for name in trainings["input"].unique()]
    found, reached = statistic(values, algorithm), 1
    for _ in range(PERMUTATIONS):
        drawn = values.copy()
        for places in inputs:
            drawn[places] = values[random.permutation(places)]
        reached += statistic(drawn, algorithm) >= found * (1.0 - 1e-12)
    return found, reached / (PERMUTATIONS + 1)


def holm(p: np.ndarray) -> np.ndarray:
    """Return p corrected for as many tests (Holm 1979)."""
    order = np.argsort(p, kind="stable")
    corrected = np.empty(len(p))
    factors = len(p) - np.arange(len(p))
    corrected[order] = np.minimum(1.0, np.maximum.accumulate(factors * p[order]))
    return corrected


def means(trainings: pd.DataFrame) -> pd.DataFrame:
    """Return the mean of each algorithm, its standard error, and the spread of its seeds."""
    rows = []
    for name, own in trainings.groupby("algorithm", sort=False):
        spread = np.sqrt(own.groupby("input")["iqm"].var().mean())
        row = {"algorithm": name, "trainings": len(own), "iqm": own["iqm"].mean()}
        row |= {"standard_error": own["iqm"].sem(), "spread_of_seeds": spread}
        rows.append(row)
    return pd.DataFrame(rows).sort_values("iqm", ascending=False)


def pairs(trainings: pd.DataFrame) -> pd.DataFrame:
    """Return the difference of each pair of algorithms, the better one first."""
    ranked = means(trainings).set_index("algorithm")["iqm"]
    rows = []
    for better, worse in itertools.combinations(ranked.index, 2):
        own = trainings[trainings["algorithm"].isin((better, worse))]
        row = {"better": better, "worse": worse, "difference": ranked[better] - ranked[worse]}
        rows.append(row | {"p": permuted(own, difference)[1]})
    return pd.DataFrame(rows).assign(p_of_all_pairs=lambda each: holm(each["p"].to_numpy()))


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--grid", type=Path, default=Path("studies/suite/results/grid-100.csv"))
    options = parser.parse_args(arguments)
    grid = pd.read_csv(options.grid)
    trainings = grid[grid["seed"] != "all"].reset_index(drop=True)
    f, p = permuted(trainings, f_statistic)
    print(f"one-way F = {f:.1f}, p = {p:.4f}, {len(trainings)} trainings")
    for name, table in (("algorithms", means(trainings)), ("pairs", pairs(trainings))):
        path = options.grid.with_name(f"{options.grid.stem}-{name}.csv")
        write_table(path, table, "%.4g", version_of(options.grid))
        print(table.round(4).to_string(index=False))


if __name__ == "__main__":
    run(main, resumes=False)
