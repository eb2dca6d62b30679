"""How long whole flocks stay in jam and rotation, on stays whose answer is known."""

from types import SimpleNamespace

import numpy as np
import pytest

import flockenv
from flockenv.reproduce.transition.measured import STATES, lifetime, states
from flockenv.reproduce.transition.order import judge_lifetimes
from flockenv.statistics.dwell_times import DwellTimes
from flockenv.statistics.intervals import RESAMPLES


def test_states_change_at_two_thresholds() -> None:
    time_s = np.arange(300.0)
    steps = np.repeat([0.5, -0.02, 0.5, 0.82, 0.5, 0.08], 50)
    found = states(time_s, steps)
    # 0.5 is nearer to the jam, between the thresholds the state stays, and the mean takes 30 s.
    assert found[0] == "jammed"
    changes = np.flatnonzero(found[1:] != found[:-1]) + 1
    # On paper: 0.5 - 0.52 j/30 < 0.3 from the 12th sample on, 0.5 + 0.32 j/30 > 0.6 from the 10th
    # and 0.5 - 0.42 j/30 < 0.3 from the 15th.
    assert changes.tolist() == [50 + 11, 150 + 9, 250 + 14]
    assert found[changes].tolist() == ["rotating", "jammed", "rotating"]
    # A gap in time is no longer than the samples in the last 30 s.
    apart = states(time_s * 31.0, steps)
    assert (np.flatnonzero(apart[1:] != apart[:-1]) + 1).tolist() == [50, 150, 250]


def dwell(times: tuple[float, float], changes: tuple[int, int]) -> DwellTimes:
    out, back = changes
    return DwellTimes(STATES, np.array(times), np.ones(2, int), np.array([[0, out], [back, 0]]))


def test_the_lifetime_at_coexistence() -> None:
    dwells = {10: dwell((1000.0, 10.0), (1, 9)), 20: dwell((3000.0, 800.0), (29, 7))}
    found = lifetime(dwells, 1)
    assert found.density == 20
    # On paper: 3000 s over 29.5 changes and 800 s over 7.5.
    assert np.exp(found.log_s[0]) == pytest.approx((3000 / 29.5 * 800 / 7.5) ** 0.5)
    # The logarithm of a Gamma variate with shape a varies by about 1/sqrt(a).
    assert found.log_s[1:].std() == pytest.approx((1 / 29.5 + 1 / 7.5) ** 0.5 / 2, rel=0.15)


@pytest.mark.parametrize(
    ("slope", "sizes", "verdict"),
    [
        (-1.0, (50, 100, 200, 400), "does not hold"),
        # Stays that were too rare to be measured may be the longest.
        (-1.0, (50, 100, 200), "inconclusive"),
        (1.0, (50, 100, 200), "holds"),
    ],
)
def test_lifetimes_that_are_not_measured_refute_nothing(
    slope: float, sizes: tuple[int, ...], verdict: str
) -> None:
    measured = SimpleNamespace(
        design=SimpleNamespace(sizes=(50, 100, 200, 400)),
        lifetime_growth=lambda way: (np.full(RESAMPLES + 1, slope), list(sizes)),
    )
    found = judge_lifetimes(measured, "whole pool")
    assert found.verdict == verdict
    assert ("lifetimes with 400 are too long" in found.note) == (verdict == "inconclusive")


def test_stays_add_up() -> None:
    both = dwell((1.0, 2.0), (3, 4)) + dwell((10.0, 20.0), (30, 40))
    assert both.time_s.tolist() == [11.0, 22.0]
    assert both.changes.tolist() == [[0, 33], [44, 0]]
    other = DwellTimes(("a",), np.zeros(1), np.zeros(1, int), np.zeros((1, 1), int))
    with pytest.raises(flockenv.ParameterError, match="not the same states"):
        both + other
