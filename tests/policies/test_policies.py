"""Law: closed-form laws read the observation that a learner gets; eq. (10) comes out to 1e-6."""

import copy
import json
import math
import pickle

import numpy as np
import pytest

import flockenv
from flockenv.envs.observation import observation_entries, observe
from flockenv.policies import DampedLaw, SteeringLaw
from flockenv.policies.laws import NamedLaw

LAWS = (SteeringLaw, DampedLaw)


@pytest.mark.parametrize(
    ("law", "name"),
    [
        (DampedLaw(), "gain"),
        (DampedLaw(), "mirror_to_target"),
        (SteeringLaw(), "observation"),
        (flockenv.policies.load("learned", pool="wide"), "backward_gain"),
        (flockenv.policies.load("learned", pool="wide"), "bias"),
        (flockenv.policies.load("learned", pool="wide"), "weights"),
    ],
)
def test_what_a_law_is_made_of_is_fixed(law, name):
    with pytest.raises(AttributeError, match=f"'{name}' of .* is fixed: make another law"):
        setattr(law, name, 2.0)
    law.control_hz = 5.0
    assert copy.deepcopy(law).gains == law.gains


def test_steering_law_agrees_at_its_jump():
    # A boat that heads exactly the wrong way turns left, by the pose and by the observation.
    for target, wrong in (("cw", math.pi / 2), ("ccw", -math.pi / 2)):
        for nudge in (0.0, 1e-15, -1e-15, 1e-9, -1e-9):
            for angle in np.linspace(0, 2 * math.pi, 25):
                parameters = flockenv.FlockParameters(n_boats=2, n_leaders=1, target=target)
                flock = flockenv.Flock(parameters, 0)
                pose = [
                    [140 * math.cos(angle), 140 * math.sin(angle), angle + wrong + nudge],
                    [-140 * math.cos(angle), -140 * math.sin(angle), 0],
                ]
                flock.set_state(np.array(pose), np.zeros((2, 3)))
                action, _ = SteeringLaw().predict(observe(flock))
                assert action[0, 0] == pytest.approx(flock.steering_law()[0], abs=1e-6)


def random_observations(count):
    env = flockenv.LeadersVectorEnv(count, n_leaders=3, target="random")
    env.reset(seed=0)
    for _ in range(35):
        observations, *_ = env.step(env.action_space.sample())
    return observations


def read(observation, name, block="own"):
    names = [(entry.block, entry.name) for entry in observation_entries()]
    return float(observation[names.index((block, name))])


def misalignment(observation):
    target = read(observation, "target", "target")
    phi = math.atan2(read(observation, "sin_orientation"), read(observation, "cos_orientation"))
    return math.remainder(phi - target * math.pi / 2, 2 * math.pi)


def expected_rudder(law, observation):
    delta = misalignment(observation)
    forward, spin = read(observation, "forward_velocity"), -2 * read(observation, "clockwise_spin")
    if isinstance(law, SteeringLaw):
        rudder = 6 * delta / math.pi
    elif forward < 0:
        rudder = law.gains["damping"] * spin - law.gains["backward_gain"] * delta
    else:
        rudder = law.gains["gain"] * delta
    return max(-1.0, min(1.0, rudder))


@pytest.mark.parametrize("law", [SteeringLaw(), DampedLaw(), DampedLaw(0.5, 0.2, 0.3)])
def test_formulas(law):
    observations = random_observations(40).reshape(120, -1)
    expected = [expected_rudder(law, observation) for observation in observations]
    np.testing.assert_allclose(law.predict(observations)[0][:, 0], expected, atol=1e-6)
    # Laws may have few rudders, but the observations differ.
    assert len({round(misalignment(each), 3) for each in observations}) > 100
    assert min(expected) < 0.0 < max(expected)


@pytest.mark.parametrize("kind", LAWS)
def test_a_block_that_is_off_is_named(kind):
    for block in ("own", "target"):
        with pytest.raises(flockenv.ParameterError, match=block):
            kind(observation={block: False})
    kind(observation={"target": False}, mirror_to_target=True)
    env = flockenv.LeadersEnv(observation={"order": False, "neighbors": 2})
    observation, _ = env.reset(seed=0)
    action, _ = kind(observation={"order": False, "neighbors": 2}).predict(observation)
    assert action in env.action_space
    for wrong in (observation[:-1], observation.reshape(-1)[:5], np.float32(1.0), np.zeros((2, 0))):
        with pytest.raises(flockenv.ParameterError, match="observation has shape"):
            kind(observation={"order": False, "neighbors": 2}).predict(wrong)


