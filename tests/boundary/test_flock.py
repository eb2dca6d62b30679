"""Law: a flock moves only as commanded; whatever it refuses leaves it as it was, and usable."""

import copy
import math
import pickle
import signal

import numpy as np
import pytest

import flockenv
from flockenv import Flock, ParameterError, SolverError

BAD_SECONDS = [-1.0, -1e-12, math.nan, math.inf, 1e10, pytest.param(10**400, id="huge")]
BAD_RUDDERS = [
    [0.0],
    [0.0, 0.0, 0.0],
    [[0.0, 0.0]],
    0.5,
    [1.1, 0.0],
    [0.0, -1.000001],
    [math.nan, 0.0],
    [math.inf, 0.0],
    [[0.0], [0.0, 1.0]],
    np.broadcast_to(0.0, (10**15,)),
]
BAD_DTYPES = [
    ["a", "b"],
    [None, None],
    np.array([0.0, 0.0], dtype=object),
    np.array([0j, 0j]),
    np.array([True, False]),
    np.array(["2020-01-01", "2020-01-02"], dtype="datetime64[D]"),
    {0.0, 1.0},
]


@pytest.fixture
def unchanged(flock):
    """A flock that must be the same, bit for bit, after the test's refused calls."""
    flock.advance(3.0)
    before = flock.snapshot()
    yield flock
    assert flock.snapshot() == before
    flock.advance(0.1, rudder=[0.5, -0.5])


def test_starts_at_rest_without_overlap(flock):
    assert flock.time_s == 0.0
    assert flock.phase == "fw"
    assert not flock.velocity.any()
    radii = np.hypot(*flock.pose[:, :2].T)
    assert radii.min() > 48.5 + 5
    assert radii.max() < 90 - 5
    flock.set_state(flock.pose, flock.velocity)  # which refuses overlaps


def test_arrays_are_copies(flock):
    pose, before = flock.pose, flock.snapshot()
    pose[:] = 0.0
    flock.velocity[:] = 1.0
    assert flock.snapshot() == before


def test_a_long_advance_works_in_pieces_that_change_nothing(flock):
    other = copy.copy(flock)
    flock.advance(1000.0)  # 600 000 boat-substeps: more than one piece
    for _ in range(10):
        other.advance(100.0)
    assert np.array_equal(flock.pose, other.pose)
    assert flock.statistics.substeps == other.statistics.substeps


def test_rudder_of_the_law_is_no_rudder_for_one_substep(flock):
    other = copy.copy(flock)
    for _ in range(100):
        flock.advance(0.02)
        other.advance(0.02, rudder=other.steering_law())
    assert np.allclose(flock.pose, other.pose, atol=1e-2)


@pytest.mark.parametrize(
    "form",
    [
        list,
        tuple,
        lambda a: a.astype(np.float32),
        lambda a: np.repeat(a, 2)[::2],
        lambda a: a[::-1][::-1],
        lambda a: a.astype(">f8"),
        lambda a: a.astype(int),
    ],
)
def test_rudders_of_any_layout_do_the_same(flock, form):
    other = copy.copy(flock)
    rudder = np.array([1.0, -1.0])
    flock.advance(1.0, rudder=rudder)
    other.advance(1.0, rudder=form(rudder))
    assert np.array_equal(flock.pose, other.pose)


@pytest.mark.parametrize("seconds", BAD_SECONDS)
def test_bad_durations_are_refused(unchanged, seconds):
    for advance in (unchanged.advance, unchanged.advance_with_error):
        with pytest.raises(ParameterError, match="seconds"):
            advance(seconds)


@pytest.mark.parametrize("rudder", BAD_RUDDERS)
def test_bad_rudders_are_refused(unchanged, rudder):
    for advance in (unchanged.advance, unchanged.advance_with_error):
        with pytest.raises(ParameterError, match="rudder"):
            advance(0.1, rudder=rudder)


@pytest.mark.parametrize("array", BAD_DTYPES)
def test_arrays_of_no_numbers_are_type_errors(unchanged, array):
    with pytest.raises(TypeError, match="rudder"):
        unchanged.advance(0.1, rudder=array)
    with pytest.raises(TypeError, match="pose"):
        unchanged.set_state(array, np.zeros((12, 3)))


