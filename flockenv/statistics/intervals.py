"""Intervals: of means of independent runs, of time averages, and of a straight line.

Independent values have a BCa bootstrap (`mean_interval`, `paired_difference`), a percentile
bootstrap (`mean_replicates`, `grouped_replicates`, `crossed_replicates`, then `interval`), or,
where they are few, Student's interval. `statistics.block_bootstrap` resamples time averages.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.extras import require

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "CONFIDENCE",
    "RESAMPLES",
    "Difference",
    "Line",
    "crossed_replicates",
    "fit_line",
    "grouped_replicates",
    "interval",
    "mean_interval",
    "mean_replicates",
    "paired_difference",
    "percentile_ends",
    "student_interval",
    "summarize",
]

CONFIDENCE = 0.95
"""Level of every interval."""

_BCA_RESAMPLES = 9999

RESAMPLES = 499
"""How many times values, and blocks and runs, are drawn."""


@dataclass(frozen=True, slots=True)
class Line:
    """A straight line fitted by least squares, and the F-test of figure 12.

    Attributes
    ----------
    slope, intercept : float
        In units of y over x, and of y.
    f : float
        F statistic with 1 and n - 2 degrees of freedom, against no linear dependence; NaN where
        all y are the same.
    p : float
        Probability of such an F or a larger one if y did not depend on x; NaN likewise.
    n : int
        Number of points.
    """

    slope: float
    intercept: float
    f: float
    p: float
    n: int

    def __str__(self) -> str:
        if math.isnan(self.f):
            return f"{self.intercept:.3f} in all {self.n} runs: no line to fit"
        sign = "-" if self.slope < 0 else "+"
        return (
            f"{self.intercept:.3f} {sign} {abs(self.slope):.4f} k (F = {self.f:.2f}, "
            f"p = {self.p:.2g}, {self.n} runs)"
        )


@dataclass(frozen=True, slots=True)
class Difference:
    """How much one policy exceeds another on the same seeds.

    Attributes
    ----------
    mean, low, high : float
        Mean difference and its bootstrap interval at level `CONFIDENCE`.
    effect : float
        Cohen's d of paired differences: mean over standard deviation; NaN without spread.
    ratio, ratio_low, ratio_high : float
        Ratio of the means and its paired bootstrap interval; NaN where the interval of
        the mean that divides is not above zero.
    n : int
        Number of pairs.
    """

    mean: float
    low: float
    high: float
    effect: float
    ratio: float
    ratio_low: float
    ratio_high: float
    n: int


def paired_difference(ours: Iterable[float], theirs: Iterable[float], seed: int = 0) -> Difference:
    """Compare two policies seed by seed.

    Parameters
    ----------
    ours, theirs
        One value a seed, in the same order.
    seed
        Seed of the bootstrap.

    Raises
    ------
    ValueError
        For different numbers of values.
    """
    ours, theirs = np.asarray(list(ours), float), np.asarray(list(theirs), float)
    if ours.shape != theirs.shape:
        raise ValueError(f"{len(ours)} and {len(theirs)} values are no pairs")
    differences = ours - theirs
    mean, low, high = mean_interval(differences, seed)
    spread = float(differences.std(ddof=1)) if len(differences) > 1 else 0.0
    effect = mean / spread if spread > 0.0 else math.nan
    _, least, _ = mean_interval(theirs, seed)
    ratio = (math.nan,) * 3
    if np.array_equal(ours, theirs) and least > 0.0:
        ratio = (1.0, 1.0, 1.0)
    elif least > 0.0:
        ratio = _interval((ours, theirs), _ratio_of_means, seed)
    return Difference(mean, low, high, effect, *ratio, len(differences))


def _ratio_of_means(ours: NDArray[Any], theirs: NDArray[Any], axis: int = -1) -> NDArray[Any]:
    ratio: NDArray[Any] = ours.mean(axis) / theirs.mean(axis)
    return ratio


def fit_line(x: Iterable[float], y: Iterable[float]) -> Line:
    """Fit y = intercept + slope x, one point a run.

    Raises
    ------
    ValueError
        For fewer than three points or a single x.
    """
    stats = require("scipy.stats", "plot")
    x, y = np.asarray(list(x), float), np.asarray(list(y), float)
    if len(x) < 3 or np.ptp(x) == 0.0:
        raise ValueError("a line needs at least three points at two different x")
    if np.ptp(y) == 0.0:
        return Line(0.0, float(y[0]), math.nan, math.nan, len(x))
    fit = stats.linregress(x, y)
    unexplained = 1.0 - fit.rvalue**2
    f = fit.rvalue**2 / unexplained * (len(x) - 2) if unexplained > 0 else np.inf
    return Line(float(fit.slope), float(fit.intercept), float(f), float(fit.pvalue), len(x))


def mean_interval(values: Iterable[float], seed: int = 0) -> tuple[float, float, float]:
    """Mean of independent runs with its bootstrap interval at level `CONFIDENCE`.

    Returns
    -------
    tuple of float
        Mean, lower and upper end (BCa bootstrap, 9999 resamples; NaN ends for a single value).
    """
    data = np.asarray(list(values), float)
    if np.ptp(data) == 0.0 and len(data) > 1:
        return float(data[0]), float(data[0]), float(data[0])
    return _interval((data,), np.mean, seed)


def _interval(
    samples: tuple[NDArray[Any], ...], statistic: Callable[..., Any], seed: int
) -> tuple[float, float, float]:
    stats = require("scipy.stats", "plot")
    value = float(statistic(*samples))
    if len(samples[0]) < 2:
        return value, math.nan, math.nan
    result = stats.bootstrap(
        samples,
        statistic,
        paired=True,
        confidence_level=CONFIDENCE,
        n_resamples=_BCA_RESAMPLES,
        rng=np.random.default_rng(seed),
    )
    low, high = result.confidence_interval
    return value, float(low), float(high)


def summarize(runs: "pd.DataFrame", by: list[str], quantities: list[str]) -> "pd.DataFrame":
    """Means and intervals of quantities in groups of runs.

    Parameters
    ----------
    runs
        One row per run.
    by
        Columns that form the groups.
    quantities
        Columns to average.

    Returns
    -------
    pandas.DataFrame
        One row a group: ``runs`` (their number) and, for each quantity, ``<q>``, ``<q>_low`` and
        ``<q>_high``.
    """
    pandas = require("pandas", "plot")
    rows = []
    for key, group in runs.groupby(by, sort=False):
        row = dict(zip(by, key, strict=True)) | {"runs": len(group)}
        for quantity in quantities:
            mean, low, high = mean_interval(group[quantity])
            row |= {quantity: mean, f"{quantity}_low": low, f"{quantity}_high": high}
        rows.append(row)
    means: pd.DataFrame = pandas.DataFrame(rows)
    return means


def percentile_ends(
    values: NDArray[np.float64], axis: int = -1
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the ends of the percentile interval of replicates, along an axis."""
    tail = (1 - CONFIDENCE) / 2
    low, high = np.quantile(values, [tail, 1 - tail], axis=axis)
    return low, high


