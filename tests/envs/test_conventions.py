"""Law: episodes, seeds and buffers behave as each interface documents."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import flockenv

OPTIONS = {"n_boats": 9, "n_leaders": 3, "episode_s": 2.0}
STEPS = 20


def vector_env(num_envs=4, **options):
    return gymnasium.make_vec("flockenv/Leaders-v0", num_envs=num_envs, **{**OPTIONS, **options})


def actions_of(venv, step):
    return np.random.default_rng(step).uniform(-1, 1, venv.action_space.shape).astype(np.float32)


def test_time_limit_is_truncation_in_the_parallel_environment():
    env = flockenv.parallel_env(**OPTIONS)
    env.reset(seed=0)
    for step in range(1, STEPS + 1):
        agents = env.agents
        actions = {agent: env.action_space(agent).sample() for agent in agents}
        _, _, terminations, truncations, infos = env.step(actions)
        assert terminations == dict.fromkeys(agents, False)
        assert truncations == dict.fromkeys(agents, step == STEPS)
    assert env.agents == []
    assert all("episode_summary" in info for info in infos.values())


def test_next_step_autoreset():
    venv = vector_env(autoreset_mode="next_step")
    assert venv.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    venv.reset(seed=0)
    for step in range(STEPS):
        observations, _, terminations, truncations, infos = venv.step(actions_of(venv, step))
        assert not terminations.any()
        assert truncations.all() == (step == STEPS - 1)
    assert infos["_episode_summary"].all()
    last = observations
    observations, rewards, _, truncations, infos = venv.step(actions_of(venv, 0))
    assert not rewards.any()
    assert not truncations.any()
    assert infos == {}
    assert (observations != last).any()
    # The second episode starts as after a reset, and the ignored action has moved nothing.
    again = vector_env()
    again.reset(seed=0)
    np.testing.assert_array_equal(observations, again.reset()[0])


def test_same_step_autoreset():
    venv = vector_env(autoreset_mode=AutoresetMode.SAME_STEP)
    plain = vector_env(autoreset_mode="next_step")
    venv.reset(seed=0)
    plain.reset(seed=0)
    for step in range(STEPS):
        observations, rewards, _, truncations, infos = venv.step(actions_of(venv, step))
        expected = plain.step(actions_of(venv, step))
    assert truncations.all()
    assert infos["_final_obs"].all()
    np.testing.assert_array_equal(np.stack(list(infos["final_obs"])), expected[0])
    np.testing.assert_array_equal(rewards, expected[1])
    assert infos["final_info"]["_episode_summary"].all()
    fresh = plain.step(actions_of(venv, 0))[0]
    np.testing.assert_array_equal(observations, fresh)


def test_disabled_autoreset_waits_for_a_partial_reset():
    venv = vector_env(autoreset_mode="disabled")
    venv.reset(seed=0)
    mask = np.array([True, False, False, True])
    for step in range(10):
        venv.step(actions_of(venv, step))
    before = venv.observe()
    observations, infos = venv.reset(options={"reset_mask": mask})
    np.testing.assert_array_equal(observations[~mask], before[~mask])
    assert (observations[mask] != before[mask]).any(axis=1).all()
    np.testing.assert_array_equal(infos["_target"], mask)
    for step in range(10):
        _, _, _, truncations, infos = venv.step(actions_of(venv, step))
    np.testing.assert_array_equal(truncations, ~mask)
    np.testing.assert_array_equal(infos["_episode_summary"], ~mask)
    with pytest.raises(flockenv.EpisodeError, match="reset"):
        venv.step(actions_of(venv, 0))
    venv.reset(options={"reset_mask": ~mask})
    venv.step(actions_of(venv, 0))


@pytest.mark.parametrize("mode", ["next_step", "same_step"])
def test_nothing_returned_is_written_to_later(mode):
    venv = vector_env(autoreset_mode=mode)
    stored = [venv.reset(seed=1)[0]]
    rewards = []
    copies = [stored[0].copy()]
    for step in range(STEPS + 3):
        observations, reward, _, truncated, _ = venv.step(actions_of(venv, step))
        stored += [observations, reward, truncated]
        copies += [observations.copy(), reward.copy(), truncated.copy()]
        rewards.append(reward)
    for array, copy in zip(stored, copies, strict=True):
        np.testing.assert_array_equal(array, copy)
    assert len({array.__array_interface__["data"][0] for array in stored}) == len(stored)


def test_reset_options_hold_for_one_episode():
    env = flockenv.LeadersEnv(**OPTIONS)
    _, info = env.reset(seed=0, options={"target": "ccw", "bw_s": 0.7})
    assert info["target"] == "ccw"
    assert info["bw_s"] == 0.7
    assert env.flock.parameters.bw_s == 0.7
    _, info = env.reset()
    assert info["target"] == "cw"
    assert info["bw_s"] == 0.3


def test_reset_to_a_state_and_to_a_snapshot():
    env = flockenv.LeadersEnv(**OPTIONS)
    env.reset(seed=0)
    for _ in range(15):
        env.step(np.ones(3))
    flock = env.flock
    other = flockenv.LeadersEnv(**OPTIONS)
    other.reset(seed=9, options={"snapshot": flock.snapshot()})
    assert other.flock.snapshot() == flock.snapshot()
    rewards = [other.step(np.ones(3))[1] for _ in range(STEPS)]
    flock.advance(2.0, np.ones(3))
    np.testing.assert_array_equal(other.flock.pose, flock.pose)
    assert len(set(rewards)) > 1
    state = {"pose": flock.pose, "velocity": flock.velocity, "time_s": flock.time_s}
    observation, _ = other.reset(options={"state": state})
    np.testing.assert_array_equal(other.flock.pose, flock.pose)
    assert other.flock.time_s == flock.time_s
    assert observation in other.observation_space
