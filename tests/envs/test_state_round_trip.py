"""Law: a state put away in the middle of an episode continues bit for bit."""

import copy
import pickle

import numpy as np
import pytest

import flockenv

from .conftest import INTERFACES, actions_for

OPTIONS = {"n_boats": 12, "n_leaders": 3, "episode_s": 6.0}
VARIANTS = {
    "plain": {},
    "everything": {
        "target": "alternate",
        "bw_s": (0.1, 0.7),
        "dropout_rate": 0.2,
        "delay_frames": 1,
        "rudder_lag_s": 0.2,
        "rudder_rate_per_s": 5.0,
        "mirror_to_target": True,
    },
    "opposed": {"target": ["cw", "ccw", "ccw"], "mirror_to_target": True},
    "paper": {"preset": "paper"},
    "obstacles": {"pool": (150.0, 0.0), "discs": [(30, 0, 8)], "walls": [(-60, 40, 0, 40)]},
    "bias": {"speed_spread_cm_s": 3.0, "turning_bias": 0.1, "current_gain": 0.1},
}
COPIES = {
    "set_state": lambda env, fresh: fresh.set_state(env.get_state()) or fresh,
    "clone": lambda env, fresh: env.clone(),
    "pickle": lambda env, fresh: pickle.loads(pickle.dumps(env)),
    "deepcopy": lambda env, fresh: copy.deepcopy(env),
}


def action(env, step):
    random = np.random.default_rng(step)
    return actions_for(env, lambda shape: random.uniform(-1, 1, shape))


def same_step(**options):
    return flockenv.LeadersVectorEnv(3, autoreset_mode="same_step", **options)


def equal(first, second):
    if isinstance(first, dict):
        return first.keys() == second.keys() and all(equal(first[k], second[k]) for k in first)
    return np.array_equal(first, second)


@pytest.mark.parametrize("variant", VARIANTS.values(), ids=VARIANTS.keys())
@pytest.mark.parametrize("make", [*INTERFACES.values(), same_step], ids=[*INTERFACES, "same step"])
@pytest.mark.parametrize("again", COPIES.values(), ids=COPIES.keys())
def test_middle_of_an_episode(make, again, variant):
    options = {**OPTIONS, **variant}
    env = make(**options)
    env.reset(seed=5)
    for step in range(37):
        env.step(action(env, step))
    other = again(env, make(**options))
    assert other.get_state() == env.get_state()
    assert equal(env.observe(), other.observe())
    for step in range(37, 60):
        ours, theirs = env.step(action(env, step)), other.step(action(env, step))
        assert all(equal(a, b) for a, b in zip(ours[:4], theirs[:4], strict=True))
        assert repr(ours[4]) == repr(theirs[4])
    # Beyond the end: the next episode is the same too.
    if isinstance(env, flockenv.LeadersVectorEnv):
        ours, theirs = env.step(action(env, 60)), other.step(action(env, 60))
    else:
        ours, theirs = env.reset(), other.reset()
    assert equal(ours[0], theirs[0])
    assert other.get_state() == env.get_state()


def test_clones_are_independent():
    env = flockenv.LeadersEnv(**OPTIONS)
    env.reset(seed=0)
    before = env.get_state()
    clone = env.clone()
    clone.step(np.ones(3))
    assert env.get_state() == before


def test_ended_parallel_environment_stays_ended():
    env = flockenv.parallel_env(**OPTIONS)
    env.reset(seed=0)
    middle = env.get_state()
    for step in range(60):
        env.step(action(env, step))
    end = env.get_state()
    other = flockenv.parallel_env(**OPTIONS)
    other.set_state(end)
    assert other.agents == []
    other.set_state(middle)
    assert other.agents == other.possible_agents
