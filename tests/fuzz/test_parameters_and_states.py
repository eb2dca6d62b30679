"""Law: whatever parameters, states and rudders are given, a named error or finite motion."""

import math
import os
import pickle
from datetime import date

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import flockenv
from flockenv import Flock, FlockError, FlockParameters

FUZZ = settings.get_profile("fuzz")
NAMED = (FlockError, ValueError, TypeError)
FIELDS = list(FlockParameters().to_dict())
TOML = FlockParameters.preset("paper").to_toml()
SMALL = FlockParameters(n_boats=6, n_leaders=2, pool="narrow")

#: Numbers that claim petabytes: a view, and nested sequences that would stack to as many.
VIEW = np.broadcast_to(1.0, (10**7, 10**7, 3))
OVERSIZED = [VIEW, (VIEW, VIEW), [[VIEW] * 3] * 3, range(10**15), [range(10**15)] * 6]

plain = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    # Python refuses to print the longest, and hypothesis with it.
    st.integers(2, 5000).map(lambda digits: -(10**digits)),
    st.sampled_from([2**64, np.int8(3), np.float32(0.5), date(2011, 1, 1)]),
    st.floats(),
    st.complex_numbers(),
    st.text(max_size=10),
    st.sampled_from(["cw", "ccw", "narrow", "leapfrog", "white", "\udc80", "paper", "law"]),
    st.binary(max_size=10),
)
hostile = st.recursive(
    plain,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.tuples(inner, inner),
        st.dictionaries(st.text(max_size=5), inner, max_size=3),
        st.lists(st.floats(), max_size=4).map(np.array),
        st.sampled_from([VIEW, np.array([["a"]]), object()]),
    ),
    max_leaves=4,
)


def same_after_a_round_trip(parameters):
    assert FlockParameters.from_toml(parameters.to_toml()) == parameters
    assert FlockParameters.from_dict(parameters.to_dict()) == parameters
    assert pickle.loads(pickle.dumps(parameters)) == parameters


@FUZZ
@given(st.dictionaries(st.one_of(st.sampled_from(FIELDS), st.text()), hostile, max_size=3))
def test_fields_of_any_kind(values):
    for make in (lambda: FlockParameters(**values), lambda: FlockParameters.from_dict(values)):
        try:
            parameters = make()
        except NAMED:
            continue
        same_after_a_round_trip(parameters)


@FUZZ
@given(hostile)
@example({"preset": ["paper"]})
@example({1: 2})
def test_mappings_of_any_kind(values):
    try:
        same_after_a_round_trip(FlockParameters.from_dict(values))
    except NAMED:
        return


@FUZZ
@given(st.data())
@example(None)
def test_toml(data):
    text = "a = " + "[" * 100_000
    if data is not None:
        start, end = sorted(data.draw(st.tuples(*[st.integers(0, len(TOML))] * 2)))
        text = TOML[:start] + data.draw(st.text(max_size=20)) + TOML[end:]
    try:
        same_after_a_round_trip(FlockParameters.from_toml(text))
    except NAMED:
        return


@pytest.mark.parametrize("text", [None, b"n_boats = 3", 3])
def test_toml_that_is_no_text(text):
    with pytest.raises(TypeError, match="must be a string"):
        FlockParameters.from_toml(text)


@pytest.mark.parametrize("text", ["n_boats = " + "9" * 5000, "a = " + "[" * 9999, "n_boats = "])
def test_toml_that_is_none(text):
    with pytest.raises(flockenv.ParameterError, match="is not TOML"):
        FlockParameters.from_toml(text)


numbers = st.one_of(
    st.sampled_from([0.0, 1e-300, 1e-9, 1e-3, 1.0, 1e3, 1e6]), st.floats(0.0, 1e6), st.floats(0, 3)
)
#: Values of the right kind, out to the ends of what is accepted.
extreme = st.fixed_dictionaries(
    {"n_boats": st.integers(1, 6), "n_leaders": st.integers(0, 2)},
    optional={
        **{
            name: numbers
            for name, value in FlockParameters().to_dict().items()
            if type(value) is float
        },
        "pool": st.one_of(
            st.sampled_from(["narrow", (math.inf, 0.0), (1e6, 0.0), (1e6, 9.9e5)]),
            st.tuples(numbers, numbers),
        ),
        "scheme": st.sampled_from(["leapfrog", "moreau", "paper"]),
        "noise_scheme": st.sampled_from(["white", "per-step"]),
        "solver": st.sampled_from(["block-pivoting", "gauss-seidel", "clarabel"]),
        "tolerance_cm": st.sampled_from([1e-9, 1e-6, 1e-4, 1.0, math.inf]),
        "turning_bias": st.floats(-1, 1),
        "leaders_reverse": st.booleans(),
        "target": st.sampled_from(["cw", "ccw"]),
    },
)


