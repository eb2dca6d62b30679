"""Law: the gradient of a reward that is a function of the action alone is its derivative.

The effort of a rudder s is -s²: towards smaller rudders it grows.
"""

import math

import numpy as np
import pytest

from flockenv import FlockParameters
from flockenv.comparison.exploration import Exploration
from flockenv.comparison.signal import ConstantAction, SignalSettings, measured_signals
from flockenv.envs.observation import observation_entries
from flockenv.errors import ParameterError
from flockenv.policies import DampedLaw, NetworkPolicy, SteeringLaw

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


def straight_ahead():
    """Return a linear network that goes straight ahead whatever it observes."""
    size = len(observation_entries())
    return NetworkPolicy([np.zeros((size, 1))], [np.zeros(1)])


def test_a_noise_of_weights_finds_the_gradient_too():
    def found(reward, **changes):
        ends = ConstantAction(0.5, "rudder"), straight_ahead()
        rewards = {"reward": {reward: 1.0}}
        return measured_signals(FLOCK, *ends, settings(rewards=rewards, weights=True, **changes))[0]

    assert found("rudder_effort").z > 10.0
    assert found("rudder_effort", shared=True, hold_s=1.0).z > 3.0
    assert abs(found("jam").z) < 4.0


def test_a_noise_of_weights_is_linear_in_what_the_layer_takes():
    random = np.random.default_rng(0)
    exploration = Exploration(
        random, 3, 40, deviation=0.3, shared=True, hold=2, inputs=lambda seen: seen[:, :4]
    )
    draws = []
    for _ in range(300):
        seen = random.normal(size=(120, 6))
        noise, deviation = exploration.next(seen)
        inputs = np.hstack([seen[:, :4], np.ones((120, 1))])
        scale = 0.3 / math.sqrt(5)
        np.testing.assert_allclose(deviation, scale * np.sqrt((inputs**2).sum(axis=1)))
        for flock in range(3):
            own = slice(40 * flock, 40 * flock + 40)
            solved = np.linalg.lstsq(inputs[own], noise[own], rcond=None)[0]
            np.testing.assert_allclose(inputs[own] @ solved, noise[own], atol=1e-12)
            draws.append(solved / scale)
    held = np.array(draws).reshape(150, 2, 3, 5)
    np.testing.assert_allclose(held[:, 0], held[:, 1], atol=1e-9)
    assert held.std() == pytest.approx(1.0, abs=0.05)
    correlation = np.corrcoef(held[:, 0].reshape(150, 15).T) - np.eye(15)
    assert np.abs(correlation).max() < 0.35


def test_a_squashed_network_is_explored_before_its_hyperbolic_tangent():
    size = len(observation_entries())
    linear, squashed = (
        NetworkPolicy([np.zeros((size, 1))], [np.zeros(1)], squashed=each) for each in (False, True)
    )
    ends = [
        measured_signals(FLOCK, ConstantAction(0.9, "rudder"), towards, settings(deviation=0.05))[0]
        for towards in (linear, squashed)
    ]
    # d(-tanh²)/dx = -2·tanh·(1 - tanh²) against d(-x²)/dx = -2x, each times the distance to go.
    assert ends[0].z > 5.0
    assert ends[1].z > 5.0
    assert ends[0].z != ends[1].z


def test_a_noise_of_weights_needs_a_network():
    with pytest.raises(ParameterError, match="to a NetworkPolicy"):
        signal(0.5, 0.0, weights=True)


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
    ],
)
def test_bad_input(changes, message):
    with pytest.raises(ParameterError, match=message):
        signal(0.5, 0.0, **changes)


def test_laws_observe_what_networks_and_options_say():
    network = straight_ahead()
    options = {"observation": {"order": False}, "mirror_to_target": True}
    with pytest.raises(ParameterError, match=r"NetworkPolicy.*another layout"):
        measured_signals(FLOCK, SteeringLaw(), network, settings(options=options))
    size = len(observation_entries(options["observation"]))
    other = NetworkPolicy([np.zeros((size, 1))], [np.zeros(1)], **options)
    with pytest.raises(ParameterError, match="observe different layouts"):
        measured_signals(FLOCK, network, other, settings())
    usual = measured_signals(FLOCK, SteeringLaw(), DampedLaw(), settings())[0]
    seen = settings(options={"observation": {"neighbors": 2}})
    fewer = measured_signals(FLOCK, SteeringLaw(), DampedLaw(), seen)[0]
    # Laws act alike with fewer neighbors, of which the baseline alone takes notice.
    assert fewer.z == pytest.approx(usual.z, rel=0.5)
    assert fewer.explained != usual.explained
    assert measured_signals(FLOCK, SteeringLaw(), other, settings())[0].samples == usual.samples


def test_two_policies_that_act_alike_are_no_direction():
    with pytest.raises(ParameterError, match="always act alike"):
        signal(0.5, 0.5)
