"""The Binder cumulant of an order parameter (Binder 1981)."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["binder_cumulant"]


def binder_cumulant(second: ArrayLike, fourth: ArrayLike) -> NDArray[np.float64] | Any:
    """Return U = 1 - <m⁴> / (3 <m²>²) of a signed order parameter m.

    It is 0 for normal fluctuations about zero and 2/3 where |m| has one value. It dips below zero
    where states with m = 0 and with |m| > 0 coexist, as at a transition of first order.

    Parameters
    ----------
    second, fourth
        Means of m² and of m⁴, of the same shape: also replicates of both, as
        `time_average_interval` gives them to a statistic.

    Returns
    -------
    float64, or an array of it
        NaN where <m²> is zero.
    """
    second, fourth = np.asarray(second, np.float64), np.asarray(fourth, np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        return 1.0 - fourth / (3.0 * second**2)
