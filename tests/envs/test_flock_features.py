"""Law: features of a flock are the same whatever the order of its boats and the pool's angle.

They are also the same for the mirrored flock with the other target.
"""

import numpy as np
import pytest

import flockenv
from flockenv.envs.observation import flock_feature_entries
from flockenv.envs.single import LeadersEnv

NAMES = [(entry.block, entry.name) for entry in flock_feature_entries()]
OPTIONS = {"n_boats": 12, "n_leaders": 3, "pool": "narrow"}


@pytest.fixture(scope="module")
def state():
    env = LeadersEnv(**OPTIONS)
    env.reset(seed=4)
    for _ in range(70):
        env.step([0.3, -0.4, 0.1])
    return env.flock.pose, env.flock.velocity


def features(pose, velocity, target="cw"):
    env = LeadersEnv(**OPTIONS, target=target)
    start = {"pose": pose, "velocity": velocity, "allow_overlap": True}
    env.reset(seed=0, options={"state": start})
    return env.flock_features()


def test_order_of_boats(state):
    pose, velocity = state
    order = np.array([2, 0, 1, 7, 11, 3, 9, 4, 10, 5, 8, 6])
    np.testing.assert_allclose(
        features(pose[order], velocity[order]), features(pose, velocity), atol=1e-6
    )
    # A leader is not a normal boat.
    swapped = np.array([3, 1, 2, 0, *range(4, 12)])
    assert (
        np.abs(features(pose[swapped], velocity[swapped]) - features(pose, velocity)).max() > 0.01
    )


def turned(pose, velocity, angle):
    cos, sin = np.cos(angle), np.sin(angle)
    matrix = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return pose @ matrix.T + [0.0, 0.0, angle], velocity @ matrix.T


def test_absolute_angles(state):
    np.testing.assert_allclose(features(*turned(*state, 2.1)), features(*state), atol=1e-6)


def test_the_mirrored_flock_with_the_other_target(state):
    mirrored = [each * [1.0, -1.0, -1.0] for each in state]
    np.testing.assert_allclose(features(*mirrored, target="ccw"), features(*state), atol=1e-6)
    assert np.abs(features(*state, target="ccw") - features(*state)).max() > 0.1


def test_values_from_their_definitions(state):
    pose, velocity = state
    values = dict(zip(NAMES, features(pose, velocity).tolist(), strict=True))
    x, y, heading = pose[3:].T
    radius, polar = np.hypot(x, y), np.arctan2(y, x)
    ahead = np.sin(polar - heading)
    clockwise = (velocity[3:, 0] * y - velocity[3:, 1] * x) / radius / 15.0
    boats = "normal boats"
    assert values[boats, "ahead"] == pytest.approx(ahead.mean(), abs=1e-6)
    assert values[boats, "velocity_ahead"] == pytest.approx(clockwise.mean(), abs=1e-6)
    assert values[boats, "velocity_ahead_squared"] == pytest.approx(np.mean(clockwise**2), abs=1e-6)
    assert values[boats, "clumping_2"] == pytest.approx(abs(np.exp(2j * polar).mean()), abs=1e-6)
    shares = [
        values[boats, f"{way}_{side}"]
        for way in ("against", "across", "along")
        for side in ("inside", "outside")
    ]
    assert sum(shares) == pytest.approx(1.0, abs=1e-6)
    assert shares[4] + shares[5] == pytest.approx(np.mean(ahead > 0.5), abs=1e-6)
    distance = np.hypot(*(pose[3:, None, :2] - pose[None, :3, :2]).T)
    radius_cm = flockenv.FlockParameters().boat_radius_cm
    near = np.exp(-((distance / (6 * radius_cm)) ** 2) / 2).sum(axis=1).mean()
    assert values["near leaders", "near"] == pytest.approx(near, rel=1e-5)
