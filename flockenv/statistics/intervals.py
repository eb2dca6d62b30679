"""Statistics of finished runs: means with intervals, and the straight line of figure 12."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.extras import require

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Difference", "Line", "fit_line", "mean_interval", "paired_difference", "summarize"]

CONFIDENCE = 0.95
"""Level of every interval."""

_RESAMPLES = 9999


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
        n_resamples=_RESAMPLES,
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
