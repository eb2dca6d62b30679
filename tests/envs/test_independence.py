"""Law: a flock's bits depend neither on the batch it is in, nor on threads, nor on a fork."""

import hashlib
import multiprocessing
import os

import numpy as np
import pytest

import flockenv

OPTIONS = {"n_boats": 12, "n_leaders": 2, "episode_s": 3.0, "pool": "narrow", "target": "random"}


def rollout(num_envs, first_seed=0, steps=70):
    venv = flockenv.LeadersVectorEnv(num_envs, **OPTIONS)
    observations, _ = venv.reset(seed=first_seed)
    record = [observations]
    for step in range(steps):
        seeds = range(first_seed, first_seed + num_envs)
        rows = [np.random.default_rng((seed, step)).uniform(-1, 1, 2) for seed in seeds]
        observations, rewards, _, truncated, _ = venv.step(np.array(rows))
        record += [observations, rewards[:, None], truncated[:, None]]
    return np.concatenate(record, axis=1)


def digest():
    return hashlib.sha256(rollout(5).tobytes()).hexdigest()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the platform cannot fork")
@pytest.mark.filterwarnings("ignore:This process .* is multi-threaded:DeprecationWarning")
def test_a_forked_child_steps_too():
    # Threads do not survive a fork; a child that waited for its parent's would hang for ever.
    expected = digest()
    with multiprocessing.get_context("fork").Pool(2) as pool:
        results = [pool.apply_async(digest) for _ in range(2)]
        assert [result.get(timeout=120) for result in results] == [expected] * 2


def test_leader_counts_share_starts():
    # Paired comparison over leader counts: the same boats at the same places, the same noise.
    poses = []
    for n_leaders in (1, 2, 4):
        env = flockenv.LeadersEnv(**{**OPTIONS, "n_leaders": n_leaders})
        env.reset(seed=3)
        poses.append(env.flock.pose)
    np.testing.assert_array_equal(poses[0], poses[1])
    np.testing.assert_array_equal(poses[0], poses[2])
