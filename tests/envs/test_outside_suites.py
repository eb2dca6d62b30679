"""Law: the communities' own conformance suites pass, unchanged."""

from types import SimpleNamespace

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import api_test, max_cycles_test, parallel_api_test, render_test, seed_test
from pettingzoo.test.state_test import state_test

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
    return flockenv.env(**{**SHORT, **options})


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
