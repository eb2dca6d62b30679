"""Contacts of a flock: those of its last substep, and those of a recording."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray


class _Columns:
    """Named arrays; two objects are equal if all their arrays are."""

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        columns = (column.name for column in fields(self))  # type: ignore[arg-type]
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in columns)

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, eq=False)
class Contacts(_Columns):
    """The c contacts and near-contacts of a flock's last substep.

    Snapshots do not hold them: a flock that was restored or unpickled has none until its next
    substep, and continues from the same warm-start cache.

    Two nearly parallel hulls, and a hull along the outer wall, touch at two points. They have two
    entries.

    Attributes
    ----------
    i : int64 array, shape (c,)
        The boat that the normal pushes.
    j : int64 array, shape (c,)
        The other boat, or -1 for the outer wall, -2 for the inner wall, and from -3 downwards the
        obstacles: the discs in their order, then the walls.
    gap_cm : float64 array, shape (c,)
        Distance between the hulls now in cm, negative for overlap.
    normal : float64 array, shape (c, 2)
        Unit vector along which boat i is pushed, world axes.
    force : float64 array, shape (c,)
        Mean force on boat i along the normal over the last substep in cm/s² (mass 1), at least 0;
        boat j feels its opposite.
    point_cm : float64 array, shape (c, 2)
        The point of boat i's hull at which it is pushed, world axes.
    along_cm : float64 array, shape (c,)
        That point's coordinate along the core of boat i, from its center to the bow.
    """

    i: NDArray[np.int64]
    j: NDArray[np.int64]
    gap_cm: NDArray[np.float64]
    normal: NDArray[np.float64]
    force: NDArray[np.float64]
    point_cm: NDArray[np.float64]
    along_cm: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.i)


@dataclass(frozen=True, eq=False)
class ContactSeries(_Columns):
    """The c contacts that carried a force in t samples.

    Attributes
    ----------
    count : int64 array, shape (t,)
        Number of contacts in each sample; the other arrays hold them sample after sample.
    i, j : int32 array, shape (c,)
        The boats, as in `Contacts`.
    normal, force, point_cm, along_cm : float32 array, shapes (c, 2), (c,), (c, 2), (c,)
        As in `Contacts`; the force, above 0, is the mean over the substep before the sample.
    """

    count: NDArray[np.int64]
    i: NDArray[np.int32]
    j: NDArray[np.int32]
    normal: NDArray[np.float32]
    force: NDArray[np.float32]
    point_cm: NDArray[np.float32]
    along_cm: NDArray[np.float32]

    @classmethod
    def from_columns(cls, columns: Mapping[str, NDArray[Any]]) -> Self:
        """Return the series from a mapping of columns by name; other names are ignored."""
        return cls(*(columns[column.name] for column in fields(cls)))

    def at(self, samples: NDArray[np.bool_]) -> "ContactSeries":
        """Return the series of the samples in a mask, shape (t,)."""
        is_selected = np.repeat(samples, self.count)
        _count, *contact_fields = fields(self)
        columns = (getattr(self, column.name)[is_selected] for column in contact_fields)
        return ContactSeries(self.count[samples], *columns)