@pytest.mark.parametrize("value", [None, "1", [1.0], True, 1j])
def test_arguments_of_a_wrong_type_are_type_errors(unchanged, value):
    with pytest.raises(TypeError, match="seconds"):
        unchanged.advance(value)
    with pytest.raises(TypeError, match="time_s"):
        unchanged.set_state(unchanged.pose, unchanged.velocity, value)
    with pytest.raises(TypeError, match="seed"):
        unchanged.reset(value)


@pytest.mark.parametrize("shape", [(12,), (12, 2), (3, 12), (11, 3), (1, 12, 3), (0, 3), ()])
def test_states_of_a_wrong_shape_are_refused(unchanged, shape):
    with pytest.raises(ParameterError, match=r"pose has shape .* expected \(12, 3\)"):
        unchanged.set_state(np.zeros(shape), unchanged.velocity)
    with pytest.raises(ValueError, match="velocity"):
        unchanged.set_state(unchanged.pose, np.zeros(shape))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e10])
def test_states_out_of_range_are_refused(unchanged, value):
    wrong = unchanged.pose
    wrong[3, 1] = value
    with pytest.raises(ParameterError, match=r"pose.*boat 3"):
        unchanged.set_state(wrong, unchanged.velocity)
    with pytest.raises(ParameterError, match=r"velocity.*boat 3"):
        unchanged.set_state(unchanged.pose, wrong)
    with pytest.raises(ParameterError, match="time_s"):
        unchanged.set_state(unchanged.pose, unchanged.velocity, value)


def test_overlaps_are_refused_unless_allowed(flock):
    pose = flock.pose
    pose[1] = pose[0]
    with pytest.raises(ParameterError, match=r"boats 0 and 1 overlap by .* cm.*allow_overlap"):
        flock.set_state(pose, flock.velocity)
    pose[1] = [85.0, 0.0, 0.0]
    with pytest.raises(ParameterError, match="boat 1 and the outer wall"):
        flock.set_state(pose, flock.velocity)
    pose[1] = [50.0, 0.0, 0.0]
    with pytest.raises(ParameterError, match="boat 1 and the inner wall"):
        flock.set_state(pose, flock.velocity)
    flock.set_state(pose, flock.velocity, allow_overlap=True)
    flock.advance(1.0)
    assert np.isfinite(flock.pose).all()


def test_motion_that_explodes_is_a_solver_error_and_undone(parameters):
    # At 1e6 cm/s a boat is beyond 1e9 cm after 1000 s.
    p = parameters.replace(pool=(math.inf, 0.0), dt_s=0.1, c0=1e6, speed_cm_s=1e6, bw_s=0.0)
    p = p.replace(scheme="moreau", nop1_s=0.0, nop2_s=0.0, c2=0.0, c4=0.0)
    flock = Flock(p, seed=1)
    pose = flock.pose
    with pytest.raises(RuntimeError, match="range") as raised:
        flock.advance(1200.0)
    assert isinstance(raised.value, SolverError)
    assert flock.time_s == 0.0
    assert np.array_equal(flock.pose, pose)


def test_a_signal_stops_a_long_advance_and_undoes_it(flock, signaled_in_the_core):
    def stop(number, frame):
        raise InterruptedError

    flock.advance(1.0)
    before = flock.snapshot()
    usual = signal.signal(signal.SIGUSR1, stop)
    try:
        with pytest.raises(InterruptedError), signaled_in_the_core(signal.SIGUSR1):
            flock.advance(1e8)
    finally:
        signal.signal(signal.SIGUSR1, usual)
    assert flock.snapshot() == before


def test_target_moves_the_law_and_the_parameters(flock):
    clockwise = flock.steering_law()
    flock.set_target("ccw")
    assert flock.parameters == flock.parameters.replace(target="ccw")
    assert not np.array_equal(flock.steering_law(), clockwise)
    with pytest.raises(ParameterError, match="target"):
        flock.set_target("left")
    with pytest.raises(TypeError, match="target"):
        flock.set_target(None)


