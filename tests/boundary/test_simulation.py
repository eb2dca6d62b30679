"""A run with a policy is the run of the environments: the same observations, the same rudders.

On paper: leaders that hold their rudders at zero are normal boats, so a policy of zeros gives the
run of a flock whose leaders hold zero.
"""

import numpy as np
import pytest

import flockenv
from flockenv.policies import SteeringLaw


class Constant:
    """Rudders that never move, and a count of the calls."""

    def __init__(self, rudder: float) -> None:
        self.rudder, self.calls = rudder, 0

    def predict(self, observation, state=None, episode_start=None):  # type: ignore[no-untyped-def]
        self.calls += 1
        return np.full(len(observation), self.rudder), state


@pytest.fixture
def parameters() -> flockenv.FlockParameters:
    return flockenv.FlockParameters.preset("simulation").replace(n_boats=8, n_leaders=2)


def test_held_rudders(parameters: flockenv.FlockParameters) -> None:
    policy = Constant(0.5)
    recording = flockenv.simulate(parameters, 3, 6.0, 5.0, policy)
    flock = flockenv.Flock(parameters, 3)
    for place in range(31):
        assert recording.time_s[place] == pytest.approx(place / 5)
        assert (recording.pose[place] == flock.pose).all()
        assert recording.order[place] == flock.order_parameters()
        assert recording.phase[place] == flock.phase
        flock.advance(0.1, [0.5, 0.5])
        flock.advance(0.1, [0.5, 0.5])
    assert policy.calls == 61


def test_the_law_in_an_environment_is_the_law_in_a_run(
    parameters: flockenv.FlockParameters,
) -> None:
    env = flockenv.LeadersEnv(params=parameters, target=parameters.target, episode_s=20.0)
    law = SteeringLaw()
    observation, info = env.reset(seed=4)
    rewards = []
    truncated = False
    while not truncated:
        observation, reward, _, truncated, _ = env.step(law.predict(observation)[0])
        rewards.append(reward)
    recording = flockenv.simulate(parameters, int(info["flock_seed"]), 20.0, policy=law)
    signed = recording.order.signed_order(parameters.target)[1:]
    assert rewards == pytest.approx(signed, abs=1e-9)


def test_a_policy_that_sees_its_mirror_image_steers_the_mirror_image() -> None:
    base = flockenv.FlockParameters.preset("simulation").replace(n_boats=2, n_leaders=1, c4=0.0)
    seen = SteeringLaw(mirror_to_target=True)
    for target in ("cw", "ccw"):
        parameters = base.replace(target=target)
        mirrored = flockenv.simulate(parameters, 1, 10.0, policy=seen)
        plain = flockenv.simulate(parameters, 1, 10.0, policy=SteeringLaw())
        np.testing.assert_allclose(mirrored.pose, plain.pose, atol=1e-4)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"policy": "lore"}, "'lore' is no policy"),
        ({"policy": Constant(np.nan)}, "rudder"),
        ({"control_hz": 0.0}, "control_hz"),
        ({"duration_s": np.inf}, "duration_s"),
    ],
)
def test_refusals(parameters: flockenv.FlockParameters, changes: dict, words: str) -> None:  # type: ignore[type-arg]
    arguments = {"duration_s": 1.0, "policy": Constant(0.0), **changes}
    with pytest.raises(flockenv.ParameterError, match=words):
        flockenv.simulate(parameters, 1, **arguments)
