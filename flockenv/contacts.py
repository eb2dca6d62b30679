"""Contacts of a flock, as arrays."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from flockenv.errors import ParameterError

__all__ = ["ContactSeries", "Contacts"]


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
    point_cm : float64 array, shape (c, 2)
        Where boat i is pushed: a point of its hull, world axes.
    """

    i: NDArray[np.int64]
    j: NDArray[np.int64]
    gap_cm: NDArray[np.float64]
    normal: NDArray[np.float64]
    force: NDArray[np.float64]
    point_cm: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.i)


@dataclass(frozen=True, slots=True, eq=False)
class ContactSeries:
    """Contacts that carried a force, sample after sample: c of them in t samples.

    Attributes
    ----------
    count : int64 array, shape (t,)
        How many contacts each sample has; they follow one another in the other arrays.
    i, j : int32 array, shape (c,)
        The boats, as in `Contacts`: j is -1 for the outer wall, -2 for the inner wall.
    normal : float32 array, shape (c, 2)
        Unit vector along which boat i is pushed, world axes.
    force : float32 array, shape (c,)
        Mean force over the substep before the sample in cm/s² (mass 1), above 0.
    point_cm : float32 array, shape (c, 2)
        Where boat i is pushed: a point of its hull, world axes.
    """

    count: NDArray[np.int64]
    i: NDArray[np.int32]
    j: NDArray[np.int32]
    normal: NDArray[np.float32]
    force: NDArray[np.float32]
    point_cm: NDArray[np.float32]

    @classmethod
    def of(cls, samples: Sequence[Contacts]) -> Self:
        """Return the series of contacts that were looked up sample by sample."""
        pushing = [each.force > 0 for each in samples]

        def joined(name: str, dtype: type) -> NDArray[Any]:
            parts = [getattr(each, name)[push] for each, push in zip(samples, pushing, strict=True)]
            return np.concatenate(parts).astype(dtype)

        return cls(
            np.array([push.sum() for push in pushing], np.int64),
            joined("i", np.int32),
            joined("j", np.int32),
            joined("normal", np.float32),
            joined("force", np.float32),
            joined("point_cm", np.float32),
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ContactSeries):
            return NotImplemented
        names = [each.name for each in fields(self)]
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in names)

    def check(self, samples: int, boats: int) -> None:
        """Check the series of a recording.

        Raises
        ------
        ParameterError
            For arrays of a wrong shape or dtype, boats that are not there, forces that are not
            positive, numbers that are not finite.
        """
        c = len(self.i) if np.ndim(self.i) else 0
        shapes = {"count": (samples,), "normal": (c, 2), "point_cm": (c, 2)}
        dtypes = {"count": np.int64, "i": np.int32, "j": np.int32}
        for each in fields(self):
            array: Any = getattr(self, each.name)
            shape, dtype = shapes.get(each.name, (c,)), dtypes.get(each.name, np.float32)
            if not isinstance(array, np.ndarray) or array.dtype != dtype or array.shape != shape:
                raise ParameterError(
                    f"contacts.{each.name} must be an array of {np.dtype(dtype)}, shape {shape}"
                )
            if not np.isfinite(array).all():
                raise ParameterError(f"contacts.{each.name} must be finite")
        if (self.count < 0).any() or (self.count > c).any() or self.count.sum() != c:
            raise ParameterError(f"contacts.count must add up to the {c} contacts there are")
        if not (_within(self.i, 0, boats) and _within(self.j, -2, boats)):
            raise ParameterError(f"contacts.i and contacts.j must be among {boats} boats")
        if not (self.force > 0).all():
            raise ParameterError("contacts.force must be positive")


def _within(numbers: NDArray[np.int32], low: int, end: int) -> bool:
    return bool(((numbers >= low) & (numbers < end)).all())
