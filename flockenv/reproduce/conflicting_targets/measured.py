"""What `conflicting-targets` measures: which way a flock goes, how soon, and whether it stalls."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flockenv.recording import Recording
from flockenv.statistics.block_bootstrap import block_places
from flockenv.statistics.dwell_times import dwell_times
from flockenv.statistics.intervals import mean_replicates

__all__ = [
    "COUNTS",
    "HELD_MIN",
    "MINUTE_S",
    "MOVING",
    "WON",
    "Measured",
    "cumulant",
    "decision_min",
    "lifetime_min",
    "minute_means",
    "slope",
    "time_ratio",
]

MINUTE_S = 60.0
"""Time in s that rotation is averaged over: some fourteen cycles."""

MOVING = 0.25
"""A minute's mean of the rotation m from which a flock counts as going one way."""

WON = 0.5
"""A minute's mean of the signed order from which a side has the flock."""

HELD_MIN = 5
"""Minutes from then on in which it must not fall below zero again."""

_STATES = ("ccw", "still", "cw")


def minute_means(run: Recording) -> NDArray[np.float64]:
    """Return the rotation m, positive clockwise, as means over the whole minutes of a run."""
    places = block_places(run.time_s, MINUTE_S)
    whole = int(run.duration_s // MINUTE_S)
    counted = places < whole
    sums = np.bincount(places[counted], run.order.rotation()[counted], minlength=whole)
    return np.asarray(sums / np.bincount(places[counted], minlength=whole))


def decision_min(minutes: NDArray[np.float64]) -> float:
    """Return the minutes until clockwise leaders have the flock, and keep it for a while.

    The first minute whose mean is at least `WON` and which is followed by `HELD_MIN` minutes above
    zero; the length of the run where there is none.
    """
    for first in np.flatnonzero(minutes >= WON).tolist():
        after = minutes[first + 1 : first + 1 + HELD_MIN]
        if len(after) == HELD_MIN and (after > 0.0).all():
            return float(first)
    return float(len(minutes))


@dataclass(frozen=True, slots=True)
class Measured:
    """The runs of a match: what each of them gives, and means over runs drawn again and again.

    Attributes
    ----------
    signed_order : float64 array, shape (runs,)
        Towards the clockwise leaders' target, in the analysis window of the second half.
    minutes : tuple of float64 arrays, shape (minutes,)
        `minute_means` of each run.
    means : dict of float64 arrays, shape (RESAMPLES + 1,)
        Of `COUNTS`: as measured, and of resampled runs, all of the same draws.
    """

    signed_order: NDArray[np.float64]
    minutes: tuple[NDArray[np.float64], ...]
    means: dict[str, NDArray[np.float64]]

    @classmethod
    def of_runs(cls, runs: Sequence[Recording], draws_seed: int) -> "Measured":
        """Return what recorded runs of a match give."""
        signed = np.array([float(run.analyzed(after=0.5).order.rotation().mean()) for run in runs])
        minutes = tuple(minute_means(run) for run in runs)
        return cls.of_series(signed, minutes, draws_seed)

    @classmethod
    def of_series(
        cls,
        signed_order: NDArray[np.float64],
        minutes: tuple[NDArray[np.float64], ...],
        draws_seed: int,
    ) -> "Measured":
        """Return what runs with these orders and minutes give."""
        rows = [
            {"signed_order": float(own), **_counts(each)}
            for own, each in zip(signed_order, minutes, strict=True)
        ]
        means = {
            name: mean_replicates(np.array([row[name] for row in rows]), draws_seed)
            for name in COUNTS
        }
        return cls(signed_order, minutes, means)

    @property
    def late(self) -> NDArray[np.float64]:
        """The minutes of the second halves of all runs."""
        return np.concatenate([each[len(each) // 2 :] for each in self.minutes])


COUNTS = ("signed_order", "square", "fourth", "still", "way_min", "turns", "decision_min", "won")
"""Numbers of a run: its signed order; of the minutes of its second half the mean square and fourth
power, and the share between both ways; the minutes in one of the ways and how often one was left;
minutes until the clockwise leaders have the flock, and whether they get it."""


def _counts(minutes: NDArray[np.float64]) -> dict[str, float]:
    late = minutes[len(minutes) // 2 :]
    if len(late) == 0:
        return dict.fromkeys(COUNTS[1:], math.nan)
    states = np.select([late <= -MOVING, late >= MOVING], ["ccw", "cw"], "still")
    stays = dwell_times([states], _STATES, MINUTE_S)
    changes = stays.changes.sum(axis=1)
    decided = decision_min(minutes)
    return {
        "square": float((late**2).mean()),
        "fourth": float((late**4).mean()),
        "still": float(stays.share[1]),
        "way_min": float(stays.time_s[0] + stays.time_s[2]) / 60,
        "turns": float(changes[0] + changes[2]),
        "decision_min": decided,
        "won": float(decided < len(minutes)),
    }


def cumulant(found: Measured) -> NDArray[np.float64]:
    """Return Binder's cumulant 1 - <m^4>/(3 <m^2>^2) of the minutes' rotation m, with replicates.

    It is 2/3 where m has one size and either sign, 0.4 where all m up to a size are as frequent,
    and 0 where m is normal about 0.
    """
    return np.asarray(1.0 - found.means["fourth"] / (3.0 * found.means["square"] ** 2))


def lifetime_min(found: Measured) -> NDArray[np.float64]:
    """Return the mean minutes that a flock goes one way, with replicates; NaN if it never ends."""
    turns = found.means["turns"]
    return np.asarray(found.means["way_min"] / np.where(turns > 0.0, turns, math.nan))


def time_ratio(first: Measured, second: Measured) -> NDArray[np.float64]:
    """Return the mean minutes until the clockwise leaders have the flock over those of others.

    NaN where in either match they get it in less than half of the runs: the length of the run,
    which stands for a time that never came, would then decide.
    """
    ratio = first.means["decision_min"] / second.means["decision_min"]
    often = min(each.means["won"][0] for each in (first, second)) >= 0.5
    return np.asarray(ratio if often else np.full_like(ratio, math.nan))


def slope(x: Sequence[float], found: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the slope of a straight line through replicates at x, replicate by replicate."""
    centered = np.asarray(x, np.float64) - np.mean(x)
    return np.asarray(centered @ np.stack(found) / (centered @ centered))