def test_laws_survive_pickles():
    law = DampedLaw(1.0, 0.3, 2.0, observation={"order": False}, mirror_to_target=True)
    for again in (pickle.loads(pickle.dumps(law)), copy.deepcopy(law)):
        assert (again.gains, again.observation) == (law.gains, law.observation)
        assert again.mirror_to_target
    assert "damping=2" in repr(law)


@pytest.mark.parametrize("name", ["predict", "_steer"])
def test_a_subclass_of_a_law_steers_as_it_says(name):
    class Scaled(SteeringLaw):
        def __init__(self, scale):
            super().__init__()
            self.scale = scale

    def predict(self, observation, state=None, episode_start=None, deterministic=True):
        return self.scale * SteeringLaw.predict(self, observation)[0], state

    def steer(self, rows):
        return self.scale * SteeringLaw._steer(self, rows)

    setattr(Scaled, name, {"predict": predict, "_steer": steer}[name])
    parameters = flockenv.FlockParameters(n_boats=6, n_leaders=2)
    run = flockenv.simulate(parameters, seed=3, duration_s=5.0, policy=Scaled(0.0))
    ahead = flockenv.simulate(parameters, seed=3, duration_s=5.0, policy="straight ahead")
    assert (run.pose == ahead.pose).all()


def test_a_law_of_the_core_needs_no_class():
    law = NamedLaw("paper's law", observation={"order": False}, mirror_to_target=True)
    for again in (law, pickle.loads(pickle.dumps(law))):
        assert (again.observation, again.mirror_to_target) == (law.observation, True)
        assert repr(again) == "paper's law"
    observations = random_observations(4).reshape(12, -1)
    expected, _ = SteeringLaw().predict(observations)
    assert (NamedLaw("paper's law").predict(observations)[0] == expected).all()
    with pytest.raises(flockenv.ParameterError, match="one of"):
        NamedLaw("no law")
    with pytest.raises(flockenv.ParameterError, match="pool"):
        NamedLaw("tuned law")


def test_rudders_of_a_law_are_no_levels():
    env = flockenv.LeadersEnv(n_boats=6, n_leaders=2, rudder_levels=3)
    observation, _ = env.reset(seed=0)
    with pytest.raises(flockenv.ParameterError, match="whole numbers from 0 to 2"):
        env.step(SteeringLaw().predict(observation)[0])
    with pytest.raises(flockenv.ParameterError, match="NaN"):
        SteeringLaw().predict(np.full_like(observation, np.nan))


@pytest.mark.parametrize("law", [SteeringLaw(), DampedLaw()])
def test_a_law_steers_in_the_core_as_it_does_from_observations(law):
    parameters = flockenv.FlockParameters(n_boats=9, n_leaders=3, pool="narrow", target="ccw")

    class Other:
        """The same law, which the core does not know for one."""

        def predict(self, observation, state=None):
            return law.predict(observation, state)

    for control_hz in (10.0, 4.0):
        runs = [
            flockenv.simulate(parameters, 5, 30.0, policy=policy, control_hz=control_hz)
            for policy in (law, Other())
        ]
        assert runs[0].pose.tobytes() == runs[1].pose.tobytes()
        assert runs[0].rudder.tobytes() == runs[1].rudder.tobytes()


@pytest.mark.parametrize("gain", [math.nan, math.inf, -math.inf, 1e10])
@pytest.mark.parametrize("place", range(3))
def test_gains_are_finite(gain, place):
    gains = [1.0, 2.0, 3.0]
    assert [*DampedLaw(*gains).gains.values()] == gains
    for other in (True, "1", None, 1j):
        gains[place] = other
        with pytest.raises(TypeError, match=r"(gain|damping) must be a number"):
            DampedLaw(*gains)
    gains[place] = gain
    with pytest.raises(flockenv.ParameterError, match="a finite number from -1e9 to 1e9"):
        DampedLaw(*gains)
    text = json.loads(flockenv.policies.load("learned", pool="wide").to_json())
    name = [*text["gains"]][place]
    text["gains"][name] = 1e10
    with pytest.raises(flockenv.ParameterError, match="a finite number from -1e9 to 1e9"):
        flockenv.policies.LeaningLaw.from_json(json.dumps(text))
    text["gains"][name], text["bias"] = 1.0, 1e10
    with pytest.raises(flockenv.ParameterError, match="a finite number from -1e9 to 1e9"):
        flockenv.policies.LeaningLaw.from_json(json.dumps(text))
