"""A flock that a program advances, with its contacts, order parameters and statistics.

The core computes contacts, order parameters (Section 3.2, in the LAP frame) and statistics of
substeps.
"""

import numpy as np

from flockenv import _core
from flockenv._core import (
    Contacts,
    ContactSeries,
    Flock,
    OrderParameters,
    OrderSeries,
    Statistics,
)

__all__ = [
    "STATES",
    "ContactSeries",
    "Contacts",
    "Flock",
    "OrderParameters",
    "OrderSeries",
    "Statistics",
]

STATES = np.array(_core.collective_state_names())
"""Names of the collective states (Table 2; ordered motion by its direction)."""
