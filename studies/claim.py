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
    FEW,
    bootstrap_interval,
    critical_noise,
    loss_of_order,
    mean_interval,
)
from studies.store import write
from studies.study import Options, Study


class Interval(tuple[float, float, float]):
    """A value and the ends of its 95 % interval, which `runs` independent runs or seeds bear.

    `digits` of them are printed: one of a bootstrap of few runs, whose draws are coarse.
    """

    runs: int
    digits: int

    def __new__(cls, found: Iterable[float], runs: int, digits: int = 3) -> "Interval":
        interval = super().__new__(cls, found)
        interval.runs, interval.digits = runs, digits
        return interval

    def texts(self) -> list[str]:
        """Return the value and the ends as they are printed."""
        return [f"{value:.{self.digits}g}" for value in self]


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
    (..., runs, columns) and returns one of shape (...). Draws that tie, as those of few runs do,
    must tie on every machine: the last digits of a logarithm differ.
    """
    arrays = [np.asarray(group, float) for group in groups]
    runs = sum(map(len, arrays))
    if min(map(len, arrays)) < 3:
        return unknown(runs)

    def of_places(*places: Any, axis: int) -> Any:
        drawn = (g[np.asarray(p, int)] for g, p in zip(arrays, places, strict=True))
        return np.round(statistic(*drawn), _TIE)

    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # Draws without spread.
        places = [np.arange(len(g)) for g in arrays]
        found = bootstrap_interval(places, of_places, paired=False)
    return Interval(found, runs, 1 if min(map(len, arrays)) < FEW else 3)


_TIE = 9  # Decimals to which draws are the same.
HOLDS, FAILS, OPEN = "holds", "fails", "open"
OCCURS = 0.05  # What happens at all happens in at least one run in twenty, whatever was found.


@dataclass(frozen=True)
class Claim:
    """A statement, judged by runs.

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
    ours
        Whether the paper says nothing of it: a noise, a density or a quantity of our own.
    """

    claim: str
    section: str
    reading: str
    quantity: str
    found: Interval
    least: float = -math.inf
    most: float = math.inf
    ours: bool = False

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
    """Claims of one section about one reading, which may be changed between them."""

    def __init__(self, section: str, reading: str, *, ours: bool = False) -> None:
        super().__init__()
        self.section, self.reading, self.ours = section, reading, ours

    def add(
        self,
        claim: str,
        quantity: str,
        found: Interval,
        *,
        least: float = -math.inf,
        most: float = math.inf,
        n: str = "",
        ours: bool = False,
    ) -> None:
        """Add a claim; `n` is added to the reading."""
        reading = f"{self.reading}, n = {n}" if n else self.reading
        ours = ours or self.ours
        self.append(Claim(claim, self.section, reading, quantity, found, least, most, ours))

    def exists(self, claim: str, quantity: str, count: int, runs: int, *, n: str = "") -> None:
        """Add the claim that something happens: in at least one run in twenty (`OCCURS`)."""
        self.add(claim, quantity, proportion(count, runs), least=OCCURS, n=n)


_COLUMNS = (
    *("figure", "of", "claim", "section", "reading", "quantity"),
    *("least", "most", "n_runs", "measured", "low", "high", "verdict", "runs_that_would_decide"),
)


def write_claims(options: Options, figure: str, claims: Iterable[Claim]) -> None:
    """Replace a figure's lines of ``claims.csv``, and print them."""
    path, claims = options.folder / "claims.csv", list(claims)
    lines = [
        [
            *(figure, "ours" if each.ours else "paper", each.claim, each.section, each.reading),
            *(each.quantity, f"{each.least:g}", f"{each.most:g}", each.found.runs),
            *(*each.found.texts(), each.verdict, each.would_decide),
        ]
        for each in claims
    ]
    for each in claims:
        value, low, high = each.found.texts()
        print(f"{each.verdict:5}  {each.claim} [{each.reading}]")
        print(f"       {each.quantity}: {value} ({low} to {high}), claimed {each.claimed}")
    table = pd.DataFrame(lines, columns=_COLUMNS, dtype=str)
    if path.exists():
        others = pd.read_csv(path, dtype=str, keep_default_na=False)
        table = pd.concat([others[others["figure"] != figure], table])[[*_COLUMNS]]
    text = table.sort_values("figure", kind="stable").to_csv(index=False, lineterminator="\n")
    write(path, text.encode())
    print(f"{len(claims)} statements of {figure}: {path}")


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


DISORDER = 0.3
"""The paper calls a state disordered where Ψ_o is below this (figure 10)."""


def crossing(x: Sequence[float], y: Any, level: Any) -> Any:
    """Return the last x at which y falls through a level, one value for each draw.

    y has shape (len(x), draws), and the level may differ between draws. NaN where y is below it
    everywhere, and the last x where y ends above it.
    """
    draws = y.shape[1]
    found = np.full(draws, math.nan)
    for place, (each, at) in enumerate(zip(y.T, np.broadcast_to(level, draws), strict=True)):
        above = np.flatnonzero(each >= at)
        if len(above) and (last := above[-1]) == len(x) - 1:
            found[place] = x[-1]
        elif len(above):
            share = (each[last] - at) / (each[last] - each[last + 1])
            found[place] = x[last] + share * (x[last + 1] - x[last])
    return found


def disorder(
    levels_s: Sequence[float], arms: Sequence[Sequence[Any]], signs: Sequence[float] = (1.0,)
) -> Interval:
    """Return the bw in s from which on mean Ψ_o is below 0.3, or a sum of several with signs.

    An arm has a group of runs for each noise, of shape (runs, columns), Ψ_o first. Unlike the
    middle between order and disorder, a level that is fixed does not move with what the ordered
    level is, or where it ends. NaN if Ψ_o of an arm ends above it.
    """
    arrays = [[np.asarray(group, float) for group in arm] for arm in arms]
    count, runs = len(levels_s), sum(len(group) for arm in arrays for group in arm)
    if any(len(arm) != count or not arm[-1][:, 0].mean() < DISORDER for arm in arrays):
        return unknown(runs)

    def of(*drawn: Any) -> Any:
        psi_o = np.stack(np.broadcast_arrays(*(each[..., 0].mean(-1) for each in drawn)))
        found = [
            sign * crossing(levels_s, own.reshape(count, -1), DISORDER)
            for sign, own in zip(signs, np.split(psi_o, len(arrays)), strict=True)
        ]
        return np.sum(found, axis=0).reshape(psi_o.shape[1:])

    return bca([group for arm in arrays for group in arm], of)


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
