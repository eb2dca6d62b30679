"""Law: episodes of one snapshot differ by their noise_seed; each flock may have its own."""

import gymnasium
import numpy as np
import pytest

import flockenv
from flockenv import Flock, FlockParameters, ParameterError

from .conftest import leader_vec_env

OPTIONS = {"n_boats": 8, "n_leaders": 2, "pool": "narrow"}


def blob():
    flock = Flock(FlockParameters(**OPTIONS), 7)
    flock.advance(3.0)
    return flock.snapshot()


BLOB = blob()


def expected(noise_seed, seconds=2.0):
    """Poses of a flock that continues with rudders amidships."""
    flock = Flock.from_snapshot(BLOB, noise_seed)
    for _ in range(round(10 * seconds)):
        flock.advance(0.1, [0.0, 0.0])
    return flock.pose


def single(options):
    env = gymnasium.make("flockenv/Leaders-v0", **OPTIONS).unwrapped
    env.reset(seed=3, options=options)
    for _ in range(20):
        env.step(np.zeros(2, np.float32))
    return [env._batch.flock(0).pose]


def parallel(options):
    env = flockenv.parallel_env(**OPTIONS)
    env.reset(seed=3, options=options)
    for _ in range(20):
        env.step({agent: np.zeros(1, np.float32) for agent in env.agents})
    return [env._batch.flock(0).pose]


def vector(options):
    env = flockenv.LeadersVectorEnv(3, **OPTIONS)
    env.reset(seed=3, options=options)
    for _ in range(20):
        env.step(np.zeros((3, 2), np.float32))
    return env.poses()


def slots(options):
    env = leader_vec_env(**OPTIONS)
    env.seed(3)
    env.set_options(options)
    env.reset()
    for _ in range(20):
        env.step(np.zeros((6, 1), np.float32))
    return env.poses()


@pytest.mark.parametrize("run", [single, parallel, vector, slots])
def test_an_episode_continues_a_snapshot_with_other_noise(run):
    for options, noise_seed in [
        ({}, None),
        ({"noise_seed": None}, None),
        ({"noise_seed": 5}, 5),
        ({"noise_seed": np.int64(6)}, 6),
    ]:
        for pose in run({"snapshot": BLOB, **options}):
            assert (pose == expected(noise_seed)).all()


def test_each_flock_of_a_vector_has_its_own():
    noise_seeds = [5, None, 6]
    for flock, pose in enumerate(vector({"snapshot": BLOB, "noise_seed": noise_seeds})):
        assert (pose == expected(noise_seeds[flock])).all()
    each = [{"snapshot": BLOB, "noise_seed": noise_seeds[slot // 2]} for slot in range(6)]
    for flock, pose in enumerate(slots(each)):
        assert (pose == expected(noise_seeds[flock])).all()


def test_the_state_of_an_environment_keeps_the_noise():
    env = flockenv.LeadersVectorEnv(2, **OPTIONS)
    env.reset(seed=3, options={"snapshot": BLOB, "noise_seed": [5, 6]})
    env.step(np.zeros((2, 2), np.float32))
    other = flockenv.LeadersVectorEnv(2, **OPTIONS)
    other.set_state(env.get_state())
    for _ in range(19):
        env.step(np.zeros((2, 2), np.float32))
        other.step(np.zeros((2, 2), np.float32))
    assert (env.poses() == other.poses()).all()
    assert (env.poses()[1] == expected(6)).all()


def test_a_list_has_one_noise_seed_per_flock():
    env = flockenv.LeadersVectorEnv(2, **OPTIONS)
    with pytest.raises(ParameterError, match="'noise_seed' lists 3 values, expected 2"):
        env.reset(seed=3, options={"snapshot": BLOB, "noise_seed": [1, 2, 3]})


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"noise_seed": 5}, ParameterError),
        ({"noise_seed": 5, "state": {"pose": Flock.from_snapshot(BLOB).pose}}, ParameterError),
        ({"snapshot": BLOB, "noise_seed": -1}, ParameterError),
        ({"snapshot": BLOB, "noise_seed": 0.5}, ParameterError),
        ({"snapshot": BLOB, "noise_seed": 2**64}, ParameterError),
        ({"snapshot": BLOB, "noise_seed": True}, TypeError),
        ({"snapshot": BLOB, "noise_seed": "5"}, TypeError),
        ({"snapshot": BLOB, "noise_seed": [[5]]}, TypeError),
        ({"snapshot": BLOB, "noise-seed": 5}, ParameterError),
    ],
)
@pytest.mark.parametrize("make", [flockenv.LeadersVectorEnv, leader_vec_env, flockenv.parallel_env])
def test_what_is_no_noise_seed_is_refused_and_changes_nothing(make, options, error):
    env = make(**OPTIONS)
    reset = env.reset
    if make is leader_vec_env:
        env.seed(3)

        def reset(options):
            env.set_options(options)
            env.reset()

        env.reset()
    else:
        env.reset(seed=3)
    before = env.get_state()
    with pytest.raises(error, match=r"noise.seed"):
        reset(options=options)
    assert env.get_state() == before
