"""Law: the gradient of a reward that is a function of the action alone is its derivative.

The effort of a rudder s is -s²: towards smaller rudders it grows.
"""

import math

import pytest

from flockenv import FlockParameters
from flockenv.comparison.signal import ConstantAction, SignalSettings, measured_signals
from flockenv.errors import ParameterError
from flockenv.policies import DampedLaw, SteeringLaw

FLOCK = FlockParameters(n_boats=9, n_leaders=2, pool="table-1")
EFFORT = {"effort": {"rudder_effort": 1.0}}


def settings(**changes):
    values = {"rewards": EFFORT, "horizons_s": [0.1], "flocks": 16, "duration_s": 12.0, **changes}
    return SignalSettings(**values)


def signal(start, towards, **changes):
    ends = (ConstantAction(each, "rudder") for each in (start, towards))
    return measured_signals(FLOCK, *ends, settings(**changes))[0]


def test_the_sign_and_the_size_of_a_known_gradient():
    found = signal(0.5, 0.0)
    assert found.samples == 16 * 2 * 120
    assert found.flock_hours == pytest.approx(16 * 12.0 / 3600.0)
    # With a = m + s*e, r = -a² and the gain -2*m*s*e of each sample, the mean of e*d/s*r is
    # -2*m*d. Its deviation per sample is about that of -2*m*d*e² + ..., of order one: z of some
    # tens in 3840 samples.
    assert found.z > 20.0
    assert found.z_per_million == pytest.approx(found.z * math.sqrt(1e6 / found.samples))
    opposite = signal(0.5, 0.9)
    assert opposite.z == pytest.approx(-found.z)
    assert signal(0.5, 0.0, seed=1).z != found.z
    assert signal(0.5, 0.0) == found


def test_shared_and_held_noise_has_fewer_draws_and_the_same_sign():
    # One draw per flock and second instead of one per leader and tenth of a second.
    found = signal(0.5, 0.0, shared=True, hold_s=1.0)
    assert 3.0 < found.z < 0.5 * signal(0.5, 0.0).z


def test_a_reward_that_no_action_changes_has_no_signal():
    # Of a normal boat far from the leader within a tenth of a second.
    found = measured_signals(
        FlockParameters(n_boats=2, n_leaders=1, pool="500-boats"),
        ConstantAction(0.0, "rudder"),
        ConstantAction(1.0, "rudder"),
        settings(rewards={"push": {"contact_push": 1.0}}, horizons_s=[0.1], duration_s=4.0),
    )[0]
    assert abs(found.z) < 4.0


def test_the_baseline_explains_returns_and_every_pair_is_listed():
    rewards = {"order": {"signed_order": 1.0}, "velocity": {"leader_velocity": 1.0}}
    found = measured_signals(
        FLOCK, SteeringLaw(), DampedLaw(), settings(rewards=rewards, horizons_s=[1.0, 4.0])
    )
    assert [(each.reward, each.horizon_s) for each in found] == [
        (reward, horizon) for reward in rewards for horizon in (1.0, 4.0)
    ]
    assert found[0].explained > 0.3
    assert {each.pool for each in found} == {"table-1"}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"rewards": {"a": {"signed_ordre": 1.0}}}, "did you mean 'signed_order'"),
        ({"rewards": {}}, "at least one"),
        ({"horizons_s": [0.0]}, "positive time"),
        ({"flocks": 5}, "even number"),
        ({"deviation": 0.0}, "deviation"),
        ({"hold_s": 0.25}, "whole number of decisions"),
        ({"hold_s": float("inf")}, "whole number of decisions"),
        ({"options": {"action_mode": "leen"}}, "did you mean 'lean'"),
        ({"options": {"action_mode": "lean"}}, r"ConstantAction.*'rudder'.*'lean'"),
        ({"options": {"observation": {"order": False}}}, None),
    ],
)
def test_bad_input(changes, message):
    if message is None:
        with pytest.raises(ParameterError, match="another layout"):
            measured_signals(FLOCK, SteeringLaw(), DampedLaw(), settings(**changes))
        return
    with pytest.raises(ParameterError, match=message):
        signal(0.5, 0.0, **changes)


def test_two_policies_that_act_alike_are_no_direction():
    with pytest.raises(ParameterError, match="always act alike"):
        signal(0.5, 0.5)
