"""Law: parameters are checked once, by the core, and what is accepted survives every round trip."""

import copy
import dataclasses
import math
import pickle

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import flockenv
from flockenv import FlockParameters, ParameterError

NAMES = [field.name for field in dataclasses.fields(FlockParameters)]
HUGE = pytest.param(10**5000, id="huge")  # has more digits than Python prints
COUNTS = ["n_boats", "n_leaders"]
CHOICES = ["target", "scheme", "noise_scheme", "solver"]
OTHERS = ["pool", "leaders_reverse", "discs", "walls", "tolerance_cm"]
NUMBERS = [name for name in NAMES if name not in (*COUNTS, *CHOICES, *OTHERS)]


def test_parameters_are_frozen_hashable_and_comparable(parameters):
    with pytest.raises(dataclasses.FrozenInstanceError):
        parameters.n_boats = 3
    assert len({parameters, parameters.replace(), parameters.replace(n_boats=13)}) == 2


def test_repr_makes_the_same_parameters(parameters):
    p = parameters.replace(pool=(math.inf, 3.5))
    names = {"FlockParameters": FlockParameters, "inf": math.inf}
    assert eval(repr(p), names) == p  # noqa: S307


def test_pools_with_a_name_are_stored_as_it(parameters):
    assert parameters.replace(pool=(180, 97)).pool == "wide"
    assert parameters.replace(pool=[90.0, 48.5]).pool == "narrow"
    assert parameters.replace(pool=(90, 0)).pool == (90.0, 0.0)


def test_numpy_values_become_plain_ones(parameters):
    p = parameters.replace(n_boats=np.int64(9), c0=np.float32(0.5), leaders_reverse=np.True_)
    assert [type(value) for value in (p.n_boats, p.c0, p.leaders_reverse)] == [int, float, bool]


@pytest.mark.parametrize("name", COUNTS)
@pytest.mark.parametrize("value", [-1, 10**30, HUGE, -(10**30), 2.5, math.nan, math.inf])
def test_counts_out_of_range_are_refused_by_name(parameters, name, value):
    with pytest.raises(ParameterError, match=name):
        parameters.replace(**{name: value})


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("value", [-2.0, math.nan, math.inf, -math.inf, 1e300, HUGE])
def test_numbers_out_of_range_are_refused_by_name(parameters, name, value):
    with pytest.raises(ParameterError, match=name):
        parameters.replace(**{name: value})


@pytest.mark.parametrize("value", [0.0, -1e-4, math.nan, -math.inf, 1e-11])
def test_tolerances_that_numbers_cannot_hold_are_refused_with_what_they_can(parameters, value):
    with pytest.raises(ParameterError, match=r"^tolerance_cm = .*1e-10 cm or more"):
        parameters.replace(tolerance_cm=value)


def test_an_infinite_tolerance_is_accepted_and_survives_its_files(parameters):
    p = parameters.replace(tolerance_cm=math.inf)
    assert FlockParameters.from_dict(p.to_dict()) == p
    assert FlockParameters.from_toml(p.to_toml()) == p


@pytest.mark.parametrize("name", [*COUNTS, *NUMBERS, "tolerance_cm"])
@pytest.mark.parametrize(
    "value",
    [
        *(None, "1", [1], 1j, True, np.array([1.0, 2.0]), object(), b"1", "\ud800"),
        *(np.complex128(1.0), np.complex64(1j), np.array(1j)),
    ],
)
@pytest.mark.filterwarnings("ignore:Casting complex values")
def test_values_that_are_no_numbers_are_type_errors_by_name(parameters, name, value):
    with pytest.raises(TypeError, match=name):
        parameters.replace(**{name: value})


@pytest.mark.parametrize("given", [(), ("simulation",), (FlockParameters(n_boats=18), "wide")])
def test_the_critical_noise_of_own_parameters_names_the_command_that_measures_it(given):
    with pytest.raises(ParameterError, match=r"`flockenv sweep FILE\.toml` measures it"):
        FlockParameters(n_boats=18).critical_bw_s(*given)
    assert FlockParameters.critical_bw_s("simulation", "wide") == 0.31


def test_a_resized_hull_has_a_radius_of_gyration_of_its_size():
    base = flockenv.FlockParameters()
    twice = pytest.approx(2 * base.gyration_radius_cm, rel=1e-12)
    for resized in (
        flockenv.FlockParameters(boat_radius_cm=10.0),
        base.replace(boat_radius_cm=10.0),
        flockenv.FlockParameters.from_toml("boat_radius_cm = 10.0"),
        flockenv.LeadersEnv(boat_radius_cm=10.0, pool=(900.0, 0.0)).parameters,
    ):
        assert resized.gyration_radius_cm == twice
    # A disc of even mass has r/√2, and the stadium of Table 3 4.690 cm.
    disc = base.replace(boat_shape=0.0).gyration_radius_cm
    assert disc == pytest.approx(4.74 * (5.0 / 2**0.5) / 4.690, rel=2e-4)


