"""A flock that a program advances, with its contacts, order parameters and statistics.

The core computes contacts, order parameters (Section 3.2, in the LAP frame) and statistics of
substeps.
"""

import numpy as np
from numpy.typing import ArrayLike

from flockenv import _core
from flockenv._core import (
    Contacts,
    ContactSeries,
    Flock,
    OrderParameters,
    OrderSeries,
    Statistics,
)
from flockenv.errors import ParameterError

__all__ = [
    "STATES",
    "ContactSeries",
    "Contacts",
    "Flock",
    "OrderParameters",
    "OrderSeries",
    "Statistics",
    "order_series",
]

STATES = np.array(_core.collective_state_names())
"""Names of the collective states (Table 2; ordered motion by its direction)."""


def order_series(pose: ArrayLike, velocity: ArrayLike) -> OrderSeries:
    """Return the recorded quantities of any boats, robots or animals at each time.

    Parameters
    ----------
    pose
        Shape (t, n, 3): [x, y from the pool's center, heading rad counter-clockwise from x]. Rows
        of NaN where a boat is not there. Leaders count if they are among the boats.
    velocity
        The same shape, in the unit of length of the pose per s.

    Returns
    -------
    OrderSeries
        Section 3.2's order parameters, the nematic order and milling, of the boats that have both a
        pose and a velocity; NaN where too few have.

    Raises
    ------
    ParameterError
        For other shapes, and for what is no number.
    """
    try:
        states = [np.asarray(each, np.float64) for each in (pose, velocity)]
    except (TypeError, ValueError) as error:
        raise ParameterError("pose and velocity are not accepted: numbers") from error
    for name, each in zip(("pose", "velocity"), states, strict=True):
        if each.ndim != 3:
            raise ParameterError(f"{name} has shape {each.shape}, expected (t, n, 3)")
    return _core.order_series(*states)
