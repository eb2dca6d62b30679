"""Law: a recording is what a flock does, or it is refused."""

import copy
import dataclasses
import math
import pickle

import numpy as np
import pytest

import flockenv
from flockenv import FlockParameters, OrderSeries, ParameterError, simulate
from flockenv.order import RECORDED

PARAMETERS = FlockParameters(n_boats=5, n_leaders=1, pool="narrow")
RUN = simulate(PARAMETERS, seed=3, duration_s=1.0)


class Rudders:
    """A rudder that grows with each decision."""

    def __init__(self, rudder: float, growth: float = 0.0) -> None:
        self.rudder, self.growth = rudder, growth

    def predict(self, observation, state=None):
        self.rudder += self.growth
        return np.full((len(observation), 1), self.rudder), state


def test_shapes_and_dtypes():
    assert RUN.time_s.tolist() == [k / 10 for k in range(11)]
    assert RUN.phase.tolist() == ["fw"] * 11
    assert RUN.in_analysis_window.tolist() == [False] * 10 + [True]
    assert RUN.pose.shape == RUN.velocity.shape == (11, 5, 3)
    assert RUN.pose.dtype == RUN.velocity.dtype == np.float64
    assert all(len(getattr(RUN.order, name)) == 11 for name in ("psi_o", "c_v"))
    assert (RUN.parameters, RUN.seed, RUN.version) == (PARAMETERS, 3, flockenv.__version__)
    assert repr(RUN) == "<flockenv.Recording of 5 boats, seed 3, 11 samples to 1.0 s>"


@pytest.mark.parametrize(
    ("duration_s", "sample_hz", "samples"),
    [
        (0, 10, 1),
        (0.29, 100, 30),
        (0.3, 10, 4),
        (0.35, 10, 4),
        (1, 3, 4),
        (1, 0.1, 1),
        (1, 1e-300, 1),
    ],
)
def test_samples_are_taken_up_to_and_including_the_end(duration_s, sample_hz, samples):
    assert len(simulate(PARAMETERS, 1, duration_s, sample_hz)) == samples


def test_float32_rounds_what_is_stored_and_not_the_run():
    run = simulate(PARAMETERS, seed=3, duration_s=1.0, dtype="float32")
    assert run.pose.dtype == run.velocity.dtype == np.float32
    assert np.array_equal(run.pose, RUN.pose.astype(np.float32))
    assert run.order == RUN.order
    assert run != RUN


@pytest.mark.parametrize(
    "change",
    [
        {"count": np.array([1, 2])},
        {"i": np.array([0, 5, 1], np.int32)},
        {"j": np.array([-3, 1, 1], np.int32)},
        {"force": np.array([1, 0, 1], np.float32)},
        {"force": np.ones(3)},
        {"normal": np.full((3, 2), np.nan, np.float32)},
        {"count": np.array([2**62, 2**62] + [0] * 8 + [3])},
    ],
)
def test_contacts_that_cannot_be_are_refused(change):
    good = {
        "count": np.array([3] + [0] * 10),
        "i": np.zeros(3, np.int32),
        "j": np.ones(3, np.int32),
        "normal": np.ones((3, 2), np.float32),
        "force": np.ones(3, np.float32),
        "point_cm": np.ones((3, 2), np.float32),
        "along_cm": np.ones(3, np.float32),
    }
    dataclasses.replace(RUN, contacts=flockenv.ContactSeries(**good))
    with pytest.raises(ParameterError, match=f"contacts.{next(iter(change))}"):
        dataclasses.replace(RUN, contacts=flockenv.ContactSeries(**good | change))


def test_the_law_by_name_is_no_policy():
    assert simulate(PARAMETERS, 3, 1.0, policy="paper's law at every substep") == RUN


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"duration_s": -1}, "duration_s"),
        ({"duration_s": math.nan}, "duration_s"),
        ({"duration_s": math.inf}, "duration_s"),
        ({"duration_s": 1e10}, "duration_s"),
        ({"sample_hz": 0}, "sample_hz"),
        ({"sample_hz": -1}, "sample_hz"),
        ({"sample_hz": math.nan}, "sample_hz"),
        ({"sample_hz": 1e7}, "sample_hz"),
        ({"duration_s": 1e9, "sample_hz": 1e6}, "samples of 5 boats"),
        ({"duration_s": 1e6, "sample_hz": 1e3}, "samples of 5 boats"),
        ({"seed": -1}, "seed"),
        ({"policy": "PPO"}, "policy"),
        ({"policy": object()}, "policy"),
        ({"policy": Rudders(math.nan)}, "rudder"),
        ({"policy": Rudders(0.0), "control_hz": 0.0}, "control_hz"),
        ({"dtype": "int32"}, "dtype"),
        ({"parameters": PARAMETERS.replace(n_boats=200)}, "n_boats"),
    ],
)
def test_runs_that_cannot_be_are_refused(change, name):
    arguments = {"parameters": PARAMETERS, "seed": 1, "duration_s": 1.0} | change
    with pytest.raises(ParameterError, match=name):
        simulate(**arguments)


@pytest.mark.parametrize("name", ["parameters", "seed", "duration_s", "sample_hz"])
@pytest.mark.parametrize("value", ["1", None, [1]])
def test_arguments_of_a_wrong_type_are_type_errors(name, value):
    arguments = {"parameters": PARAMETERS, "seed": 1, "duration_s": 1.0} | {name: value}
    with pytest.raises(TypeError, match=name):
        simulate(**arguments)