@pytest.mark.parametrize("values", OVERSIZED, ids=range(len(OVERSIZED)))
def test_claims_larger_than_memory_are_refused_by_shape(values):
    flock, env = Flock(SMALL, 1), flockenv.LeadersEnv(n_boats=6, n_leaders=2)
    env.reset(seed=1)
    before = flock.snapshot()
    for call in (
        lambda: flock.set_state(values, flock.velocity),
        lambda: flock.set_state(flock.pose, values),
        lambda: flock.advance(0.1, values),
        lambda: env.step(values),
        lambda: env.reset(options={"state": {"pose": values}}),
    ):
        with pytest.raises(flockenv.ParameterError, match=r"shape \(\d+"):
            call()
    assert flock.snapshot() == before


def test_sequences_that_hold_themselves_are_refused():
    endless = []
    endless.append(endless)
    with pytest.raises(NAMED):
        Flock(SMALL, 1).advance(0.1, endless)


def goes_on_finite(flock, seconds, rudder=None):
    flock.advance(seconds, rudder)
    assert np.isfinite(flock.pose).all()
    assert np.isfinite(flock.velocity).all()
    contacts = flock.contacts()
    assert np.isfinite(contacts.gap_cm).all()
    assert np.isfinite(contacts.force).all()
    assert (np.abs(flock.steering_law()) <= 1.0).all()
    again = Flock.from_snapshot(flock.snapshot())
    assert again.snapshot() == flock.snapshot()


@FUZZ
@given(extreme, st.integers(0, 2**64 - 1))
def test_motion_at_the_ends_of_the_accepted_ranges(values, seed):
    try:
        parameters = FlockParameters(**values)
        same_after_a_round_trip(parameters)
        goes_on_finite(Flock(parameters, seed), 30 * parameters.dt_s)
    except FlockError:
        return


coordinates = st.one_of(
    st.floats(-250, 250), st.floats(), st.sampled_from([0.0, -0.0, 1e9, 1e300, 5e-324])
)


@FUZZ
@given(
    st.lists(st.tuples(*[coordinates] * 3), min_size=6, max_size=6),
    st.lists(st.tuples(*[coordinates] * 3), min_size=6, max_size=6),
    st.one_of(st.just(0.0), coordinates),
    st.booleans(),
    st.lists(st.floats(-1, 1), min_size=2, max_size=2),
)
@example([(0, 0, 0)] * 6, [(1e3, 0, 0)] * 6, 0.0, True, [1, -1])
@example([(0, 250, 0)] * 6, [(0, 1e3, 1e3)] * 6, 0.0, True, [1, -1])
def test_states_of_numbers(pose, velocity, time_s, allow_overlap, rudder):
    flock = Flock(SMALL, 1)
    before = flock.snapshot()
    try:
        flock.set_state(pose, velocity, time_s, allow_overlap=allow_overlap)
    except FlockError:
        assert flock.snapshot() == before
        return
    goes_on_finite(flock, 0.5, rudder)


@FUZZ
@given(hostile, hostile, hostile)
def test_states_and_rudders_of_any_kind(first, second, third):
    flock = Flock(SMALL, 1)
    before = flock.snapshot()
    for call in (
        lambda: flock.set_state(first, second, third),
        lambda: flock.set_state(flock.pose, first),
        lambda: flock.set_state(flock.pose, flock.velocity, first),
        lambda: flock.advance(0.1, first),
        lambda: flock.restore(first),
        lambda: flock.set_target(first),
        lambda: flock.reset(first),
        lambda: Flock(first, second),
        lambda: Flock(SMALL, first),
        lambda: flockenv.simulate(SMALL, 1, 0.1, first if first is None else 1.0, second),
    ):
        try:
            call()
        except NAMED:
            assert flock.snapshot() == before
            continue
        assert np.isfinite(flock.pose).all()
        flock.restore(before)


def test_only_make_fuzz_draws_by_chance():
    assert settings.get_profile("fixed").derandomize
    assert FUZZ.derandomize == ("FUZZ_EXAMPLES" not in os.environ)
    assert np.random.default_rng().random() == np.random.default_rng(2011).random()
