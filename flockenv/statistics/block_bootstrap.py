"""Time averages over runs, resampled in two stages: runs, then blocks of time within each.

Samples of one run are correlated over seconds to minutes, and a run may stay in one state for all
of its length while another run stays in another. So time averages have both resampled: runs out of
the runs, then blocks out of each run's blocks (Künsch 1989, with blocks that do not overlap;
Davison and Hinkley 1997, section 3.8, for the two stages). `statistics.intervals.interval` turns
them into intervals, and `time_average_interval` does all of it.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv.statistics.intervals import RESAMPLES, interval

__all__ = ["block_places", "block_sums", "block_sums_resampled", "time_average_interval"]


def time_average_interval(
    runs: Sequence[tuple[NDArray[np.float64], ArrayLike]],
    block_s: float,
    statistic: Callable[..., NDArray[np.float64]] = lambda mean: mean,
    seed: int = 0,
    resamples: int = RESAMPLES,
) -> tuple[float, float, float]:
    """Return a function of time averages over all samples of all runs, with its interval.

    Parameters
    ----------
    runs
        For each run its times in s, shape (t,), increasing, and its samples of q quantities, shape
        (t, q), or (t,) for one.
    block_s
        Length of a block in s. It should be well above the correlation time.
    statistic
        Takes the averages of the q quantities, each an array over resamples, and returns such an
        array: ``binder_cumulant`` for samples of m² and m⁴. By default the mean of one quantity.
    seed
        Of the draws.
    resamples
        How many draws.

    Returns
    -------
    tuple of float
        The value, and the ends of its percentile interval at level `intervals.CONFIDENCE`. With
        fewer than some ten runs it is too narrow, whatever the number of blocks.

    Raises
    ------
    ValueError
        Without runs, or for a run without samples.
    """
    if not runs:
        raise ValueError("there are no runs to average")
    sums = []
    for time_s, values in runs:
        samples = np.asarray(values, np.float64).reshape(len(time_s), -1)
        counted = np.concatenate([np.ones((len(samples), 1)), samples], axis=1)
        sums.append(block_sums(np.asarray(time_s, np.float64), counted, block_s))
    counts, *totals = block_sums_resampled(sums, seed, resamples).T
    return interval(np.asarray(statistic(*(total / counts for total in totals))))


def block_sums(
    time_s: NDArray[np.float64], values: ArrayLike, block_s: float
) -> NDArray[np.float64]:
    """Sum samples over blocks of time.

    Parameters
    ----------
    time_s
        Times of the t samples in s, increasing.
    values
        Shape (t, q): q quantities.
    block_s
        Length of a block in s. It should be well above the correlation time.

    Returns
    -------
    float64 array, shape (b, q)
        The sums over each block that holds a sample. The last block may be shorter.

    Raises
    ------
    ValueError
        Without samples.
    """
    starts = np.flatnonzero(np.diff(block_places(time_s, block_s), prepend=-1))
    return np.add.reduceat(np.asarray(values, np.float64), starts, axis=0)


def block_places(time_s: NDArray[np.float64], block_s: float) -> NDArray[np.int64]:
    """Return in which block each sample lies, counted over those that hold one: shape (t,).

    Raises
    ------
    ValueError
        Without samples.
    """
    if len(time_s) == 0:
        raise ValueError("there are no samples to average")
    steps = np.diff(np.floor((time_s - time_s[0]) / block_s), prepend=0.0)
    return np.cumsum(steps > 0)


def block_sums_resampled(
    runs: Sequence[NDArray[np.float64]], seed: int, resamples: int = RESAMPLES
) -> NDArray[np.float64]:
    """Sum blocks over runs: as they are, and as drawn again and again.

    Parameters
    ----------
    runs
        For each run the sums over its blocks, shape (b, q); see `block_sums`.
    seed
        Of the draws.
    resamples
        How many draws.

    Returns
    -------
    float64 array, shape (resamples + 1, q)
        Sums over all runs; the first row is that of the runs as they are. Means are quotients of
        two columns, taken row by row.
    """
    rng = np.random.default_rng(seed)
    chosen = rng.multinomial(len(runs), np.full(len(runs), 1 / len(runs)), resamples)
    sums = np.zeros((resamples + 1, runs[0].shape[1]))
    for times, blocks in zip(chosen.T, runs, strict=True):
        count = len(blocks)
        drawn = rng.multinomial(times * count, np.full(count, 1 / count))
        sums[0] += blocks.sum(axis=0)
        sums[1:] += drawn @ blocks
    return sums
