"""Intervals at one level: of means, of differences, and of any statistic of independent runs.

The mean of few values has Student's interval and that of more a BCa bootstrap (`mean_interval`).
`bootstrap_interval` takes any statistic. `statistics.block_bootstrap` resamples time averages.
"""

import math
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv._io.extras import require

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "CONFIDENCE",
    "FEW",
    "RESAMPLES",
    "Difference",
    "bootstrap_interval",
    "crossed_replicates",
    "interval",
    "mean_interval",
    "paired_difference",
    "percentile_ends",
    "student_interval",
    "summarize",
]

CONFIDENCE = 0.95
"""Level of every interval."""

FEW = 12
"""Below so many values a mean has Student's interval: BCa intervals hold the mean of 4, 8 and 12
normal values 80, 89 and 93 times of 100."""

_BCA_RESAMPLES = 9999

RESAMPLES = 499
"""How many times values, and blocks and runs, are drawn."""


@dataclass(frozen=True, slots=True)
class Difference:
    """How much one policy exceeds another on the same seeds.

    Attributes
    ----------
    mean, low, high : float
        Mean difference and its interval at level `CONFIDENCE`, that of `mean_interval`.
    effect : float
        Cohen's d of paired differences: mean over standard deviation; NaN without spread.
    n : int
        Number of pairs.
    """

    mean: float
    low: float
    high: float
    effect: float
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
    return Difference(mean, low, high, effect, len(differences))


def mean_interval(values: Iterable[float], seed: int = 0) -> tuple[float, float, float]:
    """Return the mean of independent runs with its interval at level `CONFIDENCE`.

    The interval is Student's for fewer than `FEW` values, and a BCa bootstrap of 9999 resamples
    with this seed for more.

    Returns
    -------
    tuple of float
        Mean, lower and upper end; the ends are NaN for a single value, all are where a value is.

    Raises
    ------
    ValueError
        Without values.
    """
    data = np.asarray(list(values), float)
    if len(data) == 0:
        raise ValueError("there are no values to average")
    if np.isnan(data).any():
        return math.nan, math.nan, math.nan
    if np.ptp(data) == 0.0 and len(data) > 1:
        return float(data[0]), float(data[0]), float(data[0])
    return student_interval(data) if len(data) < FEW else bootstrap_interval([data], np.mean, seed)


def bootstrap_interval(
    samples: Sequence[ArrayLike],
    statistic: Callable[..., Any],
    seed: int = 0,
    *,
    paired: bool = True,
) -> tuple[float, float, float]:
    """Return a statistic of independent runs with its BCa bootstrap interval (Efron 1987).

    Parameters
    ----------
    samples
        One array or more of values, one value per run.
    statistic
        A function of as many arrays that takes ``axis``, such as `numpy.mean`.
    seed
        Of the draws, 9999 of them.
    paired
        Whether values at the same place of several arrays belong to one run, and are drawn
        together; otherwise runs are drawn out of each array apart.

    Returns
    -------
    tuple of float
        The value and the ends at level `CONFIDENCE`; the ends are NaN for a single run. With
        fewer than `FEW` runs they are too narrow.
    """
    data = tuple(np.asarray(each, np.float64) for each in samples)
    value = float(statistic(*data, axis=-1))
    if min(map(len, data)) < 2:
        return value, math.nan, math.nan
    bootstrap = partial(
        require("scipy.stats", "plot").bootstrap,
        data,
        statistic,
        paired=paired,
        confidence_level=CONFIDENCE,
    )
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        found = bootstrap(n_resamples=_BCA_RESAMPLES, rng=np.random.default_rng(seed))
    if np.isnan(found.confidence_interval).any():  # To leave out no run changes the statistic.
        found = bootstrap(n_resamples=0, bootstrap_result=found, method="percentile")
    low, high = found.confidence_interval
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
