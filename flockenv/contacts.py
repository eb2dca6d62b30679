"""Contacts of a flock, as arrays."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Contacts"]


@dataclass(frozen=True, slots=True, eq=False)
class Contacts:
    """Contacts and near-contacts of a flock's last substep, c of them.

    Snapshots do not hold them: a flock that was restored or unpickled has none until its next
    substep, and goes on from the same loads all the same.

    Two nearly parallel hulls, and a hull along the outer wall, touch at two points: two entries.

    Attributes
    ----------
    i : int64 array, shape (c,)
        The boat that the normal pushes.
    j : int64 array, shape (c,)
        The other boat, or -1 for the outer wall, -2 for the inner wall.
    gap_cm : float64 array, shape (c,)
        Distance between the hulls now in cm, negative for overlap.
    normal : float64 array, shape (c, 2)
        Unit vector along which boat i is pushed, world axes.
    force : float64 array, shape (c,)
        Mean force on boat i along the normal over the last substep in cm/s² (mass 1), at least 0;
        boat j feels its opposite.
    """

    i: NDArray[np.int64]
    j: NDArray[np.int64]
    gap_cm: NDArray[np.float64]
    normal: NDArray[np.float64]
    force: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.i)
