"""Law: whatever options and actions an environment is given, a named error or finite numbers."""

import importlib.util
import re
import struct

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import flockenv
from flockenv import FlockError
from flockenv.envs.options import NAMES
from flockenv.envs.reset_options import _MISPLACED, _OF_RESET, RESET_OPTIONS

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
names = [name for name in NAMES if name not in ("n_boats", "n_leaders")]


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


def with_a_slip(name, slip, place):
    """A name in another case, with another separator or with a letter wrong."""
    slips = {
        "as it is": name,
        "upper": name.upper(),
        "title": name.title(),
        "dashes": name.replace("_", "-"),
        "joined": name.replace("_", ""),
        "without its unit": re.sub(r"(_per)?_(s|cm|hz)$", "", name.replace("_cm_s", "_cm")),
        "letter twice": name[: place % len(name)]
        + name[place % len(name)]
        + name[place % len(name) :],
    }
    return slips[slip]


OURS = (*RESET_OPTIONS, *NAMES, "pose", "velocity", "time_s", "allow_overlap")
SLIPS = ["as it is", "upper", "title", "dashes", "joined", "without its unit", "letter twice"]
#: Those that are another spelling of a name, and no other word, as episodes of episode_s.
SPELLINGS = SLIPS[:4]


@pytest.fixture(scope="module")
def interfaces():
    """Every interface, with what its reset is given options by."""
    single, parallel = flockenv.LeadersEnv(**SMALL), flockenv.parallel_env(**SMALL)
    vector = flockenv.LeadersVectorEnv(2, **SMALL)
    made = {
        each: lambda options, each=each: each.reset(options=options)
        for each in (single, parallel, vector)
    }
    if importlib.util.find_spec("stable_baselines3"):
        leaders = flockenv.sb3.LeaderVecEnv(2, **SMALL)
        made[leaders] = lambda options: (leaders.set_options(options), leaders.reset())
    for each in made:
        each.reset()
    return made


@FUZZ
@given(st.sampled_from(OURS), st.sampled_from(SLIPS), st.integers(0, 30), st.one_of(anything))
def test_names_of_options_in_a_reset_act_or_are_refused(interfaces, name, slip, place, value):
    """Other spellings, too; what only resembles them belongs to somebody's wrapper."""
    written = with_a_slip(name, slip, place)
    for env, reset in interfaces.items():
        before = env.get_state()
        try:
            reset({written: value})
        except NAMED:
            assert env.get_state() == before
            continue
        assert written in RESET_OPTIONS or slip not in SPELLINGS
        assert env.get_state() != before


@FUZZ
@given(st.text(max_size=12), anything)
def test_keys_of_any_other_name_pass_a_reset(interfaces, name, value):
    assume(_OF_RESET.meant(name) is None)
    assume(_MISPLACED.meant(name) is None)
    for env, reset in interfaces.items():
        before = env.get_state()
        reset({name: value})
        assert env.get_state() != before


@FUZZ
@given(st.sampled_from(OURS[:-4]), st.sampled_from(SPELLINGS), st.integers(0, 30), anything)
def test_names_of_options_are_no_attributes(interfaces, name, slip, place, value):
    written = with_a_slip(name, slip, place)
    for env in interfaces:
        before = vars(env).copy()
        with pytest.raises(AttributeError, match="cannot be set as an attribute"):
            setattr(env, written, value)
        assert vars(env) == before


@FUZZ
@given(
    st.one_of(st.sampled_from(["bw_s", "target", "leader_index", *OURS]), st.text(max_size=8)),
    anything,
    st.one_of(st.none(), st.integers(-9, 9), st.lists(st.integers(-9, 9), max_size=4)),
)
def test_attributes_act_or_are_refused(interfaces, name, value, indices):
    env = [*interfaces][-1]
    if not hasattr(env, "set_attr"):
        pytest.skip("stable-baselines3 is not installed")
    before = env.get_state()
    try:
        env.set_attr(name, value, indices)
    except (*NAMED, AttributeError, IndexError):
        assert env.get_state() == before
        return
    assert name in ("bw_s", "target")
    chosen = env._get_indices(indices)
    for held in env.get_attr(name, chosen):
        assert np.array_equal(held, value)
    env.reset()
    for episode in env.env_method("episode", indices=chosen):
        if isinstance(value, int | float):
            assert episode["bw_s"] == value
        elif isinstance(value, str) and value in ("cw", "ccw"):
            assert episode["target"] == value
    env.set_state(before)


@FUZZ
@given(
    st.one_of(
        anything,
        st.lists(
            st.tuples(
                st.one_of(anything, st.floats(0, 3)),
                st.one_of(anything, st.dictionaries(st.sampled_from(NAMES), anything, max_size=2)),
            ),
            max_size=3,
        ),
    ),
    st.booleans(),
)
def test_schedules_act_or_are_refused(schedule, is_generator):
    parameters = flockenv.FlockParameters(n_boats=4, n_leaders=1, pool="narrow")
    plain = flockenv.simulate(parameters, 1, 1.0, 2.0)
    given_once = (
        (each for each in schedule) if is_generator and type(schedule) is list else schedule
    )
    try:
        run = flockenv.simulate(parameters, 1, 1.0, 2.0, schedule=given_once)
    except NAMED:
        return
    assert len(run) == len(plain)
    assert np.isfinite(run.pose).all()
    assert run == flockenv.simulate(parameters, 1, 1.0, 2.0, schedule=schedule)


@FUZZ
@given(
    st.one_of(
        anything,
        st.lists(anything, min_size=3, max_size=3),
        arrays.arrays(
            st.one_of(
                arrays.scalar_dtypes(), arrays.byte_string_dtypes(), arrays.datetime64_dtypes()
            ),
            st.sampled_from([(3,), (3, 1), (), (4,)]),
        ),
    )
)
def test_own_quantities_are_real_numbers_or_refused(values):
    parameters = flockenv.FlockParameters(n_boats=4, n_leaders=1, pool="narrow")
    try:
        run = flockenv.simulate(parameters, 1, 1.0, 2.0, quantities={"own": lambda run: values})
    except NAMED:
        return
    own = run.quantities["own"]
    assert own.dtype == np.float64
    assert np.array_equal(own, np.asarray(values).astype(np.float64), equal_nan=True)
    assert np.asarray(values).dtype.kind in "biuf"


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


@FUZZ
@given(st.one_of(st.sampled_from(NAMES), st.from_regex(r"[a-z][a-z0-9_]{0,11}", fullmatch=True)))
def test_a_subclass_keeps_attributes_of_any_name(name):
    assume(
        name
        not in {*dir(flockenv.LeadersEnv), *flockenv.LeadersEnv._read_only_attributes}
        - {"state", "episode"}
    )

    class Mine(flockenv.LeadersEnv):
        def __init__(self, **options):
            setattr(self, name, 0)
            super().__init__(**options)

    env = Mine(**SMALL)
    a_short_episode(env)
    assert getattr(env, name) == getattr(env.clone(), name) == 0


@FUZZ
@given(st.integers(0, 12), st.integers(0, 2**53), st.sampled_from([float, np.float64, np.array]))
def test_a_whole_number_is_the_same_in_every_type(count, seed, kind):
    whole = {"n_boats": count + 3, "n_leaders": 2}
    assert flockenv.FlockParameters(
        **{name: kind(value) for name, value in whole.items()}
    ) == flockenv.FlockParameters(**whole)
    poses = []
    for each in (seed, kind(seed)):
        env = flockenv.parallel_env(**SMALL)
        env.reset(seed=each)
        poses.append(env.flock.pose)
    np.testing.assert_array_equal(*poses)
