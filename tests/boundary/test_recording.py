"""Law: a recording is what a flock does; a file gives back the same one or a named error."""

import contextlib
import copy
import dataclasses
import math
import pickle
import re
import tempfile
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import flockenv
from flockenv import (
    Flock,
    FlockError,
    FlockParameters,
    OrderSeries,
    ParameterError,
    Recording,
    simulate,
)
from flockenv.recording import RECORDED

PARAMETERS = FlockParameters(n_boats=5, n_leaders=1, pool="table-1")
RUN = simulate(PARAMETERS, seed=3, duration_s=1.0)


def saved(recording=RUN, **options) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        recording.save(Path(folder, "run.npz"), **options)
        return Path(folder, "run.npz").read_bytes()


def load(blob: bytes) -> Recording:
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "run.npz").write_bytes(blob)
        return Recording.load(Path(folder, "run.npz"))


def test_shapes_and_dtypes():
    assert RUN.time_s.tolist() == [k / 10 for k in range(11)]
    assert RUN.phase.tolist() == ["fw"] * 11
    assert RUN.in_analysis_window.tolist() == [False] * 10 + [True]
    assert RUN.pose.shape == RUN.velocity.shape == (11, 5, 3)
    assert RUN.pose.dtype == RUN.velocity.dtype == np.float64
    assert all(len(getattr(RUN.order, name)) == 11 for name in ("psi_o", "c_v"))
    assert (RUN.parameters, RUN.seed, RUN.version) == (PARAMETERS, 3, flockenv.__version__)
    assert repr(RUN) == "<flockenv.Recording of 5 boats, seed 3, 11 samples to 1.0 s>"


def test_samples_are_the_flock_at_those_times():
    flock = Flock(PARAMETERS, seed=3)
    run = simulate(PARAMETERS, seed=3, duration_s=6.0, sample_hz=2.0)
    for k in range(13):
        assert np.array_equal(run.pose[k], flock.pose)
        assert np.array_equal(run.velocity[k], flock.velocity)
        assert run.order[k] == flock.order_parameters()
        assert run.phase[k] == flock.phase
        flock.advance(0.5)


def test_the_analysis_window_is_late_fw_and_early_nop1():
    run = simulate(PARAMETERS, seed=3, duration_s=4.3, sample_hz=4.0)
    assert run.time_s[run.in_analysis_window].tolist() == [1.0, 1.25, 1.5, 1.75, 2.0, 2.25]


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


def test_undefined_order_parameters_are_nan():
    pair = simulate(PARAMETERS.replace(n_boats=2), 1, 1.0).order
    assert np.isnan(pair.c_o).all()
    assert np.isfinite(pair.psi_o).all()
    leaders = simulate(PARAMETERS.replace(n_leaders=5), 1, 1.0)
    assert np.isnan(leaders.order.psi_o).all()
    assert load(saved(leaders)) == leaders


def test_contacts_are_the_flocks_that_carried_a_force():
    crowd = PARAMETERS.replace(n_boats=20, bw_s=0.0)
    run = simulate(crowd, seed=3, duration_s=10.0, sample_hz=2.0, contacts=True)
    assert run.contacts.count.sum() == len(run.contacts.i) > 50
    flock = Flock(crowd, seed=3)
    seen = []
    for k in range(21):
        seen.append(flock.contacts())
        assert run.contacts.count[k] == (seen[-1].force > 0).sum()
        flock.advance(0.5)
    assert run.contacts == flockenv.ContactSeries.of(seen)
    assert load(saved(run)) == run
    alone = simulate(crowd, seed=3, duration_s=10.0, sample_hz=2.0)
    assert alone.contacts is None
    assert np.array_equal(alone.pose, run.pose)


def test_contacts_under_a_policy():
    crowd = PARAMETERS.replace(n_boats=20, bw_s=0.0)
    law = flockenv.policies.SteeringLaw()
    run = simulate(crowd, seed=3, duration_s=10.0, policy=law, contacts=True)
    assert len(run.contacts.i) > 200
    assert load(saved(run)) == run


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
    }
    dataclasses.replace(RUN, contacts=flockenv.ContactSeries(**good))
    with pytest.raises(ParameterError, match=f"contacts.{next(iter(change))}"):
        dataclasses.replace(RUN, contacts=flockenv.ContactSeries(**good | change))


def test_the_law_by_name_is_no_policy():
    assert simulate(PARAMETERS, 3, 1.0, policy="law") == RUN


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


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_a_file_gives_back_the_same(tmp_path, compressed, dtype):
    run = simulate(PARAMETERS.replace(pool=(math.inf, 0)), 2**64 - 1, 1.0, dtype=dtype)
    run.save(tmp_path / "run.npz", compressed=compressed)
    assert Recording.load(tmp_path / "run.npz") == run
    assert [path.name for path in tmp_path.iterdir()] == ["run.npz"]


def test_a_file_is_readable_without_flockenv(tmp_path):
    RUN.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz", allow_pickle=False) as arrays:
        assert np.array_equal(arrays["pose"], RUN.pose)
        assert np.array_equal(arrays["order_psi_o"], RUN.order.psi_o)
        assert FlockParameters.from_toml(str(arrays["parameters"])) == PARAMETERS


