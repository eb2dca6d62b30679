"""Intervals over runs, and statements of the paper judged by them: the lines of ``claims.csv``."""

import math
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from scipy import stats

from flockenv.statistics import (
    CONFIDENCE,
    bootstrap_interval,
    critical_noise,
    loss_of_order,
    mean_interval,
)
from studies.study import Options, Study, write


class Interval(tuple[float, float, float]):
    """A value and the ends of its 95 % interval, which `runs` independent runs or seeds bear."""

    runs: int

    def __new__(cls, found: Iterable[float], runs: int) -> "Interval":
        interval = super().__new__(cls, found)
        interval.runs = runs
        return interval


def unknown(runs: int = 0) -> Interval:
    """Return an interval of something that was not measured."""
    return Interval((math.nan, math.nan, math.nan), runs)


def mean(values: Iterable[float]) -> Interval:
    """Return the mean of independent runs with its interval; NaN for no runs."""
    found = np.asarray(list(values), float)
    return Interval(mean_interval(found), len(found)) if len(found) else unknown()


def proportion(count: int, of: int) -> Interval:
    """Return a share of independent runs with the interval of Clopper and Pearson."""
    if of == 0:
        return unknown()
    ends = stats.binomtest(int(count), int(of)).proportion_ci(CONFIDENCE, method="exact")
    return Interval((count / of, float(ends.low), float(ends.high)), int(of))


def bca(groups: Sequence[Any], statistic: Callable[..., Any]) -> Interval:
    """Return a statistic of groups of runs with its BCa interval, runs drawn in each group apart.

    Each group is an array of shape (runs, columns). The statistic takes arrays of shape
    (..., runs, columns) and returns one of shape (...).
    """
    arrays = [np.asarray(group, float) for group in groups]
    runs = sum(map(len, arrays))
    if min(map(len, arrays)) < 3:
        return unknown(runs)

    def of_places(*places: Any, axis: int) -> Any:
        return statistic(*(g[np.asarray(p, int)] for g, p in zip(arrays, places, strict=True)))

    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # Draws without spread.
        places = [np.arange(len(g)) for g in arrays]
        return Interval(bootstrap_interval(places, of_places, paired=False), runs)


HOLDS, FAILS, OPEN = "holds", "fails", "open"
OCCURS = 0.05  # What happens at all happens in at least one run in twenty, whatever was found.


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
        The value and its interval, with the number of runs that bear it.
    least, most
        The range that the statement claims.
    """

    claim: str
    section: str
    reading: str
    quantity: str
    found: Interval
    least: float = -math.inf
    most: float = math.inf

    @property
    def verdict(self) -> str:
        """It holds or fails where the whole interval does; otherwise it is open."""
        _, low, high = self.found
        if low >= self.least and high <= self.most:
            return HOLDS
        return FAILS if high < self.least or low > self.most else OPEN

    @property
    def would_decide(self) -> str:
        """About how many runs would decide an open statement.

        Estimated from the distance of the value to the nearer bound, since an interval narrows with
        the root of the number of runs. Empty for a statement that is decided or not measured.
        """
        value, low, high = self.found
        if self.verdict != OPEN or not all(map(math.isfinite, self.found)):
            return ""
        away = min(abs(value - bound) for bound in (self.least, self.most))
        outer = max(abs(end - value) for end in (low, high))
        needed = math.inf if away == 0 else self.found.runs * (outer / away) ** 2
        return "more than 10000" if needed > 1e4 else str(math.ceil(needed))

    @property
    def claimed(self) -> str:
        """The range as a text."""
        if self.most == math.inf:
            return f">= {self.least:g}"
        return (
            f"<= {self.most:g}" if self.least == -math.inf else f"{self.least:g} to {self.most:g}"
        )


class Claims(list[Claim]):
    """Claims of one section about one reading."""

    def __init__(self, section: str, reading: str) -> None:
        super().__init__()
        self.section, self.reading = section, reading

    def add(
        self,
        claim: str,
        quantity: str,
        found: Interval,
        *,
        least: float = -math.inf,
        most: float = math.inf,
        n: str = "",
    ) -> None:
        """Add a claim; `n` is added to the reading."""
        reading = f"{self.reading}, n = {n}" if n else self.reading
        self.append(Claim(claim, self.section, reading, quantity, found, least, most))

    def exists(self, claim: str, quantity: str, count: int, runs: int, *, n: str = "") -> None:
        """Add the claim that something happens: in at least one run in twenty (`OCCURS`)."""
        self.add(claim, quantity, proportion(count, runs), least=OCCURS, n=n)


_COLUMNS = (
    *("figure", "claim", "section", "reading", "quantity", "claimed"),
    *("n_runs", "measured", "low", "high", "verdict", "runs_that_would_decide"),
)


def write_claims(options: Options, figure: str, claims: Iterable[Claim]) -> None:
    """Replace a figure's lines of ``claims.csv``."""
    path = options.folder / "claims.csv"
    lines = [
        [
            *(figure, each.claim, each.section, each.reading, each.quantity, each.claimed),
            *(each.found.runs, *(f"{value:.3g}" for value in each.found)),
            *(each.verdict, each.would_decide),
        ]
        for each in claims
    ]
    table = pd.DataFrame(lines, columns=_COLUMNS, dtype=str)
    if path.exists():
        others = pd.read_csv(path, dtype=str, keep_default_na=False)
        table = pd.concat([others[others["figure"] != figure], table])
    text = table.sort_values("figure", kind="stable").to_csv(index=False, lineterminator="\n")
    write(path, text.encode())


def judging(
    figure: str,
    study: Study,
    judge: Callable[[pd.DataFrame], Iterable[Claim]],
    draw: Callable[[Options, pd.DataFrame], None],
) -> Callable[[Options], None]:
    """Return the script of a file that makes, judges and draws the runs of a study."""

    def script(options: Options) -> None:
        if len(table := study.results(options)):
            write_claims(options, figure, judge(table))
            draw(options, table)

    script.__module__ = judge.__module__
    return script


def critical_bw(levels_s: Sequence[float], groups: Sequence[Any]) -> Interval:
    """Return the bw in s at which order is lost, as `flockenv.statistics.critical_noise`."""
    return Interval(critical_noise(levels_s, groups), sum(map(len, groups)))


def fall(levels_s: Sequence[float], groups: Sequence[Any]) -> Any:
    """Return the loss of order of groups of shape (..., runs, 2), one value for each draw."""
    psi_o, abs_m = (
        np.stack(np.broadcast_arrays(*(each[..., column].mean(-1) for each in groups)))
        for column in (0, 1)
    )
    return loss_of_order(levels_s, psi_o, abs_m)
