"""Law: the communities' own conformance suites pass, unchanged."""

from types import SimpleNamespace

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env, data_equivalence
from pettingzoo.test import api_test, max_cycles_test, parallel_api_test, seed_test
from pettingzoo.test.state_test import state_test
from pettingzoo.utils.conversions import parallel_to_aec

import flockenv

SHORT = {"n_boats": 8, "n_leaders": 2, "episode_s": 5.0}
VARIANTS = {
    "default": {},
    "one leader": {"n_leaders": 1},
    "discrete": {"rudder_levels": 5},
    "mirrored": {"mirror_to_target": True, "target": "random"},
    "camera": {"dropout_rate": 0.2, "delay_frames": 1},
    "servo": {"rudder_lag_s": 0.3, "rudder_rate_per_s": 2.0},
    "noise range": {"bw_s": (0.1, 0.6), "target": "random"},
    "few blocks": {"observation": {"neighbors": 0, "order": False}},
}


def aec_env(**options):
    return parallel_to_aec(flockenv.parallel_env(**{**SHORT, **options}))


@pytest.fixture(params=VARIANTS.values(), ids=VARIANTS.keys())
def options(request):
    return {**SHORT, **request.param}


def test_gymnasium_check_env(options):
    check_env(gymnasium.make("flockenv/Leaders-v0", **options).unwrapped)


def test_stable_baselines3_check_env(options):
    env_checker = pytest.importorskip("stable_baselines3.common.env_checker")
    env_checker.check_env(flockenv.LeadersEnv(**options))


def test_pettingzoo_parallel_api(options):
    parallel_api_test(flockenv.parallel_env(**options), num_cycles=200)


def test_pettingzoo_aec_api(options):
    api_test(aec_env(**options), num_cycles=200)


def test_pettingzoo_seeds(options):
    seed_test(lambda: aec_env(**{**options, "episode_s": 60.0}), num_cycles=500)


def test_pettingzoo_state(options):
    state_test(aec_env(**options), flockenv.parallel_env(**options))


def test_pettingzoo_max_cycles():
    def limited(make):
        return lambda max_cycles: make(episode_s=max_cycles / 10, n_boats=8)

    max_cycles_test(
        SimpleNamespace(parallel_env=limited(flockenv.parallel_env), env=limited(aec_env))
    )


def test_parallel_seeds_over_500_steps(options):
    # PettingZoo's own parallel_seed_test stops after one step: any() over a dictionary's keys.
    first, second = (flockenv.parallel_env(**{**options, "episode_s": 60.0}) for _ in range(2))
    assert data_equivalence(first.reset(seed=42), second.reset(seed=42), exact=True)
    for env in (first, second):
        for place, agent in enumerate(env.possible_agents):
            env.action_space(agent).seed(place)
    for _ in range(500):
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
