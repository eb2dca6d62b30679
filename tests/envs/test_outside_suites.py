"""Law: the communities' own conformance suites pass, unchanged."""

from types import SimpleNamespace

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env, data_equivalence
from pettingzoo.test import (
    api_test,
    max_cycles_test,
    parallel_api_test,
    render_test,
    seed_test,
)
from pettingzoo.test.state_test import state_test
from pettingzoo.utils.conversions import parallel_to_aec

import flockenv

SHORT = {"n_boats": 8, "n_leaders": 2, "episode_s": 5.0}
VARIANTS = {
    "default": {},
    "one leader": {"n_leaders": 1},
    "discrete": {"rudder_levels": 5},
    "mirrored": {"mirror_to_target": True, "target": "random"},
    "opposed": {"target": ["cw", "ccw"]},
    "opposed and mirrored": {"target": ["ccw", "cw"], "mirror_to_target": True},
    "camera": {"dropout_rate": 0.2, "delay_frames": 1},
    "servo": {"rudder_lag_s": 0.3, "rudder_rate_per_s": 2.0},
    "noise range": {"bw_s": (0.1, 0.6), "target": "random"},
    "few blocks": {"observation": {"neighbors": 0, "order": False}},
}


def aec_env(**options):
    return parallel_to_aec(flockenv.parallel_env(**{**SHORT, **options}))


# Ends within every suite, before the analysis window: what the last infos hold is checked too.
ENDING = {"ending": {"episode_s": 2.0}, "ending in the window": {"episode_s": 6.0}}


@pytest.fixture(params=VARIANTS.values(), ids=VARIANTS.keys())
def options(request):
    return {**SHORT, **request.param}


@pytest.fixture(params=[*ENDING.values(), *VARIANTS.values()], ids=[*ENDING, *VARIANTS])
def ending(request):
    return {**SHORT, "episode_s": 2.0, **request.param}


def test_gymnasium_check_env(ending):
    check_env(gymnasium.make("flockenv/Leaders-v0", **ending).unwrapped)


def test_stable_baselines3_check_env(ending):
    env_checker = pytest.importorskip("stable_baselines3.common.env_checker")
    env_checker.check_env(flockenv.LeadersEnv(**ending))


def test_pettingzoo_parallel_api(ending):
    parallel_api_test(flockenv.parallel_env(**ending), num_cycles=200)


def test_pettingzoo_aec_api(ending):
    api_test(aec_env(**ending), num_cycles=200)


@pytest.mark.parametrize("episode_s", [2.0, 6.0, 60.0])
def test_pettingzoo_seeds(options, episode_s):
    seed_test(lambda: aec_env(**{**options, "episode_s": episode_s}), num_cycles=500)


def test_pettingzoo_state(ending):
    state_test(aec_env(**ending), flockenv.parallel_env(**ending))


@pytest.mark.parametrize("episode_s", [2.0, 6.0])
def test_pettingzoo_render(episode_s):
    options = {**SHORT, "episode_s": episode_s}
    render_test(lambda render_mode: aec_env(**options, render_mode=render_mode))


def test_pettingzoo_max_cycles():
    def limited(make):
        return lambda max_cycles: make(episode_s=max_cycles / 10, n_boats=8)

    max_cycles_test(
        SimpleNamespace(parallel_env=limited(flockenv.parallel_env), env=limited(aec_env))
    )


@pytest.mark.parametrize("episode_s", [2.0, 6.0, 60.0])
def test_parallel_seeds_over_500_steps(options, episode_s):
    # PettingZoo's own parallel_seed_test stops after one step: any() over a dictionary's keys.
    first, second = (flockenv.parallel_env(**{**options, "episode_s": episode_s}) for _ in range(2))
    assert data_equivalence(first.reset(seed=42), second.reset(seed=42), exact=True)
    for env in (first, second):
        for place, agent in enumerate(env.possible_agents):
            env.action_space(agent).seed(place)
    for _ in range(500):
        if not first.agents:
            assert data_equivalence(first.reset(), second.reset(), exact=True)
        steps = [
            env.step({agent: env.action_space(agent).sample() for agent in env.agents})
            for env in (first, second)
        ]
        assert data_equivalence(*steps, exact=True)
    assert first.get_state() == second.get_state()


# TorchRL says so of every other version than that one, and works.
@pytest.mark.filterwarnings("ignore:PettingZoo in TorchRL is tested using version == 1.24.3")
def test_torchrl_check_env_specs(options):
    pytest.importorskip("torchrl")
    from torchrl.envs.libs.pettingzoo import PettingZooWrapper
    from torchrl.envs.utils import check_env_specs

    env = PettingZooWrapper(flockenv.parallel_env(**options), return_state=True)
    check_env_specs(env, seed=0)


def test_torchrl_makes_the_registered_environment():
    # GymEnv tries the argument frameskip, and leaves it out after a TypeError that names it.
    pytest.importorskip("torchrl")
    from torchrl.envs import GymEnv
    from torchrl.envs.utils import check_env_specs

    env = GymEnv("flockenv/Leaders-v0", **{**SHORT, "episode_s": 2.0})
    check_env_specs(env, seed=0)
    rollout = env.rollout(60, break_when_any_done=False)
    assert rollout["next", "truncated"].sum() == 3


def test_torchrl_wraps_the_native_vector_environment():
    pytest.importorskip("torchrl")
    import torch
    from torchrl.envs import GymWrapper
    from torchrl.envs.utils import check_env_specs

    options = {**SHORT, "episode_s": 2.0, "autoreset_mode": "disabled"}
    env = GymWrapper(flockenv.LeadersVectorEnv(3, **options))
    check_env_specs(env, seed=0)
    env.set_seed(0)
    rollout = env.rollout(20, policy=lambda _: torch.zeros(3, 2))
    native = flockenv.LeadersVectorEnv(3, **options)
    # TorchRL resets once with the seed, and once more to start.
    native.reset(seed=0)
    observations, _ = native.reset()
    assert rollout["observation"].shape == (3, 20, observations.shape[1])
    for step in range(20):
        observations, rewards, _, truncated, _ = native.step(np.zeros((3, 2), np.float32))
        np.testing.assert_allclose(rollout["next", "reward"][:, step, 0], rewards, atol=1e-6)
        np.testing.assert_array_equal(rollout["next", "truncated"][:, step, 0], truncated)
    assert truncated.all()


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_gymnasium_vectors_of_single_environments(mode):
    venv = gymnasium.make_vec("flockenv/Leaders-v0", num_envs=2, vectorization_mode=mode, **SHORT)
    observations, _ = venv.reset(seed=3)
    native = gymnasium.make_vec("flockenv/Leaders-v0", num_envs=2, **SHORT)
    np.testing.assert_array_equal(observations, native.reset(seed=3)[0])
    native.action_space.seed(0)
    for _ in range(60):
        actions = native.action_space.sample()
        ours, theirs = native.step(actions), venv.step(actions)
        for ours_each, theirs_each in zip(ours[:4], theirs[:4], strict=True):
            np.testing.assert_array_equal(ours_each, theirs_each)
    venv.close()


def test_gymnasium_wrappers_read_the_infos():
    venv = gymnasium.make_vec("flockenv/Leaders-v0", num_envs=3, **SHORT)
    venv = gymnasium.wrappers.vector.RecordEpisodeStatistics(venv)
    venv.reset(seed=0)
    for _ in range(50):
        infos = venv.step(venv.action_space.sample())[4]
    assert (infos["episode"]["l"] == 50).all()
    np.testing.assert_allclose(
        infos["episode"]["r"], infos["episode_summary"]["total_reward"], rtol=1e-9
    )
