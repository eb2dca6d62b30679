"""Times that a run is too short for count as longer than the run, and no more.

On paper: four runs, with events at 1, 2 and 4 s and one that is watched for 3 s without. Waiting
shares are 3/4, then 3/4·2/3 = 1/2, then 0, since of one run that is left one has its event.
"""

import math

import numpy as np
import pytest

from flockenv.statistics import kaplan_meier

TIMES, UNTIL = [1.0, 2.0, math.inf, 4.0], [10.0, 10.0, 3.0, 10.0]


def test_the_share_that_waits() -> None:
    found = kaplan_meier(TIMES, UNTIL)
    assert found.time_s.tolist() == [1.0, 2.0, 4.0]
    assert found.share == pytest.approx([0.75, 0.5, 0.0])
    assert (found.runs, found.events) == (4, 3)
    assert [found.share_at(time) for time in (0.5, 1.0, 3.9)] == pytest.approx([1.0, 0.75, 0.5])


def test_the_interval_of_the_first_share() -> None:
    found = kaplan_meier(TIMES, UNTIL)
    # Greenwood: the variance of log(-log S) is d/(n(n - d)) / (log S)² = 1/12 / (log 0.75)².
    width = 1.959964 * math.sqrt(1 / 12) / abs(math.log(0.75))
    assert found.low[0] == pytest.approx(0.75 ** math.exp(width), rel=1e-5)
    assert found.high[0] == pytest.approx(0.75 ** math.exp(-width), rel=1e-5)
    assert (found.low[-1], found.high[-1]) == (0.0, 1.0)


def test_short_runs_do_not_shorten_the_times() -> None:
    """Of exponential times of median 60 s, those within runs of 40 to 80 s are shorter."""
    rng = np.random.default_rng(1)
    times, until = rng.exponential(60 / math.log(2), 4000), rng.uniform(40, 80, 4000)
    came = times <= until
    found = kaplan_meier(np.where(came, times, math.inf), until)
    assert found.share_at(60.0) == pytest.approx(0.5, rel=0.05)
    assert np.median(times[came]) < 30.0


def test_without_events_all_wait() -> None:
    nothing = kaplan_meier([math.inf] * 3, 5.0)
    assert (len(nothing.time_s), nothing.events, nothing.share_at(4.0)) == (0, 0, 1.0)


@pytest.mark.parametrize(
    ("times", "until", "message"),
    [
        ([], 5.0, "at least one run"),
        ([math.nan], 5.0, "NaN"),
        ([-1.0], 5.0, "negative"),
        ([6.0], 5.0, "after until_s"),
        ([1.0], math.inf, "finite"),
    ],
)
def test_times_that_cannot_be_are_refused(times: list[float], until: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        kaplan_meier(times, until)
