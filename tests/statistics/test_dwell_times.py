"""Law: stays and changes are counted as they are; rates follow from them."""

import numpy as np
import pytest

import flockenv
from flockenv.statistics.dwell_times import dwell_times

STATES = ("a", "b", "c")


def test_stays_changes_and_rates_of_a_known_series():
    found = dwell_times([np.array(list("aaabba"))], STATES, 10.0)
    assert found.time_s.tolist() == [40.0, 20.0, 0.0]
    assert found.stays.tolist() == [2, 1, 0]
    assert found.changes.tolist() == [[0, 1, 0], [1, 0, 0], [0, 0, 0]]
    assert found.share.tolist() == pytest.approx([2 / 3, 1 / 3, 0])
    assert found.dwell_s[:2].tolist() == [40.0, 20.0]
    assert np.isnan(found.dwell_s[2])
    # One change from a in 40 s: 1.5 a minute.
    assert found.rates_per_min[0, 1] == pytest.approx(1.5)


def test_nothing_changes_between_two_series():
    found = dwell_times([np.array(["a", "a"]), np.array(["b"]), np.array([], "U1")], STATES, 1.0)
    assert found.changes.sum() == 0
    assert found.stays.tolist() == [1, 1, 0]
    assert np.isinf(found.dwell_s[0])


def test_dwell_times_are_those_of_a_random_process():
    # Leaving a with 0.1 and b with 0.2 a step: 10 and 5 steps.
    rng = np.random.default_rng(1)
    series, state = [], 0
    for draw in rng.random(20_000):
        state = 1 - state if draw < (0.1, 0.2)[state] else state
        series.append("ab"[state])
    found = dwell_times(np.array(series).reshape(100, 200), STATES, 1.0)
    assert found.dwell_s[:2] == pytest.approx([10.0, 5.0], rel=0.1)


def test_unknown_states_and_intervals_are_refused():
    with pytest.raises(flockenv.ParameterError, match="'d' is no state"):
        dwell_times([np.array(["a", "d"])], STATES, 1.0)
    with pytest.raises(flockenv.ParameterError, match="interval_s"):
        dwell_times([], STATES, 0.0)
