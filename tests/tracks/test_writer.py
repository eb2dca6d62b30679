"""What is exported is read back the same, here and by other programs."""

import numpy as np
import pytest

import flockenv
from flockenv.tracks import export, read_tracks

from .conftest import LAYOUT, PARAMETERS, read_and_counted


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_tables_are_read_back(seen, tmp_path, suffix):
    written = export(seen.truth, tmp_path / f"run{suffix}")
    assert [path.name for path in written] == [f"run{suffix}", "run.toml"]
    recording, report = read_and_counted(written[0])
    assert report.samples == seen.truth.pose[..., 0].size
    assert np.allclose(recording.time_s, seen.truth.time_s, atol=1e-12)
    assert np.array_equal(recording.pose, seen.truth.pose)
    assert recording.parameters.n_leaders == PARAMETERS.n_leaders
    assert (recording.order.psi_o == seen.truth.order.psi_o).all()


@pytest.mark.parametrize("sample_hz", [0.5, 1.0, 2.0])
def test_tables_at_whole_seconds_are_read_back(tmp_path, sample_hz):
    run = flockenv.simulate(PARAMETERS, 1, 20.0, sample_hz)
    again = read_tracks(export(run, tmp_path / "run.csv")[0])
    assert np.array_equal(again.time_s, run.time_s)
    assert np.array_equal(again.pose, run.pose)


def test_a_layout_that_is_there_is_kept(seen, tmp_path):
    (tmp_path / "run.toml").write_text('pool = "narrow"  # measured on 3 May\n')
    for ending in (".csv", ".parquet"):
        with pytest.raises(flockenv.ParameterError, match=r"run\.toml already exists"):
            export(seen.truth, tmp_path / f"run{ending}")
    assert [path.name for path in tmp_path.iterdir()] == ["run.toml"]
    assert "measured on 3 May" in (tmp_path / "run.toml").read_text()
    export(seen.truth, tmp_path / "run.csv", overwrite=True)
    # What says the same is not another layout.
    export(seen.truth, tmp_path / "run.csv")
    export(seen.truth, tmp_path / "run.parquet")
    with pytest.raises(flockenv.ParameterError, match="with another layout"):
        export(flockenv.simulate(PARAMETERS.replace(n_leaders=1), 1, 1.0), tmp_path / "run.csv")


def test_tracked_boats_keep_their_names(seen, tmp_path):
    tracked = read_tracks(seen.table, LAYOUT)
    again = read_tracks(export(tracked, tmp_path / "run.csv")[0])
    assert again.ids.tolist() == tracked.ids.tolist()
    assert np.allclose(again.pose, tracked.pose, atol=1e-9, equal_nan=True)


def test_gsd_agrees_with_freud(seen, tmp_path):
    hoomd = pytest.importorskip("gsd.hoomd")
    freud = pytest.importorskip("freud")
    (path,) = export(seen.truth, tmp_path / "run.gsd")
    with hoomd.open(str(path), "r") as file:
        assert len(file) == len(seen.truth)
        for sample in (0, 100, len(file) - 1):
            frame = file[sample]
            pose = seen.truth.pose[sample]
            assert frame.log["time_s"] == seen.truth.time_s[sample]
            assert np.allclose(frame.particles.position[:, :2], pose[:, :2], atol=1e-4)
            assert frame.particles.typeid.tolist() == [1, 1] + [0] * 18
            _check_nematic(freud, frame, seen.truth.order.nematic[sample])


def _check_nematic(freud, frame, expected):
    """Compare freud's nematic order of the normal boats' orientations with ours.

    Ours is of angles in the local frame, so that each boat is turned about the pool's center onto
    the x axis. Freud's is of three dimensions: of vectors in a plane whose nematic order there is
    Ψ its greatest eigenvalue is (3 Ψ + 1) / 4.
    """
    particles = frame.particles
    normal = particles.typeid == 0
    w, z = particles.orientation[normal, 0], particles.orientation[normal, 3]
    heading = 2 * np.arctan2(z, w)
    place = np.arctan2(*particles.position[normal, :2].T[::-1])
    local = heading - place
    vectors = np.stack([np.cos(local), np.sin(local), 0 * local], axis=1).astype(np.float32)
    nematic = freud.order.Nematic()
    nematic.compute(vectors)
    assert nematic.order == pytest.approx((3 * expected + 1) / 4, abs=1e-4)


def test_a_boat_that_is_not_there_is_in_no_frame(seen, tmp_path):
    hoomd = pytest.importorskip("gsd.hoomd")
    tracked = read_tracks(seen.table, LAYOUT)
    (path,) = export(tracked, tmp_path / "run.gsd")
    with hoomd.open(str(path), "r") as file:
        counts = np.array([frame.particles.N for frame in file])
    assert (counts == np.isfinite(tracked.pose[..., 0]).sum(axis=1)).all()
    assert counts.min() < 20


def test_other_endings_and_runs_without_poses_are_refused(seen, tmp_path):
    for recording, name, error, words in (
        (seen.truth, "run.xlsx", flockenv.ParameterError, r"ends in \.csv, \.parquet, \.gsd"),
        (seen.truth.without_poses(), "run.csv", flockenv.ParameterError, "no poses to export"),
        ("run.npz", "run.csv", TypeError, "recording must be a Recording"),
    ):
        with pytest.raises(error, match=words):
            export(recording, tmp_path / name)
    assert not list(tmp_path.iterdir())
