"""Times of events that some runs never reach, such as ordering times (Kaplan and Meier 1958).

A run without the event only says that its time is longer than the run: its time is censored. If you
leave such runs out, or count the length of the run as their time, all times come out too short.
"""

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv._io.arguments import number, with_gaps
from flockenv._io.extras import require
from flockenv.errors import ParameterError, short_repr
from flockenv.statistics.intervals import CONFIDENCE

if TYPE_CHECKING:
    from scipy.stats import CensoredData


@dataclass(frozen=True, slots=True, eq=False)
class Survival:
    """The fraction of runs that still wait for an event, against time.

    Attributes
    ----------
    time_s : float64 array, shape (m,)
        Times at which events happened, ascending, in s.
    share : float64 array, shape (m,)
        Fraction of the runs that wait longer than that time, as Kaplan and Meier estimate it.
    low, high : float64 array, shape (m,)
        Its pointwise interval at level `CONFIDENCE` (exponential Greenwood, the log-log transform);
        0 and 1 if it is undefined.
    runs, events : int
        Number of runs, and number of runs in which the event happened.
    """

    time_s: NDArray[np.float64]
    share: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    runs: int
    events: int

    def share_at(self, time_s: float) -> float:
        """Return the fraction of the runs that wait longer than a time in s."""
        if not number(time_s, "time_s") >= 0.0:
            raise ParameterError(f"time_s = {short_repr(time_s)} is not accepted: at least 0 s")
        index = int(np.searchsorted(self.time_s, time_s, side="right"))
        return 1.0 if index == 0 else float(self.share[index - 1])


def kaplan_meier(times_s: ArrayLike, until_s: ArrayLike) -> Survival:
    """Estimate how long runs wait for an event.

    Parameters
    ----------
    times_s
        Shape (n,): when the event happened in each run, in s; infinite if it did not, as for
        ordering times.
    until_s
        How long each run was watched, in s: one number, or one per run.

    Raises
    ------
    ParameterError
        If there are no runs, for times that are NaN or negative, and for events after the end of
        their run.
    """
    survival = require("scipy.stats", "plot").ecdf(_censored(times_s, until_s)).sf
    # The curve also has points at the ends of runs without the event. There it does not fall.
    is_event = np.diff(survival.probabilities, prepend=1.0) < 0.0
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", RuntimeWarning)  # The logarithms of a share of 0 or 1.
        interval = survival.confidence_interval(CONFIDENCE, method="log-log")
    low = interval.low.probabilities[is_event]
    high = interval.high.probabilities[is_event]
    times = with_gaps(times_s, "times_s")
    return Survival(
        np.asarray(survival.quantiles[is_event], np.float64),
        np.asarray(survival.probabilities[is_event], np.float64),
        np.where(np.isnan(low), 0.0, low),
        np.where(np.isnan(high), 1.0, high),
        len(times),
        int(np.isfinite(times).sum()),
    )


def _censored(times_s: ArrayLike, until_s: ArrayLike) -> "CensoredData":
    """Return the times in the form that scipy takes; refuse what `kaplan_meier` does not accept."""
    times = with_gaps(times_s, "times_s")
    ends = with_gaps(until_s, "until_s")
    if times.ndim != 1 or len(times) == 0:
        raise ParameterError(f"times_s has shape {times.shape}, expected (n,), at least one run")
    if ends.shape not in ((), times.shape):
        raise ParameterError(f"until_s has shape {ends.shape}, expected () or {times.shape}")
    if np.isnan(times).any() or (times < 0.0).any():
        raise ParameterError("times_s holds NaN or negative times; for no event they are infinite")
    if not np.isfinite(ends).all() or (ends < 0.0).any():
        raise ParameterError("until_s is not accepted: finite times, at least 0 s")
    if (np.isfinite(times) & (times > ends)).any():
        raise ParameterError("times_s holds events after until_s, the end of their run")
    is_censored = ~np.isfinite(times)
    censored: type[CensoredData] = require("scipy.stats", "plot").CensoredData
    return censored.right_censored(np.where(is_censored, ends, times), is_censored)
