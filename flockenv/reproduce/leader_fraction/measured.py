"""What `leader-fraction` measures: the proportion of leaders at which a flock is guided."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import isotonic_regression
from scipy.stats import chi2

from flockenv.recording import Recording
from flockenv.statistics.intervals import RESAMPLES, mean_replicates

__all__ = ["GUIDED", "Curve", "exponent", "guiding_fraction", "line_p"]

GUIDED = 0.5
"""Mean signed order from which a flock counts as guided."""


def guiding_fraction(fractions: NDArray[np.float64], signed_order: NDArray[np.float64]) -> float:
    """Return the proportion of leaders at which the signed order reaches `GUIDED`.

    The signed order is made to grow with the proportion by isotonic regression, and then
    interpolated in the logarithm of the proportion.

    Parameters
    ----------
    fractions
        Shape (k,): proportions of leaders, increasing.
    signed_order
        Shape (k,): mean signed order at each.

    Returns
    -------
    float
        NaN where the signed order is below or above `GUIDED` at all of the proportions.
    """
    rising = np.asarray(isotonic_regression(signed_order).x)
    if not rising[0] < GUIDED <= rising[-1]:
        return math.nan
    above = int(np.argmax(rising >= GUIDED))
    low, high = rising[above - 1], rising[above]
    share = (GUIDED - low) / (high - low)
    logs = np.log(fractions)
    return float(np.exp(logs[above - 1] + share * (logs[above] - logs[above - 1])))


@dataclass(frozen=True, slots=True)
class Curve:
    """Signed order against the number of leaders, in flocks of one size under one policy.

    Attributes
    ----------
    n_boats : int
        Size of the flocks.
    signed_order : mapping of float64 arrays, shape (runs,)
        By number of leaders: mean signed order over the second half of each run.
    replicates : float64 array, shape (RESAMPLES + 1,)
        `guiding_fraction` as measured, and of runs resampled for each number of leaders.
    drift : float64 array, shape (runs of all numbers of leaders,)
        Mean signed order over the last quarter of each run, minus that over the third.
    """

    n_boats: int
    signed_order: Mapping[int, NDArray[np.float64]]
    replicates: NDArray[np.float64]
    drift: NDArray[np.float64]

    @classmethod
    def of_runs(
        cls, n_boats: int, runs: Mapping[int, Sequence[Recording]], draws_seed: int
    ) -> "Curve":
        """Return the curve of recorded runs, by number of leaders."""
        late = {k: np.array([_second_half(run) for run in each]) for k, each in runs.items()}
        means = {k: each[:, 0] for k, each in late.items()}
        drift = np.concatenate([each[:, 1] for each in late.values()])
        return cls(n_boats, means, _replicates(n_boats, means, draws_seed), drift)


def _second_half(run: Recording) -> tuple[float, float]:
    """Return the mean signed order, and by how much the last quarter's exceeds the third's."""
    used = run.analyzed(after=0.5)
    signed_order = used.order.signed_order(run.parameters.target)
    is_last = used.time_s >= 0.75 * used.duration_s
    quarters = [signed_order[part] for part in (is_last, ~is_last)]
    drift = quarters[0].mean() - quarters[1].mean() if min(map(len, quarters)) else math.nan
    return float(signed_order.mean()), float(drift)


def _replicates(
    n_boats: int, means: Mapping[int, NDArray[np.float64]], draws_seed: int
) -> NDArray[np.float64]:
    fractions = np.array(list(means)) / n_boats
    curves = zip(*(mean_replicates(each, draws_seed + k) for k, each in means.items()), strict=True)
    return np.array([guiding_fraction(fractions, np.array(curve)) for curve in curves])


def exponent(curves: Sequence[Curve]) -> NDArray[np.float64]:
    """Return the exponent a of the guiding fraction, proportional to n^a, with its replicates.

    Parameters
    ----------
    curves
        Of one policy in one way of growing; a straight line is fitted to the logarithms.

    Returns
    -------
    float64 array, shape (RESAMPLES + 1,)
        NaN where the guiding fraction of any of the sizes is undefined, and for less than three
        sizes, which every line fits.
    """
    if len(curves) < 3:
        return np.full(RESAMPLES + 1, math.nan)
    x = np.log([curve.n_boats for curve in curves])
    x -= x.mean()
    y = np.log(np.stack([curve.replicates for curve in curves], axis=1))
    return np.asarray(y @ x / (x @ x))


def line_p(curves: Sequence[Curve]) -> float:
    """Return the probability that points on a power law lie as far from one as those of `exponent`.

    It is that of chi-squared about a line that is weighted by the spread of each size's defined
    replicates; where many are undefined, it is too small. NaN for less than three sizes.
    """
    if len(curves) < 3:
        return math.nan
    x = np.log([curve.n_boats for curve in curves])
    y = np.log([curve.replicates[0] for curve in curves])
    spreads = np.array([np.nanstd(np.log(curve.replicates[1:])) for curve in curves])
    if not spreads.min() > 0.0:
        return math.nan
    line = np.polyfit(x, y, 1, w=1.0 / spreads)
    misfit = ((y - np.polyval(line, x)) / spreads) ** 2
    return float(chi2.sf(misfit.sum(), len(x) - 2))