def test_recordings_pickle_and_copy():
    for other in (pickle.loads(pickle.dumps(RUN)), copy.deepcopy(RUN), copy.copy(RUN)):
        assert other == RUN
    assert pickle.loads(pickle.dumps(simulate)) is simulate


@pytest.mark.parametrize("change", [
    {"pose": RUN.pose[:, :4]},
    {"pose": RUN.pose.astype(int)},
    {"pose": RUN.pose.tolist()},
    {"velocity": RUN.velocity.astype(np.float32)},
    {"velocity": np.full_like(RUN.velocity, np.nan)},
    {"pose": np.full_like(RUN.pose, 1e300)},
    {"velocity": np.full_like(RUN.velocity, -2e9)},
    {"order": dataclasses.replace(RUN.order, psi_o=RUN.order.psi_o + 1.0)},
    {"order": dataclasses.replace(RUN.order, phi_v=RUN.order.phi_v - 7.0)},
    {"time_s": RUN.time_s[::-1].copy()},
    {"time_s": RUN.time_s - 1},
    {"time_s": RUN.time_s[:0]},
    {"duration_s": 0.95},
    {"duration_s": 1e300},
    {"duration_s": -1.0},
    {"phase": np.array(["up"] * 11)},
    {"phase": np.array(["up"] * 11, dtype="<U4")},
    {"in_analysis_window": np.zeros(11)},
    {"parameters": PARAMETERS.replace(n_boats=6)},
    {"order": OrderSeries(RUN.order.psi_o)},
    {"seed": -1},
    {"seed": 2**64},
])  # fmt: skip
def test_recordings_that_cannot_be_are_refused(change):
    with pytest.raises(ParameterError):
        dataclasses.replace(RUN, **change)


def test_contacts_stay_with_their_samples():
    run = simulate(PARAMETERS.replace(n_boats=20), 3, 20.0, 4.0, contacts=True)
    late = run.analyzed()
    first = np.concatenate([[0], np.cumsum(run.contacts.count)])
    at = 0
    for place in np.flatnonzero(np.isin(run.time_s, late.time_s)):
        span = slice(first[place], first[place + 1])
        count = run.contacts.count[place]
        assert np.array_equal(late.contacts.force[at : at + count], run.contacts.force[span])
        at += count
    assert at == len(late.contacts.i) > 0


def test_a_run_goes_on_from_a_snapshot_with_the_same_bits():
    whole = flockenv.simulate(PARAMETERS, 3, 60.0)
    flock = flockenv.Flock(PARAMETERS, 3)
    flock.advance(40.0)
    rest = flockenv.simulate(PARAMETERS, 3, 20.0, start=flock.snapshot())
    assert rest.time_s[0] == 40.0
    assert np.array_equal(rest.time_s, whole.time_s[400:])
    assert np.array_equal(rest.pose, whole.pose[400:])
    assert rest.order == flockenv.OrderSeries(
        *(getattr(whole.order, each.name)[400:] for each in RECORDED)
    )


def test_a_start_that_the_flock_cannot_have_is_refused():
    snapshot = flockenv.Flock(PARAMETERS, 3).snapshot()
    pose = flockenv.Flock(PARAMETERS, 3).pose
    for start, match in (
        (snapshot[:-1], "snapshot"),
        ({"pose": pose[:-1]}, "pose"),
        ({"pose": pose, "speed": 1.0}, "speed"),
        ({"velocity": np.zeros_like(pose)}, "without pose"),
        ({"pose": pose * 0.0 + [60.0, 0.0, 0.0]}, "overlap"),
        ({"pose": pose * 0.0}, "center in the water"),
        ({"pose": pose, "time_s": -1.0}, "time_s"),
    ):
        with pytest.raises(flockenv.FlockError, match=match):
            flockenv.simulate(PARAMETERS, 3, 1.0, start=start)
    with pytest.raises(flockenv.ParameterError, match="other parameters"):
        flockenv.simulate(PARAMETERS.replace(bw_s=0.9), 3, 1.0, start=snapshot)
    with pytest.raises(flockenv.ParameterError, match="seed = 4 is not accepted"):
        flockenv.simulate(PARAMETERS, 4, 1.0, start=snapshot)
    with pytest.raises(TypeError, match="dictionary with pose and"):
        flockenv.simulate(PARAMETERS, 3, 1.0, start="snapshot")


def test_a_recording_reports_its_flock_at_a_time():
    run = flockenv.simulate(PARAMETERS, 3, 10.0, dtype=np.float32)
    for time_s, sample in ((0.0, 0), (5.05, 50), (10.0, 100)):
        flock = run.flock_at(time_s)
        assert flock.time_s == run.time_s[sample]
        assert flock.phase == run.phase[sample]
        assert np.array_equal(flock.pose, run.pose[sample].astype(float))
        assert np.array_equal(flock.velocity, run.velocity[sample].astype(float))
    for time_s in (-0.1, 10.1, np.nan):
        with pytest.raises(flockenv.ParameterError, match=r"from 0\.0 to 10\.0 s"):
            run.flock_at(time_s)


def test_rudders_under_the_law_are_those_of_the_poses():
    run = simulate(PARAMETERS, 3, 10.0)
    assert run.rudder.shape == (101, 1)
    for sample in (0, 37, 100):
        assert np.array_equal(run.rudder[sample], run.flock_at(run.time_s[sample]).steering_law())


def test_rudders_of_a_policy_are_those_held_up_to_each_time():
    run = simulate(PARAMETERS, 3, 1.0, 4.0, policy=Rudders(0.0, 0.25), control_hz=2.0)
    assert run.rudder[:, 0].tolist() == [0.0, 0.25, 0.25, 0.5, 0.5]
