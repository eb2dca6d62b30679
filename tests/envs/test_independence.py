"""Law: a flock's bits depend neither on the batch it is in, nor on threads, nor on a fork."""

import hashlib
import itertools
import multiprocessing
import os
import subprocess
import sys

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


def test_batch_size_does_not_matter():
    together = rollout(7)
    for flock in range(7):
        np.testing.assert_array_equal(rollout(1, first_seed=flock)[0], together[flock])


def digest():
    return hashlib.sha256(rollout(5).tobytes()).hexdigest()


@pytest.mark.parametrize("threads", ["1", "2", "5"])
def test_thread_count_does_not_matter(threads):
    code = "import runpy, sys; print(runpy.run_path(sys.argv[1])['digest']())"
    done = subprocess.run(
        [sys.executable, "-c", code, __file__],
        env={**os.environ, "RAYON_NUM_THREADS": threads},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == digest()


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


@pytest.mark.parametrize("mode", ["next_step", "same_step"])
def test_a_flock_that_explodes_ends_all_episodes_of_its_batch(mode):
    """No reward of the others is lost unseen, and no episode starts by itself."""
    fields = {"scheme": "moreau", "dt_s": 0.1, "c0": 1e6, "solver": "gauss-seidel"}
    venv = flockenv.LeadersVectorEnv(3, autoreset_mode=mode, **OPTIONS, **fields)
    venv.reset(seed=1)
    steps = iter(lambda: venv.step(np.zeros((3, 2))), None)
    with pytest.raises(flockenv.SolverError, match="range"):
        list(itertools.islice(steps, 600))
    for _ in range(2):
        with pytest.raises(flockenv.EpisodeError, match="call reset first"):
            venv.step(np.zeros((3, 2)))
    venv.reset(seed=2)
