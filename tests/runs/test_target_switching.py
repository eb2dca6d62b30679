"""Law: leaders turn round at their switches; the run is a function of its arguments."""

import numpy as np
import pytest

import flockenv
from flockenv.policies import DampedLaw, NetworkPolicy, load
from flockenv.runs.protocols.target_switching import second_halves, simulate_alternating, target_at

PARAMETERS = flockenv.FlockParameters.preset("experiment").replace(n_boats=9, n_leaders=9, bw_s=0.4)


def test_directions_alternate_from_ccw_on():
    assert [target_at(time) for time in (0, 239.9, 240, 480, 720, 960)] == [
        *("ccw", "ccw", "cw", "ccw", "cw", "ccw")
    ]


def test_before_the_first_change_it_is_an_ordinary_run():
    alternating = simulate_alternating(PARAMETERS, 4, 20.0, period_s=30.0)
    plain = flockenv.simulate(PARAMETERS.replace(target="ccw"), 4, 20.0, dtype=np.float32)
    assert np.array_equal(alternating.pose, plain.pose)
    assert np.array_equal(alternating.time_s, plain.time_s)
    assert np.array_equal(alternating.in_analysis_window, plain.in_analysis_window)


def check_leaders_turn_round_after_two_minutes(run):
    x, y = run.pose[:, :2, 0], run.pose[:, :2, 1]
    u, v = run.velocity[:, :2, 0], run.velocity[:, :2, 1]
    counter_clockwise = ((x * v - y * u) / np.hypot(x, y)).mean(axis=1)
    assert counter_clockwise[(run.time_s > 60) & (run.time_s < 120)].mean() > 2.0
    assert counter_clockwise[run.time_s > 180].mean() < -2.0


def test_leaders_go_the_way_that_holds():
    parameters = PARAMETERS.replace(n_boats=3, n_leaders=2)
    run = simulate_alternating(parameters, 2, 240.0, period_s=120.0)
    check_leaders_turn_round_after_two_minutes(run)


def test_the_same_arguments_give_the_same_run():
    first, second = (simulate_alternating(PARAMETERS, 5, 12.0, period_s=5.0) for _ in range(2))
    assert np.array_equal(first.pose, second.pose)
    assert len(first) == 121


def test_another_policy_steers_both_ways():
    class Straight:
        def predict(self, observation, state=None):
            return np.zeros(len(observation)), state

    parameters = PARAMETERS.replace(n_boats=3, n_leaders=2)
    law, straight = (
        simulate_alternating(parameters, 5, 12.0, period_s=5.0, policy=policy)
        for policy in (None, Straight())
    )
    assert np.array_equal(law.pose[0], straight.pose[0])
    assert not np.array_equal(law.pose, straight.pose)
    for policy in (DampedLaw.tuned("narrow"), load("learned", pool="narrow")):
        run = simulate_alternating(parameters, 2, 240.0, period_s=120.0, policy=policy)
        check_leaders_turn_round_after_two_minutes(run)


def test_a_policy_that_sees_a_mirrored_flock_is_refused():
    policy = NetworkPolicy([np.zeros((67, 1))], [[0.5]], mirror_to_target=True)
    with pytest.raises(flockenv.ParameterError, match="with mirror_to_target"):
        simulate_alternating(PARAMETERS, 5, 12.0, policy=policy)


@pytest.mark.parametrize("period_s", [0.0, 0.05, 1.234])
def test_periods_between_samples_are_refused(period_s):
    with pytest.raises(flockenv.ParameterError, match="period_s"):
        simulate_alternating(PARAMETERS, 1, 5.0, period_s=period_s)


def test_second_halves_and_their_directions():
    times = np.array([0.0, 119.9, 120.0, 239.9, 240.0, 359.9, 360.0, 480.0, 719.9])
    late, signs = second_halves(times)
    assert late.tolist() == [False, False, True, True, False, False, True, False, True]
    assert signs.tolist() == [-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, -1.0, -1.0]