def test_the_same_recording_makes_the_same_bytes():
    assert saved() == saved()


def test_a_failed_save_leaves_what_was_there(tmp_path, monkeypatch):
    path = tmp_path / "run.npz"
    RUN.save(path)
    before = path.read_bytes()

    def fail(file, **arrays):
        file.write(b"half")
        raise OSError("disk full")

    monkeypatch.setattr(np, "savez", fail)
    with pytest.raises(OSError, match="disk full"):
        RUN.save(path)
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["run.npz"]


def test_a_missing_file_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        Recording.load(tmp_path / "none.npz")
    with pytest.raises(FileNotFoundError):
        RUN.save(tmp_path / "none" / "run.npz")


@pytest.mark.parametrize("change", [
    {"pose": RUN.pose[:, :4]},
    {"pose": RUN.pose.astype(int)},
    {"pose": RUN.pose.tolist()},
    {"velocity": RUN.velocity.astype(np.float32)},
    {"velocity": np.full_like(RUN.velocity, np.nan)},
    {"time_s": RUN.time_s[::-1].copy()},
    {"time_s": RUN.time_s - 1},
    {"time_s": RUN.time_s[:0]},
    {"duration_s": 0.95},
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


@pytest.mark.parametrize("blob", [b"", b"text", b"PK\x03\x04", bytes(1000), b"flockst1" * 20])
def test_foreign_files_are_refused(blob):
    with pytest.raises(ParameterError, match=r"run\.npz is no whole, unharmed \.npz file"):
        load(blob)


def with_arrays(**changes) -> bytes:
    """The saved recording with some arrays replaced, or left out where None."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "run.npz")
        RUN.save(path)
        with np.load(path, allow_pickle=False) as arrays:
            kept = dict(arrays) | changes
        np.savez(path, **{name: array for name, array in kept.items() if array is not None})
        return path.read_bytes()


@pytest.mark.parametrize("change", [
    {"pose": None},
    {"extra": np.zeros(3)},
    {"seed": np.array(-1)},
    {"seed": np.array([1, 2], np.uint64)},
    {"format": np.array("flockenv recording 4")},
    {"version": np.zeros(3)},
    {"policy": np.zeros(3)},
    {"duration_s": np.array("long")},
    {"duration_s": None},
    {"parameters": np.array("n_boats = 'many'")},
    {"parameters": np.array("n_boat = 5")},
    {"parameters": np.array("{")},
    {"pose": RUN.pose[:, :3]},
    {"order_psi_o": np.array(["a"] * 11)},
])  # fmt: skip
def test_files_of_something_else_are_refused(change):
    with pytest.raises(ParameterError, match=r"run\.npz is no recording of flockenv"):
        load(with_arrays(**change))


def test_analyzed_samples_are_those_of_the_window_after_a_share_of_the_run():
    run = simulate(PARAMETERS, seed=3, duration_s=40.0, sample_hz=4.0, contacts=True)
    for after, start_s in ((0.1, 4.0), (0.5, 20.0), (0.0, 0.0)):
        frames = run.in_analysis_window & (run.time_s > start_s)
        late = run.analyzed(after) if after != 0.1 else run.analyzed()
        assert 0 < frames.sum() == len(late) == len(late.order)
        assert np.array_equal(late.time_s, run.time_s[frames])
        assert np.array_equal(late.phase, run.phase[frames])
        assert np.array_equal(late.pose, run.pose[frames])
        assert np.array_equal(late.order.phi_o, run.order.phi_o[frames])
        assert late.duration_s == 40.0
        assert load(saved(late)) == late
        # What is left out stays out: the rule counts from the start of the run.
        assert late.analyzed(after) == late


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


def test_a_recording_may_have_no_samples_and_no_poses():
    bare = RUN.without_poses()
    assert (bare.has_poses, RUN.has_poses) == (False, True)
    assert bare.pose.shape == (11, 0, 3)
    assert bare.order == RUN.order
    nothing = bare.analyzed(after=1.0)
    assert (len(nothing), nothing.duration_s) == (0, 1.0)
    assert load(saved(nothing)) == nothing


class Waiting:
    """A policy of a user's own, without a name."""

    def predict(self, observation, state=None, episode_start=None):
        return np.zeros(PARAMETERS.n_leaders), state


def test_what_steered_is_recorded():
    learned = flockenv.policies.load("learned", pool="table-1")
    tuned = flockenv.policies.DampedLaw(gain=2.0)
    named = {
        "law": None,
        repr(tuned): tuned,
        "Waiting": Waiting(),
        f"{learned!r} {learned.digest}": learned,
    }
    for name, policy in named.items():
        run = simulate(PARAMETERS, 3, 1.0, policy=policy)
        assert run.policy == name
        assert load(saved(run)).policy == name
    assert re.fullmatch(r"sha256:[0-9a-f]{12}", learned.digest)


def test_the_digest_is_that_of_the_numbers(tmp_path):
    policy = flockenv.policies.load("learned", pool="table-1")
    policy.save(tmp_path / "copy.npz")
    copied = flockenv.policies.load(tmp_path / "copy.npz")
    assert copied.digest == policy.digest
    assert flockenv.policies.load("learned", pool="500-boats").digest != policy.digest


def test_pickled_objects_are_never_loaded(tmp_path):
    class Trap:
        def __reduce__(self):
            return Path.touch, (tmp_path / "executed",)

    blob = with_arrays(pose=np.array([Trap()], dtype=object))
    with pytest.raises(ParameterError):
        load(blob)
    assert not (tmp_path / "executed").exists()


@pytest.mark.parametrize("shape", [(10**15,), (-1,), (2**62, 4), (10**6, 10**6)])
@pytest.mark.parametrize("compression", [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED])
def test_headers_that_claim_the_world_are_refused(tmp_path, shape, compression):
    header = str({"descr": "<f8", "fortran_order": False, "shape": shape}).encode()
    entry = b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header
    with zipfile.ZipFile(tmp_path / "run.npz", "w", compression) as archive:
        archive.writestr("pose.npy", entry)
    with pytest.raises(ParameterError):
        Recording.load(tmp_path / "run.npz")


@given(st.sampled_from([False, True]), st.floats(0, 1, exclude_max=True))
def test_cut_off_files_are_refused(compressed, fraction):
    blob = saved(compressed=compressed)
    with pytest.raises(ParameterError):
        load(blob[: int(fraction * len(blob))])


@settings(max_examples=300)
@given(st.sampled_from([False, True]), st.floats(0, 1, exclude_max=True), st.integers(0, 7))
def test_flipped_bits_give_the_same_recording_or_a_named_error(compressed, fraction, bit):
    blob = bytearray(saved(compressed=compressed))
    blob[int(fraction * len(blob))] ^= 1 << bit
    with contextlib.suppress(FlockError):
        assert load(bytes(blob)) == RUN


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


def test_a_run_starts_where_it_is_given():
    begun = flockenv.simulate(PARAMETERS, 3, 10.0)
    state = {"pose": begun.pose[-1], "velocity": begun.velocity[-1], "time_s": 10.0}
    state["allow_overlap"] = True
    law = flockenv.policies.SteeringLaw()
    for policy in (None, law):
        run = flockenv.simulate(PARAMETERS, 4, 5.0, policy=policy, start=state)
        assert np.array_equal(run.pose[0], begun.pose[-1])
        assert run.time_s[[0, -1]].tolist() == [10.0, 15.0]
    flock = flockenv.Flock(PARAMETERS, 4)
    flock.set_state(begun.pose[-1], begun.velocity[-1], 10.0, allow_overlap=True)
    flock.advance(5.0)
    again = flockenv.simulate(PARAMETERS, 4, 5.0, 0.2, start=state)
    assert np.array_equal(again.pose[-1], flock.pose)


def test_a_start_that_the_flock_cannot_have_is_refused():
    snapshot = flockenv.Flock(PARAMETERS, 3).snapshot()
    pose = flockenv.Flock(PARAMETERS, 3).pose
    for start, match in (
        (snapshot[:-1], "snapshot"),
        ({"pose": pose[:-1]}, "pose"),
        ({"pose": pose, "speed": 1.0}, "speed"),
        ({"velocity": np.zeros_like(pose)}, "without pose"),
        ({"pose": pose * 0.0}, "overlap"),
        ({"pose": pose, "time_s": -1.0}, "time_s"),
    ):
        with pytest.raises(flockenv.FlockError, match=match):
            flockenv.simulate(PARAMETERS, 3, 1.0, start=start)
    with pytest.raises(flockenv.ParameterError, match="other parameters"):
        flockenv.simulate(PARAMETERS.replace(bw_s=0.9), 3, 1.0, start=snapshot)
    with pytest.raises(flockenv.ParameterError, match="seed = 4 is not accepted"):
        flockenv.simulate(PARAMETERS, 4, 1.0, start=snapshot)
    with pytest.raises(TypeError, match="snapshot or a dictionary"):
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
    class Rising:
        def __init__(self):
            self.calls = 0

        def predict(self, observation, state=None):
            self.calls += 1
            return np.full((1, 1), self.calls / 4), state

    run = simulate(PARAMETERS, 3, 1.0, 4.0, policy=Rising(), control_hz=2.0)
    assert run.rudder[:, 0].tolist() == [0.0, 0.25, 0.25, 0.5, 0.5]


def test_rudders_are_saved_checked_and_may_be_missing():
    assert np.array_equal(load(saved()).rudder, RUN.rudder)
    without = dataclasses.replace(RUN, rudder=None)
    assert load(saved(without)).rudder is None
    assert load(saved(without)) == without != RUN
    for rudder in (
        RUN.rudder[:-1],
        RUN.rudder.astype(np.float32),
        RUN.rudder + 2,
        RUN.rudder * np.nan,
    ):
        with pytest.raises(ParameterError, match="rudder"):
            dataclasses.replace(RUN, rudder=rudder)
