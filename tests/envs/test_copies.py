"""Law: copies of an environment have other flocks if it was never reset, and else go on alike.

In every interface, by every way to copy, and in workers that are forked.
"""

import copy
import multiprocessing
import os
import pickle

import numpy as np
import pytest

from .conftest import EVERY

OPTIONS = {"n_boats": 6, "n_leaders": 2, "episode_s": 1.0}
COPIES = {
    "pickle": lambda env: pickle.loads(pickle.dumps(env)),
    # What SuperSuit and joblib send to their workers.
    "cloudpickle": lambda env: pickle.loads(cloudpickle().dumps(env)),
    "deepcopy": copy.deepcopy,
    "copy": copy.copy,
    # Others than ours have none.
    "clone": lambda env: getattr(bare(env), "clone", lambda: copy.deepcopy(env))(),
}


def cloudpickle():
    return pytest.importorskip("cloudpickle")


@pytest.fixture(autouse=True)
def _no_chance():
    """Chance is what is tested here."""


@pytest.fixture(params=EVERY.values(), ids=EVERY.keys())
def env(request):
    return request.param(**OPTIONS)


@pytest.fixture(params=COPIES.values(), ids=COPIES.keys())
def copied(request, env):
    return request.param


def bare(env):
    """Return the environment in wrappers; those of TorchRL have none."""
    return env if hasattr(env, "_batch") else env.unwrapped


def core(env):
    return bare(env)._batch.core


def started(env):
    """Return where the boats are after a reset without a seed."""
    env.reset()
    return core(env).poses().tobytes()


def test_copies_of_what_was_never_reset_have_other_flocks(env, copied):
    copies = [copied(env) for _ in range(4)]
    # Copies of copies, too.
    assert len({started(each) for each in [*copies, copied(copies[0]), env]}) == 6


def test_copies_made_after_a_reset_go_on_alike(env, copied):
    started(env)
    copies = [copied(env) for _ in range(3)]
    assert len({started(each) for each in [*copies, env]}) == 1


def test_a_seed_that_waits_for_its_reset_is_copied():
    for make, seeded in (("sb3", "seed"), ("torchrl", "set_seed")):
        env = EVERY[make](**OPTIONS)
        getattr(env, seeded)(5)
        assert started(copy.deepcopy(env)) == started(env)
        assert core(env).episode(0)["flock_seed"] == 5


def test_a_copy_moves_no_boat_of_its_original(env, copied):
    env.reset()
    before = core(env).to_bytes()
    other = core(copied(env))
    other.step(np.ones(other.rudders().size))
    assert core(env).to_bytes() == before != other.to_bytes()


_IN_WORKERS = []


def _started_in_a_worker(_):
    return started(_IN_WORKERS[-1])


def in_forked_workers(env):
    """Reset the environment in four processes of one task each."""
    _IN_WORKERS.append(env)
    try:
        with multiprocessing.get_context("fork").Pool(2, maxtasksperchild=1) as pool:
            return set(pool.map_async(_started_in_a_worker, range(4), 1).get(timeout=120))
    finally:
        _IN_WORKERS.clear()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the platform cannot fork")
@pytest.mark.filterwarnings("ignore:This process .* is multi-threaded:DeprecationWarning")
def test_forked_workers_have_other_flocks_before_a_reset_and_the_same_after_it(env):
    assert len(in_forked_workers(env)) == 4
    env.reset()
    assert len(in_forked_workers(env)) == 1


def test_every_interface_has_the_generator_of_gymnasium(env):
    """It is made when it is asked for; SuperSuit's frame_skip asks for it, also in wrappers."""
    other = copy.deepcopy(bare(env))
    assert env.np_random is bare(env).np_random
    env = bare(env)
    assert isinstance(env.np_random, np.random.Generator)
    assert env.np_random.integers(2**62) != other.np_random.integers(2**62)
    assert env.np_random_seed >= 0
    env.np_random = np.random.default_rng(3)
    assert env.np_random_seed == -1
    assert started(copy.deepcopy(env)) == started(env)


@pytest.mark.parametrize("name", [each for each in EVERY if each not in ("sb3", "torchrl")])
def test_a_seed_of_a_reset_fixes_the_generator(name):
    """So that what a subclass draws from it is reproducible, as in Gymnasium."""
    drawn = []
    for _ in range(2):
        env = EVERY[name](**OPTIONS)
        env.reset(seed=7)
        drawn.append(bare(env).np_random.integers(2**62))
    assert drawn[0] == drawn[1]
