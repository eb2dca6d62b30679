"""Law: a recording's file gives back the same one or a named error; nothing in it is executed."""

import dataclasses
import math
import re
import tempfile
import warnings
import zipfile
from pathlib import Path

import numpy as np
import pytest

import flockenv
from flockenv import Flock, FlockParameters, ParameterError, Recording, simulate
from flockenv.order import RECORDED

PARAMETERS = FlockParameters(n_boats=5, n_leaders=1, pool="narrow")
RUN = simulate(PARAMETERS, seed=3, duration_s=1.0)


def saved(recording=RUN, **options) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        recording.save(Path(folder, "run.npz"), **options)
        return Path(folder, "run.npz").read_bytes()


def load(blob: bytes) -> Recording:
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "run.npz").write_bytes(blob)
        return Recording.load(Path(folder, "run.npz"))


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
    for name in ("i", "j", "normal", "force", "point_cm", "along_cm"):
        found = getattr(run.contacts, name)
        expected = np.concatenate([getattr(each, name)[each.force > 0] for each in seen])
        assert np.array_equal(found, expected.astype(found.dtype))
    assert load(saved(run)) == run
    alone = simulate(crowd, seed=3, duration_s=10.0, sample_hz=2.0)
    assert alone.contacts is None
    assert np.array_equal(alone.pose, run.pose)


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


def test_a_missing_file_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        Recording.load(tmp_path / "none.npz")
    with pytest.raises(FileNotFoundError):
        RUN.save(tmp_path / "none" / "run.npz")


def with_arrays(**changes) -> bytes:
    """The saved recording with some arrays replaced, or left out where None."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "run.npz")
        RUN.save(path)
        with np.load(path, allow_pickle=False) as arrays:
            stored = dict(arrays) | changes
        np.savez(path, **{name: array for name, array in stored.items() if array is not None})
        return path.read_bytes()


def test_a_file_of_this_version_is_read_and_written_as_the_same_arrays(tmp_path):
    # If the format changes: raise the version in its name, then write the file again.
    stored = Path(__file__).parents[1] / "fixtures" / "recording_1.npz"
    Recording.load(stored).save(tmp_path / "again.npz")
    with np.load(stored) as before, np.load(tmp_path / "again.npz") as after:
        # A quantity that was added since has been computed from the poses.
        added = {f"order_{each.name}" for each in RECORDED} - {*before}
        assert {*after} == {*before} | added
        # A parameter that was added since stands last.
        assert str(after["parameters"]).startswith(str(before["parameters"]))
        for name in {*before} - {"parameters"}:
            np.testing.assert_array_equal(before[name], after[name], strict=True)


def test_a_quantity_that_is_missing_is_computed_from_the_poses():
    for dtype in ("float64", "float32"):
        run = simulate(PARAMETERS, 3, 2.0, dtype=dtype)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "run.npz")
            run.save(path)
            with np.load(path) as arrays:
                left = {name: array for name, array in arrays.items() if "nematic" not in name}
            np.savez(path, **left)
            read = Recording.load(path)
        exact = {"float64": 1e-12, "float32": 1e-5}[dtype]
        assert read.order.nematic == pytest.approx(run.order.nematic, abs=exact)
        assert np.array_equal(read.order.psi_o, run.order.psi_o)


def test_without_poses_a_quantity_that_is_missing_is_undefined():
    columns = {"order_nematic": None, "pose": RUN.pose[:, :0], "velocity": RUN.velocity[:, :0]}
    with pytest.warns(flockenv.recording.RecordingWarning, match="they are NaN: order_nematic$"):
        read = load(with_arrays(**columns))
    assert np.isnan(read.order.nematic).all()
    assert np.array_equal(read.order.psi_o, RUN.order.psi_o)
    # What is there may not be undefined.
    half = np.where(np.arange(11) > 5, np.nan, RUN.order.nematic)
    with pytest.raises(ParameterError, match=r"order\.nematic must be finite"):
        load(with_arrays(**{**columns, "order_nematic": half}))


@pytest.mark.parametrize("name", ["pose.npy", "pose"])
def test_an_array_that_is_there_twice_is_refused(name, tmp_path):
    path = tmp_path / "run.npz"
    RUN.save(path)
    with zipfile.ZipFile(path, "a") as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        archive.writestr(name, archive.read("velocity.npy"))
    with pytest.raises(ParameterError, match="it holds 'pose' twice"):
        Recording.load(path)


def test_what_is_unknown_is_dropped_with_a_word():
    toml = PARAMETERS.to_toml() + "gravity = 9.81\n"
    later = with_arrays(order_new=np.zeros(11), extra=np.zeros(3), parameters=np.array(toml))
    with pytest.warns(flockenv.recording.RecordingWarning) as words:
        assert load(later) == RUN
    assert [str(each.message).rsplit(": ")[1] for each in words] == [
        "extra, order_new",
        "gravity",
    ]


def test_a_parameter_that_is_missing_has_its_default():
    lines = [line for line in PARAMETERS.to_toml().splitlines() if not line.startswith("c4 ")]
    assert len(lines) == len(PARAMETERS.to_dict()) - 1
    assert load(with_arrays(parameters=np.array("\n".join(lines)))) == RUN


def test_what_cannot_be_computed_is_named_where_it_is_missing():
    with pytest.raises(flockenv.recording.LayoutError, match="arrays are missing: pose, seed"):
        load(with_arrays(pose=None, seed=None))
    with pytest.raises(flockenv.recording.LayoutError, match="format = 'flockenv recording 9'"):
        load(with_arrays(format=np.array("flockenv recording 9"), pose=None))


@pytest.mark.parametrize("change", [
    {"pose": None},
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
    {"pose": np.zeros(3), "order_nematic": None},
    {"pose": np.array(["a"]), "order_nematic": None},
    {"time_s": np.zeros(()), "order_nematic": None},
    {"order_psi_o": np.array(["a"] * 11)},
])  # fmt: skip
@pytest.mark.filterwarnings("ignore::flockenv.recording.RecordingWarning")
def test_files_of_something_else_are_refused(change):
    with pytest.raises(ParameterError, match=r"run\.npz is not a recording of flockenv"):
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
    parameters = PARAMETERS.replace(pool="wide")
    learned = flockenv.policies.load("learned", pool="wide")
    tuned = flockenv.policies.DampedLaw(gain=2.0)
    named = {
        "paper's law at every substep": None,
        repr(tuned): tuned,
        "Waiting": Waiting(),
        f"{learned!r} {learned.digest}": learned,
    }
    for name, policy in named.items():
        run = simulate(parameters, 3, 1.0, policy=policy)
        assert run.policy == name
        assert load(saved(run)).policy == name
    assert re.fullmatch(r"sha256:[0-9a-f]{12}", learned.digest)


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


def test_the_sample_at_the_end_of_what_is_left_out_is_left_out_too():
    """A tenth of 15 s is 1.5 s, in the window from 1 to 2.5 s."""
    run = simulate(FlockParameters(n_boats=4), 1, 15.0, 10.0)
    assert run.in_analysis_window[[9, 10, 24, 25]].tolist() == [False, True, True, False]
    assert run.analyzed().time_s[0] == 1.6
    assert run.analyzed(0.0).time_s[0] == 1.0
