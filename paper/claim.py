"""Intervals over runs, and statements of the paper judged by them: the lines of ``claims.csv``."""

import csv
import io
import math
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from study import Options, write

CONFIDENCE = 0.95

Interval = tuple[float, float, float]
"""A value and the ends of its 95 % interval."""


def student(values: Iterable[float]) -> Interval:
    """Return the mean of independent values with Student's interval; NaN ends for fewer than 2."""
    found = np.asarray(list(values), float)
    if len(found) < 2:
        return float(found.mean()) if len(found) else math.nan, math.nan, math.nan
    half = stats.t.ppf((1 + CONFIDENCE) / 2, len(found) - 1) * stats.sem(found)
    mean = float(found.mean())
    return mean, mean - float(half), mean + float(half)


def proportion(count: int, of: int) -> Interval:
    """Return a share of independent runs with the interval of Clopper and Pearson."""
    if of == 0:
        return math.nan, math.nan, math.nan
    ends = stats.binomtest(int(count), int(of)).proportion_ci(CONFIDENCE, method="exact")
    return count / of, float(ends.low), float(ends.high)


def bca(groups: Sequence[Any], statistic: Callable[..., float], resamples: int = 999) -> Interval:
    """Return a statistic of groups of runs with its BCa interval, runs resampled in each group.

    A group is an array of one value per run, or of one row per run.
    """
    arrays = [np.asarray(group, float) for group in groups]
    value = float(statistic(*arrays))
    if min(map(len, arrays)) < 3 or not math.isfinite(value):
        return value, math.nan, math.nan
    places = [np.arange(len(group)) for group in arrays]

    def of_places(*chosen: NDArray[np.int64]) -> float:
        picked = [g[np.asarray(p, int)] for g, p in zip(arrays, chosen, strict=True)]
        return float(statistic(*picked))

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = stats.bootstrap(
            places,
            of_places,
            vectorized=False,
            n_resamples=resamples,
            confidence_level=CONFIDENCE,
            method="BCa",
            rng=np.random.default_rng(0),
        ).confidence_interval
    return value, float(found.low), float(found.high)


HOLDS, FAILS = "holds", "fails"


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, judged by runs.

    Attributes
    ----------
    claim, section
        The statement, and where it stands.
    reading
        Of what runs: preset or scheme and noise, pool, number of boats.
    quantity
        What is measured, with its noise.
    found
        The value and its interval.
    runs
        How many runs it is measured in.
    least, most
        The range that the statement claims.
    """

    claim: str
    section: str
    reading: str
    quantity: str
    found: Interval
    runs: int
    least: float = -math.inf
    most: float = math.inf

    @property
    def verdict(self) -> str:
        """It holds or fails where the whole interval does; otherwise it is open.

        The runs that would decide are estimated from the distance of the value to the nearer bound,
        since an interval narrows with the root of the number of runs.
        """
        value, low, high = self.found
        if low >= self.least and high <= self.most:
            return HOLDS
        if high < self.least or low > self.most:
            return FAILS
        if not all(map(math.isfinite, self.found)):
            return "open: not measured"
        away = min(abs(value - bound) for bound in (self.least, self.most))
        outer = [abs(end - value) for end in (low, high)]
        needed = math.inf if away == 0 else self.runs * (max(outer) / away) ** 2
        return "open: more than 10000 runs" if needed > 1e4 else f"open: {math.ceil(needed)} runs"

    @property
    def claimed(self) -> str:
        """The range as a text."""
        if self.most == math.inf:
            return f">= {self.least:g}"
        return (
            f"<= {self.most:g}" if self.least == -math.inf else f"{self.least:g} to {self.most:g}"
        )


def exists(claim: str, section: str, reading: str, quantity: str, count: int, runs: int) -> Claim:
    """Return the claim that something happens, judged by existence, with its rate beside it.

    It fails where its rate is below one run in twenty.
    """
    value, low, high = proportion(count, runs)
    if count:
        return Claim(claim, section, reading, quantity, (value, max(low, 1e-9), high), runs, 1e-9)
    return Claim(claim, section, reading, quantity, (value, low, high), runs, 0.05)


_COLUMNS = (
    *("figure", "claim", "section", "reading", "quantity", "claimed"),
    *("n_runs", "measured", "low", "high", "verdict"),
)


def write_claims(options: Options, figure: str, claims: Iterable[Claim]) -> None:
    """Replace a figure's lines of ``claims.csv``."""
    path = options.out / "claims.csv"
    kept = []
    if path.exists():
        with path.open(newline="") as file:
            kept = [line for line in csv.DictReader(file) if line["figure"] != figure]
    lines = kept + [
        dict(
            zip(
                _COLUMNS,
                (
                    *(figure, each.claim, each.section, each.reading, each.quantity, each.claimed),
                    *(each.runs, *(f"{value:.3g}" for value in each.found), each.verdict),
                ),
                strict=True,
            )
        )
        for each in claims
    ]
    file = io.StringIO()
    writer = csv.DictWriter(file, _COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(sorted(lines, key=lambda line: line["figure"]))
    write(path, file.getvalue().encode())