def test_a_radius_of_gyration_that_is_given_is_kept():
    resized = flockenv.FlockParameters(boat_radius_cm=10.0, gyration_radius_cm=4.74)
    assert resized.gyration_radius_cm == 4.74
    # Files state every field.
    assert flockenv.FlockParameters.from_toml(resized.to_toml()) == resized
    assert resized.replace(n_boats=3).gyration_radius_cm == 4.74
    for preset in flockenv.FlockParameters.presets():
        assert flockenv.FlockParameters.preset(preset).gyration_radius_cm == 4.74


@pytest.mark.parametrize("name", CHOICES)
def test_unknown_choices_are_refused_with_what_there_is(parameters, name):
    with pytest.raises(ParameterError, match=f'{name} = "north".*one of "'):
        parameters.replace(**{name: "north"})
    with pytest.raises(TypeError, match=name):
        parameters.replace(**{name: 3})


@pytest.mark.parametrize("pool", [(1,), (1, 2, 3), 5, None, {"outer": 1}, (None, 1), ("a", "b")])
def test_pools_of_a_wrong_form_are_type_errors(parameters, pool):
    with pytest.raises(TypeError, match="pool"):
        parameters.replace(pool=pool)


@pytest.mark.parametrize(
    ("wrong", "right"),
    [("n_boat", "n_boats"), ("leaders", "n_leaders"), ("dt", "dt_s"), ("speed", "speed_cm_s")],
)
def test_unknown_fields_are_refused_with_the_nearest(parameters, wrong, right):
    makers = (parameters.replace, FlockParameters, lambda **v: FlockParameters.from_dict(v))
    for make in makers:
        with pytest.raises(ParameterError, match=f"{wrong!r}.*{right!r}"):
            make(**{wrong: 1})


def test_presets_are_known_by_name_only():
    with pytest.raises(ParameterError, match='one of "simulation", "paper"'):
        FlockParameters.preset("experimant")
    with pytest.raises(TypeError, match="preset"):
        FlockParameters.preset(3)


radii = st.tuples(st.floats(10, 1e6) | st.just(math.inf), st.floats(0, 9))
accepted = st.builds(
    FlockParameters,
    n_boats=st.integers(3, 100_000),
    n_leaders=st.integers(0, 3),
    pool=st.sampled_from(["wide", "narrow"]) | radii,
    boat_radius_cm=st.floats(1e-300, 1e6),
    c4=st.floats(0, 1e6),
    dt_s=st.floats(1e-6, 0.1),
    target=st.sampled_from(["cw", "ccw"]),
    scheme=st.sampled_from(["leapfrog", "moreau", "paper"]),
    leaders_reverse=st.booleans(),
    turning_bias=st.floats(-1, 1),
)


ARENA = {"discs": [(30, 0, 8), (-30, 10, 3.5)], "walls": [(-60, 40, 0, 40)]}


@given(accepted)
@example(FlockParameters(pool=(90.0, 0.0), **ARENA))
def test_every_round_trip_gives_equal_parameters(p):
    for q in (
        FlockParameters.from_dict(p.to_dict()),
        FlockParameters.from_toml(p.to_toml()),
        pickle.loads(pickle.dumps(p)),
        copy.copy(p),
        copy.deepcopy(p),
        p.replace(),
    ):
        assert q == p
        assert hash(q) == hash(p)
        assert repr(q) == repr(p)


def test_parameters_that_are_none_are_type_errors():
    for values in (3, None, "n_boats"):
        with pytest.raises(TypeError, match="mapping"):
            FlockParameters.from_dict(values)
        with pytest.raises(TypeError, match="parameters must be FlockParameters"):
            flockenv.Flock(values, seed=1)


UNITS = {"_cm_s": "cm/s", "_cm": "cm", "_s": "s"}


@pytest.mark.parametrize("field", dataclasses.fields(FlockParameters), ids=lambda each: each.name)
def test_a_field_is_declared_in_whole(field):
    suffix = next((end for end in UNITS if field.name.endswith(end)), None)
    assert field.metadata["doc"].endswith(".")
    assert field.metadata["kind"]
    if suffix is not None:
        assert field.metadata["unit"] == UNITS[suffix]
    if field.metadata["kind"] == "float":
        assert field.metadata["accepted"]
        with pytest.raises(flockenv.ParameterError, match=field.name):
            FlockParameters(**{field.name: -2.0})
