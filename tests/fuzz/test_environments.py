"""Law: whatever options and actions an environment is given, a named error or finite numbers."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import flockenv
from flockenv import FlockError
from flockenv.envs.options import _NAMES

FUZZ = settings.get_profile("fuzz")
NAMED = (FlockError, ValueError, TypeError)
SMALL = {"n_boats": 6, "n_leaders": 2, "pool": "narrow", "episode_s": 0.5}

anything = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 70),
    st.sampled_from([2**31, 2**63, 10**30, b"", "cw", "alternate", "random", "\udc80", object()]),
    st.floats(),
    st.floats(0, 2),
    st.text(max_size=5),
    st.tuples(st.floats(0, 2), st.floats(0, 2)),
    st.dictionaries(
        st.sampled_from(["own", "phase", "order", "neighbors", "signed_order", "jam", "x", 1]),
        st.one_of(st.booleans(), st.integers(-1, 70), st.floats()),
        max_size=3,
    ),
    st.just(np.array(["cw", "ccw"])),
)
# A flock of a hundred thousand boats is accepted, and takes its time.
names = [name for name in _NAMES if name not in ("n_boats", "n_leaders")]


def a_short_episode(env):
    env.reset(seed=3)
    for _ in range(3):
        observation, reward, _, _, _ = env.step(env.action_space.sample())
        assert np.isfinite(observation).all()
        assert np.isfinite(reward).all()
        assert env.observation_space.contains(observation)
    again = env.clone()
    assert again.get_state() == env.get_state()


@FUZZ
@given(st.dictionaries(st.sampled_from(names), anything, max_size=3))
def test_options(options):
    try:
        env = flockenv.LeadersEnv(**{**SMALL, **options})
        a_short_episode(env)
    except NAMED:
        return


@pytest.fixture(scope="module")
def env():
    env = flockenv.LeadersEnv(**SMALL)
    env.reset(seed=0)
    return env


@FUZZ
@given(
    st.one_of(
        anything,
        st.lists(st.one_of(st.floats(), anything), max_size=3),
        arrays.arrays(arrays.scalar_dtypes(), arrays.array_shapes(max_dims=3, max_side=3)),
        st.just(np.broadcast_to(0.5, (10**9, 10**9))),
    )
)
def test_actions(env, actions):
    before = env.get_state()
    try:
        observation, reward, *_ = env.step(actions)
    except NAMED:
        assert env.get_state() == before
        return
    assert np.isfinite(observation).all()
    assert np.isfinite(reward)
    env.set_state(before)


@FUZZ
@given(
    anything,
    st.one_of(
        anything,
        st.dictionaries(
            st.sampled_from(["target", "bw_s", "state", "snapshot", "reset_mask", "bw"]),
            st.one_of(
                anything,
                st.dictionaries(
                    st.sampled_from(["pose", "velocity", "time_s", "allow_overlap"]),
                    st.one_of(
                        anything,
                        arrays.arrays(np.float64, (6, 3), elements=st.floats(-200, 200)),
                        st.just(np.broadcast_to(0.5, (10**9, 10**9))),
                    ),
                ),
            ),
            max_size=3,
        ),
    ),
)
def test_resets(env, seed, options):
    before = env.get_state()
    try:
        observation, _ = env.reset(seed=seed, options=options)
    except NAMED:
        assert env.get_state() == before
        return
    assert np.isfinite(observation).all()
    env.set_state(before)


def sealed(head: bytes, body: bytes) -> bytes:
    total = 0xCBF29CE484222325
    for byte in body:
        total = (total ^ byte) * 0x100000001B3 % 2**64
    return head + struct.pack("<Q", total) + body


@FUZZ
@given(st.data())
def test_stored_states_with_a_forged_seal(env, data):
    before = env.get_state()
    body = bytearray(before[16:])
    for _ in range(data.draw(st.integers(1, 3))):
        body[data.draw(st.integers(0, len(body) - 1))] = data.draw(st.integers(0, 255))
    cut = data.draw(st.one_of(st.just(len(body)), st.integers(0, len(body))))
    try:
        env.set_state(sealed(before[:8], bytes(body[:cut])))
    except FlockError:
        assert env.get_state() == before
        return
    try:
        for _ in range(3):
            observation, _, _, ended, _ = env.step([0.5, -0.5])
            assert np.isfinite(observation).all()
            if ended:
                break
    except FlockError:
        pass
    finally:
        env.set_state(before)
