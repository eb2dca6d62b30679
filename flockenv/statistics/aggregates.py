"""Summaries of differences over several tasks (Agarwal et al. 2021)."""

import numpy as np
from numpy.typing import NDArray

from flockenv._io.extras import require


def interquartile_mean(
    *tasks: NDArray[np.float64], axis: int = -1
) -> np.float64 | NDArray[np.float64]:
    """Return the mean of the middle half of the values of all tasks together.

    A few very bad or very good episodes change it less than the mean.

    Parameters
    ----------
    tasks
        Values of each task along `axis`.
    axis
        The axis of the values.
    """
    values = np.concatenate(tasks, axis)
    mean: np.float64 | NDArray[np.float64] = require("scipy.stats", "plot").trim_mean(
        values, 0.25, axis
    )
    return mean


def probability_of_improvement(
    *tasks: NDArray[np.float64], axis: int = -1
) -> np.float64 | NDArray[np.float64]:
    """Return the fraction of positive differences (zeros count half), as a mean over the tasks.

    Takes the arguments of `interquartile_mean`, for paired differences.
    """
    shares = [((task > 0.0) + 0.5 * (task == 0.0)).mean(axis) for task in tasks]
    mean: np.float64 | NDArray[np.float64] = np.mean(shares, axis=0)
    return mean
