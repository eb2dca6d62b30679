"""Law: camera and servo do what real ones do, and nothing while they are switched off."""

import math

import numpy as np
import pytest

import flockenv

OPTIONS = {"n_boats": 10, "n_leaders": 3, "episode_s": 60.0}
# What the camera shows; phase, target and rudder are known without it.
SEEN = {"phase": False, "target": False}


def roll(env, steps=100, seed=0):
    """Observations of an episode under fixed actions, and the flock's poses."""
    observations, poses = [env.reset(seed=seed)[0]], [env.flock.pose]
    for step in range(steps):
        observations.append(env.step(np.sin(step + np.arange(3)))[0])
        poses.append(env.flock.pose)
    return np.array(observations), np.array(poses)


def without_rudder(observations, size):
    rows = observations.reshape(len(observations), 3, size).copy()
    rows[..., 7] = 0.0
    return rows


def test_delay_shows_the_frame_before():
    sharp, poses = roll(flockenv.LeadersEnv(**OPTIONS, observation=SEEN))
    late, same_poses = roll(flockenv.LeadersEnv(**OPTIONS, observation=SEEN, delay_frames=1))
    np.testing.assert_array_equal(poses, same_poses)
    size = sharp.shape[1] // 3
    np.testing.assert_array_equal(without_rudder(late, size)[1:], without_rudder(sharp, size)[:-1])
    np.testing.assert_array_equal(late[0], sharp[0])
    # The rudder itself is known at once.
    np.testing.assert_array_equal(
        late.reshape(-1, 3, size)[..., 7], sharp.reshape(-1, 3, size)[..., 7]
    )


def test_reward_is_that_of_the_true_flock():
    sharp = flockenv.LeadersEnv(**OPTIONS)
    blurred = flockenv.LeadersEnv(**OPTIONS, delay_frames=1, dropout_rate=0.5)
    sharp.reset(seed=0)
    blurred.reset(seed=0)
    for _ in range(50):
        assert sharp.step(np.ones(3))[1] == blurred.step(np.ones(3))[1]


def test_dropped_boats_stay_where_they_were_seen():
    blocks = {**SEEN, "neighbors": 0, "order": False}
    options = {**OPTIONS, "observation": blocks}
    sharp, _ = roll(flockenv.LeadersEnv(**options), steps=500)
    dropped, _ = roll(flockenv.LeadersEnv(**options, dropout_rate=0.3), steps=500)
    sharp, dropped = without_rudder(sharp, 8), without_rudder(dropped, 8)
    held, count = 0, 0
    for leader in range(3):
        shown = sharp[0, leader]
        for step in range(1, 501):
            now = dropped[step, leader]
            if (now == sharp[step, leader]).all():
                shown = sharp[step, leader]
            else:
                np.testing.assert_array_equal(now, shown)
                held += 1
            count += 1
    assert held / count == pytest.approx(0.3, abs=4 * math.sqrt(0.3 * 0.7 / count))


def test_the_rudder_that_stands_is_observed():
    env = flockenv.LeadersEnv(**OPTIONS, rudder_rate_per_s=1.0, rudder_lag_s=0.1)
    env.reset(seed=0)
    for _ in range(3):
        observation = env.step(np.array([1.0, 0.5, -1.0]))[0]
    np.testing.assert_allclose(
        observation.reshape(3, -1)[:, 7], env._batch.core.rudders().ravel(), atol=1e-7
    )