def mean_replicates(values: NDArray[np.float64], seed: int = 0) -> NDArray[np.float64]:
    """Return the mean of independent values as they are, then of resampled values.

    Returns
    -------
    float64 array, shape (RESAMPLES + 1,)
        As `interval` takes it.
    """
    places = np.random.default_rng(seed).integers(0, len(values), (RESAMPLES, len(values)))
    return np.append(values.mean(), values[places].mean(axis=1))


def grouped_replicates(
    groups: Sequence[NDArray[np.int64]],
    statistic: Callable[[NDArray[np.int64]], float],
    seed: int = 0,
) -> NDArray[np.float64]:
    """Return a statistic of rows as they are, then of rows resampled within each group.

    Parameters
    ----------
    groups
        For each group the places of its rows.
    statistic
        A function of the places of rows.
    seed
        Of the draws.

    Returns
    -------
    float64 array, shape (RESAMPLES + 1,)
        As `interval` takes it.
    """
    rng = np.random.default_rng(seed)
    values = [statistic(np.sort(np.concatenate(groups)))]
    for _ in range(RESAMPLES):
        values.append(statistic(np.concatenate([rng.choice(rows, len(rows)) for rows in groups])))
    return np.array(values)


def crossed_replicates(values: NDArray[np.float64], seed: int = 0) -> NDArray[np.float64]:
    """Return the mean of a table as it is, then with rows and columns resampled.

    Rows may be trainings with different seeds and columns the flocks that all of them are judged
    by: rows are drawn out of the rows, and apart from them columns out of the columns, since a
    flock that is hard is so for all rows. With few rows the interval is too narrow.

    Parameters
    ----------
    values
        Shape (rows, columns).
    seed
        Of the draws.

    Returns
    -------
    float64 array, shape (RESAMPLES + 1,)
        As `interval` takes it.
    """
    rng, shares = np.random.default_rng(seed), []
    for count in values.shape:
        shares.append(rng.multinomial(count, np.full(count, 1 / count), RESAMPLES) / count)
    rows, columns = shares
    return np.append(values.mean(), ((rows @ values) * columns).sum(axis=1))


def student_interval(values: NDArray[np.float64]) -> tuple[float, float, float]:
    """Return the mean of a few independent values with Student's interval; NaN ends for one."""
    mean, count = float(values.mean()), len(values)
    if count < 2:
        return mean, math.nan, math.nan
    stats = require("scipy.stats", "plot")
    quantile = float(stats.t.ppf((1 + CONFIDENCE) / 2, count - 1))
    half = quantile * float(values.std(ddof=1)) / count**0.5
    return mean, mean - half, mean + half


def interval(replicates: NDArray[np.float64]) -> tuple[float, float, float]:
    """Return the first value, as measured, and the percentile interval of the others.

    Parameters
    ----------
    replicates
        Shape (resamples + 1,), of a quantity derived from `block_sums_resampled`. Draws in which it
        is undefined (NaN) are left out, and if they are more than half, so are the ends.
    """
    drawn = replicates[1:]
    drawn = drawn[np.isfinite(drawn)]
    if len(drawn) < len(replicates) / 2:
        return float(replicates[0]), float("nan"), float("nan")
    low, high = percentile_ends(drawn)
    return float(replicates[0]), float(low), float(high)
