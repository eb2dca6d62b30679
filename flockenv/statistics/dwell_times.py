"""How long a system stays in its states, and where it goes from each."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flockenv.errors import ParameterError, shown

__all__ = ["DwellTimes", "dwell_times"]


@dataclass(frozen=True, slots=True, eq=False)
class DwellTimes:
    """Stays in s states, over some series.

    Attributes
    ----------
    states : tuple of str
        The states.
    time_s : float64 array, shape (s,)
        Time spent in each.
    stays : int64 array, shape (s,)
        Number of stays, those cut off by the ends of a series included.
    changes : int64 array, shape (s, s)
        Number of changes from a state (row) to another (column).
    """

    states: tuple[str, ...]
    time_s: NDArray[np.float64]
    stays: NDArray[np.int64]
    changes: NDArray[np.int64]

    def __add__(self, other: "DwellTimes") -> "DwellTimes":
        """Return the stays of both; their states must be the same."""
        if self.states != other.states:
            raise ParameterError(f"{self.states} and {other.states} are not the same states")
        return DwellTimes(
            self.states,
            self.time_s + other.time_s,
            self.stays + other.stays,
            self.changes + other.changes,
        )

    @property
    def share(self) -> NDArray[np.float64]:
        """Part of the time spent in each state."""
        return np.asarray(self.time_s / self.time_s.sum())

    @property
    def dwell_s(self) -> NDArray[np.float64]:
        """Time in a state for each change out of it, in s; infinite for a state that is not left.

        The maximum-likelihood mean dwell time where leaving has a constant rate, for stays that the
        end of a series cuts off too; NaN for states that do not occur.
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(self.time_s / self.changes.sum(axis=1))

    @property
    def rates_per_min(self) -> NDArray[np.float64]:
        """Changes from a state (row) to another (column) for each minute in the first."""
        with np.errstate(invalid="ignore"):
            return np.asarray(60.0 * self.changes / self.time_s[:, None])


def dwell_times(
    series: Iterable[NDArray[np.str_]], states: Sequence[str], interval_s: float
) -> DwellTimes:
    """Measure stays in series of states at a fixed interval.

    Parameters
    ----------
    series
        Each an array of names, shape (t,).
    states
        All names there may be.
    interval_s
        Time between two of a series in s.

    Raises
    ------
    ParameterError
        For a name that is not among the states, or an interval that is not positive.
    """
    if not interval_s > 0.0:
        raise ParameterError(
            f"interval_s = {shown(interval_s)} is not accepted: a positive time in s"
        )
    place = {name: index for index, name in enumerate(states)}
    count = len(place)
    times, stays = np.zeros(count), np.zeros(count, np.int64)
    changes = np.zeros((count, count), np.int64)
    for names in series:
        unknown = set(names.tolist()) - place.keys()
        if unknown:
            raise ParameterError(f"{min(unknown)!r} is no state: one of {', '.join(states)}")
        if len(names) == 0:
            continue
        codes = np.array([place[name] for name in names.tolist()])
        times += interval_s * np.bincount(codes, minlength=count)
        changed = codes[1:] != codes[:-1]
        np.add.at(changes, (codes[:-1][changed], codes[1:][changed]), 1)
        stays += np.bincount(np.append(codes[:1], codes[1:][changed]), minlength=count)
    return DwellTimes(tuple(states), times, stays, changes)