def test_the_stated_error_is_the_distance_from_eighths_of_the_step(flock):
    flock.advance(3.0)
    finer, plain = copy.copy(flock), copy.copy(flock)
    finer.set_step(flock.parameters.dt_s / 8.0)
    for other in (finer, plain):
        other.advance(0.5, [0.5, -1.0])
    stated = flock.advance_with_error(0.5, [0.5, -1.0])
    away = plain.pose - finer.pose
    away[:, 2] *= flock.parameters.gyration_radius_cm
    assert stated == pytest.approx(math.sqrt((away**2).sum() / len(away)), rel=1e-9)
    assert stated > 0.0
    assert np.array_equal(flock.pose, plain.pose)
    assert flock.statistics.worst_error_cm == stated
    assert plain.statistics.worst_error_cm == 0.0


def test_a_new_step_moves_the_parameters(flock):
    flock.set_step(0.007)
    assert flock.parameters == flock.parameters.replace(dt_s=0.007)
    assert flock.parameters.dt_s == 0.007


@pytest.mark.parametrize("dt_s", [math.nan, 0.0, -0.02, 1e-7, 1.5])
def test_a_step_out_of_range_is_refused(unchanged, dt_s):
    with pytest.raises(ParameterError, match=r"dt_s.*1e-6 to 1 s"):
        unchanged.set_step(dt_s)


def test_a_step_without_an_eighth_states_no_error(flock):
    flock.set_step(2e-6)
    before = flock.snapshot()
    with pytest.raises(ParameterError, match=r"dt_s.*8e-6 s or more"):
        flock.advance_with_error(1e-4)
    assert flock.snapshot() == before


def test_copies_are_independent_and_go_on_alike(flock):
    flock.advance(3.0)
    others = [copy.copy(flock), copy.deepcopy(flock), pickle.loads(pickle.dumps(flock))]
    before = flock.snapshot()
    for other in others:
        other.advance(2.0)
    assert flock.snapshot() == before
    flock.advance(2.0)
    assert all(other.snapshot() == flock.snapshot() for other in others)


def test_a_flock_from_a_state_is_one_that_was_put_there():
    parameters = flockenv.FlockParameters(n_boats=6, n_leaders=1)
    placed = Flock(parameters, 5)
    placed.advance(3.0)
    pose, velocity = placed.pose, placed.velocity
    put = Flock(parameters, 9)
    put.set_state(pose, velocity, 3.0, allow_overlap=True)
    state = {"pose": pose, "velocity": velocity, "time_s": 3.0, "allow_overlap": True}
    given = Flock.from_state(parameters, 9, state)
    for flock in (put, given):
        flock.advance(10.0)
    assert np.array_equal(put.pose, given.pose)
    assert given.seed == 9
    assert given.snapshot() == put.snapshot()
    with pytest.raises(TypeError, match="state"):
        Flock.from_state(parameters, 9, pose)


def test_water_with_inertia_comes_with_copies_and_starts_at_rest():
    """After 5 s of 10 s it is far from what the boats drive, and still not at rest."""
    parameters = flockenv.FlockParameters(
        n_boats=5, current_gain=0.5, current_cap_cm_s=9.0, current_relaxation_s=10.0
    )
    flock = Flock(parameters, 4)
    assert flock.current_cm_s == 0.0
    flock.advance(5.0)
    water = flock.current_cm_s
    assert 0.0 < abs(water) < 9.0
    for other in (copy.copy(flock), pickle.loads(pickle.dumps(flock))):
        assert other.current_cm_s == water
        other.advance(1.0)
        assert flock.current_cm_s == water != other.current_cm_s
    flock.set_state(flock.pose, flock.velocity)
    assert flock.current_cm_s == 0.0


def test_water_without_inertia_is_a_share_of_the_mean_tangential_velocity():
    flock = Flock(flockenv.FlockParameters(n_boats=5, current_gain=0.5, current_cap_cm_s=9.0), 4)
    flock.advance(5.0)
    x, y = flock.pose[:, :2].T
    along = (x * flock.velocity[:, 1] - y * flock.velocity[:, 0]) / np.hypot(x, y)
    assert flock.current_cm_s == pytest.approx(-0.5 * along.mean(), rel=1e-12)
    assert abs(flock.current_cm_s) > 0.01


@pytest.mark.parametrize("relaxation_s", [-1.0, math.nan, math.inf, 2e6])
def test_a_relaxation_time_out_of_range_is_refused(relaxation_s):
    with pytest.raises(ParameterError, match=r"current_relaxation_s.*at least 0"):
        flockenv.FlockParameters(current_relaxation_s=relaxation_s)
