"""A recording of tracks is saved, sliced, drawn, tabled and replayed like a simulated one."""

import re
from dataclasses import replace

import numpy as np
import pytest

import flockenv
from flockenv.recording import Recording
from flockenv.statistics.structure import structure_series
from flockenv.tracks import read_tracks, recording_of

from .conftest import LAYOUT


@pytest.fixture(scope="module")
def tracked(seen):
    return read_tracks(seen.table, LAYOUT)


def test_it_is_saved_and_loaded(tracked, tmp_path):
    tracked.save(tmp_path / "tracks.npz")
    assert Recording.load(tmp_path / "tracks.npz") == tracked


def test_all_samples_after_the_first_tenth_are_analyzed_where_phases_are_not_known(tracked):
    assert (tracked.phase == "").all()
    assert len(tracked.analyzed()) == (tracked.time_s > 6.0).sum()


def test_tables_have_no_rows_of_boats_that_are_not_there(tracked):
    table = tracked.to_dataframe(boats=True)
    assert len(table) == np.isfinite(tracked.pose[..., 0]).sum() < tracked.pose[..., 0].size
    assert table["id"].iloc[0] == "boat1"


def test_datasets_have_units_and_names(tracked):
    pytest.importorskip("xarray")
    dataset = tracked.to_xarray()
    assert dataset["id"].values.tolist()[:2] == ["boat1", "boat2"]
    for name, unit in (
        ("x_cm", "cm"),
        ("velocity_x_cm_s", "cm s-1"),
        ("psi_v", "cm/s"),
        ("c_o", "1"),
    ):
        assert dataset[name].attrs["units"] == unit
    assert dataset["time_s"].attrs["units"] == "s"


def test_structure_leaves_out_boats_that_are_not_there(tracked):
    parameters = tracked.parameters
    missing = ~np.isfinite(tracked.pose[..., 0])
    sample = int((missing.sum(axis=1) == 1).argmax())
    there = tracked.pose[sample : sample + 1, ~missing[sample]]
    for name in ("largest_cluster", "on_outer_wall"):
        whole, alone = (structure_series(name, parameters, pose) for pose in (tracked.pose, there))
        assert whole[sample] == alone[0]
    nobody = np.full((1, 20, 3), np.nan)
    assert np.isnan(structure_series("largest_cluster", parameters, nobody)).all()


def test_phases_that_are_known_have_their_analysis_window():
    phase = ["fw"] * 4 + ["nop1"] * 2 + ["bw"] * 2
    pose = np.full((8, 2, 3), 90.0) * [1, 0, 0]
    recording = recording_of(np.arange(8.0), pose, pool="narrow", phase=phase)
    assert recording.in_analysis_window.tolist() == [False] * 2 + [True] * 3 + [False] * 3


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"pose": np.zeros((3, 2, 2))}, "pose has shape (3, 2, 2)"),
        ({"pose": np.zeros((2, 2, 3))}, "pose has shape (2, 2, 3), expected (3, 2, 3)"),
        ({"pose": np.full((3, 2, 3), np.nan)}, "NaN everywhere"),
        ({"pose": [[[0, 0, np.nan]] * 2] * 3}, "finite, except for missing boats"),
        ({"pose": np.full((3, 2, 3), np.inf)}, "pose must be finite, except for missing boats"),
        ({"pose": "here"}, "numbers"),
        ({"time_s": [0.0, 0.0, 1.0]}, "time_s must increase"),
        ({"velocity": np.zeros((3, 1, 3))}, "velocity has shape (3, 1, 3), expected (3, 2, 3)"),
        ({"phase": ["forward"] * 3}, 'phase = "forward" is not accepted'),
        ({"ids": ["a", "a"]}, "more than once"),
        ({"ids": ["a"]}, "1 names for 2 boats"),
        ({"leaders": ["c"]}, "'c' is not a leader among the ids"),
        ({"leaders": ["0", "0"]}, "more than once"),
        ({"hull": (-1.0, 0.5)}, "boat_radius_cm"),
        ({"target": "north"}, "north"),
        ({"discs": [(0, 0, -1)]}, "discs"),
    ],
)
def test_mistakes_are_named(changes, words):
    given = {
        "time_s": [0.0, 1.0, 2.0],
        "pose": np.full((3, 2, 3), 90.0) * [1, 0, 0],
        "pool": "narrow",
    }
    with pytest.raises(flockenv.ParameterError, match=re.escape(words)):
        recording_of(**(given | changes))


def test_names_may_be_gone_through_once_and_are_in_an_order():
    given = {"time_s": [0.0], "pose": np.full((1, 2, 3), 90.0) * [1, 0, 0], "pool": "narrow"}
    of_lists = recording_of(**given, ids=["a", "b"], leaders=["b"], phase=["fw"])
    found = recording_of(**given, ids=iter("ab"), leaders=iter("b"), phase=iter(["fw"]))
    assert found == of_lists
    for changes in ({"ids": {"a", "b"}}, {"ids": "ab"}, {"ids": {"a": 1}}, {"leaders": "0"}):
        with pytest.raises(TypeError, match="must be a sequence"):
            recording_of(**given, **changes)
    layout = flockenv.tracks.TrackLayout(
        pool=iter((90.0, 0.0)), target=iter(["cw"]), leaders=("a",)
    )
    assert (layout.pool, layout.target) == ((90.0, 0.0), ("cw",))
    assert of_lists.order.ordering_time([0.0]) == np.inf


def test_what_is_masked_is_not_there():
    pose = np.ma.masked_array(np.full((3, 2, 3), 90.0) * [1, 0, 0])
    pose[1, 0] = np.ma.masked
    recording = recording_of(np.arange(3.0), pose, pool="narrow")
    assert np.isnan(recording.pose[:, 0, 0]).tolist() == [False, True, False]


def test_simulated_recordings_still_hold_no_gaps(seen):
    pose = seen.truth.pose.copy()
    pose[3, 4] = np.nan
    with pytest.raises(flockenv.ParameterError, match="pose must be finite"):
        Recording(
            **{name: getattr(seen.truth, name) for name in seen.truth.__slots__} | {"pose": pose}
        )


@pytest.mark.parametrize(("missing", "target"), [([0], ("ccw",)), ([0, 1], "cw")])
def test_leaders_that_are_present_keep_their_targets(missing, target):
    parameters = flockenv.FlockParameters(n_boats=4, n_leaders=2, target=("cw", "ccw"))
    run = flockenv.simulate(parameters, 1, 1.0)
    pose, velocity = run.pose.copy(), run.velocity.copy()
    pose[:, missing] = velocity[:, missing] = np.nan
    ids = np.array(list("abcd"))
    tracked = replace(run, pose=pose, velocity=velocity, ids=ids, rudder=None)
    assert tracked.flock_at(0.5).parameters.target == target
