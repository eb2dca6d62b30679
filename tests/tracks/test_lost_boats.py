"""What trackers write for a boat they lost is not a boat: it is left out, and counted by boat."""

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.tracks import TrackLayout, read_tracks, recording_of

from .conftest import LAYOUT, PIXEL_CM, but, read_and_counted

LOST = {"boat4": (200, 420), "boat9": (100, 350)}
"""The frames in which two of the boats are lost."""


def lost_rows(table):
    frame = table["frame"]
    return sum(
        (table["track"] == name) & frame.between(*frames) for name, frames in LOST.items()
    ).astype(bool)


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"x_px": 0.0, "y_px": 0.0}, "outside the water"),
        ({"x_px": -1.0, "y_px": -1.0}, "outside the water"),
        ({"x_px": -1.0, "y_px": -1.0, "angle": -1.0}, "outside the water"),
        ({"x_px": 812.0, "y_px": 604.5}, "outside the water"),
        ({"x_px": np.inf, "y_px": np.inf}, "without a position"),
        ({"x_px": np.inf, "y_px": np.inf, "angle": np.inf}, "without a position"),
        ({"x_px": np.nan}, "without a position"),
        ({"angle": np.inf}, "without a heading"),
        ({"angle": -np.inf}, "without a heading"),
        ({"angle": 9999.0}, "with a heading beyond a full turn"),
        ({"x_px": 1e300}, "outside the water"),
    ],
)
def test_a_lost_boat_is_none(seen, values, reason):
    lost = lost_rows(seen.table)
    expected = read_tracks(seen.table[~lost], LAYOUT)
    table = seen.table.astype({"x_px": float, "y_px": float, "angle": float})
    table.loc[lost, list(values)] = list(values.values())
    found, report = read_and_counted(table, LAYOUT)
    counts = seen.table[lost].groupby("track").size().to_dict()
    assert report.left_out == {reason: counts}
    assert f"{lost.sum()} rows ({lost.sum()} {reason}: boat9 " in str(report)
    assert (found.order.psi_o == expected.order.psi_o).all()
    assert np.array_equal(found.order.psi_v, expected.order.psi_v, equal_nan=True)


def test_a_point_in_the_water_is_said_and_can_be_left_out(seen):
    lost = lost_rows(seen.table)
    table = seen.table.copy()
    table.loc[lost, ["x_px", "y_px"]] = 512.0, 604.0
    _, report = read_and_counted(table, LAYOUT)
    assert report.left_out == {}
    assert set(report.stuck) >= set(LOST)
    x, y, count = report.stuck["boat4"]
    assert (x, y, count) == (512.0, 604.0, lost[table["track"] == "boat4"].sum())
    assert "the same point in many frames: " in str(report)
    found, report = read_and_counted(table, but(LAYOUT, lost=((512.0, 604.0),)))
    assert set(report.left_out) == {"at a point that stands for a lost boat"}
    assert (found.order.psi_o == read_tracks(seen.table[~lost], LAYOUT).order.psi_o).all()


def test_a_point_that_boats_share_is_said_sooner(seen):
    table = seen.table.copy()
    table.loc[table["frame"].between(300, 304) & table["track"].isin([*LOST]), ["x_px", "y_px"]] = (
        512.0,
        604.0,
    )
    _, report = read_and_counted(table, LAYOUT)
    assert report.stuck == dict.fromkeys(LOST, (512.0, 604.0, 5))


@pytest.mark.parametrize("number", [-1, 0])
def test_a_heading_that_is_held_is_said_and_can_be_left_out(seen, number):
    table = seen.table.astype({"angle": float})
    # As a tracker that does not round.
    table["angle"] = (table["angle"] + 1e-5 * np.arange(len(table))) % 360
    lost = lost_rows(seen.table)
    assert read_and_counted(table, LAYOUT)[1].held == {}
    assert read_and_counted(seen.table, LAYOUT)[1].held == {}
    table.loc[lost, "angle"] = number
    _, report = read_and_counted(table, LAYOUT)
    moving = table[lost].drop_duplicates(["track", "x_px", "y_px"]).groupby("track").size()
    assert report.held == {name: count for name, count in moving.items() if count >= 20}
    assert report.held
    assert "the same heading in many frames: boat" in str(report)
    if number < 0:
        _, report = read_and_counted(table, but(LAYOUT, missing=("-1",)))
        assert report.held == {}
        assert set(report.left_out) == {"without a heading"}


@pytest.mark.parametrize("count", [19, 20])
def test_a_heading_is_held_from_twenty_samples_on(count):
    k = np.arange(count + 10)
    heading = np.where(k < count, -2.0, 0.1 * (k - count))
    table = pd.DataFrame({"frame": k, "id": "a", "x": 50 + 0.5 * k, "y": 0.0, "heading": heading})
    _, report = read_and_counted(table, TrackLayout(pool=(100.0, 0.0), fps=10.0))
    assert report.held == ({"a": 20} if count == 20 else {})


def test_a_heading_that_never_changes_is_held_and_a_direction_of_motion_is_not():
    k = np.arange(30)
    parts = [
        pd.DataFrame({"frame": k, "id": n, "x": 50 + 0.5 * k, "y": 9.0 * int(n)}) for n in "12"
    ]
    table = pd.concat(parts, ignore_index=True).assign(heading=-2.0)
    layout = TrackLayout(pool=(100.0, 0.0), fps=10.0)
    assert read_and_counted(table, layout)[1].held == {"1": 30, "2": 30}
    still = table.assign(x=table["x"].where(table["id"] == "1", 50.0))
    assert read_and_counted(still, layout)[1].held == {"1": 30}
    assert read_and_counted(table, but(layout, heading=None))[1].held == {}


def test_a_boat_missing_for_a_short_step_has_a_gap():
    """On a clock of long and short steps, two of which are no longer than a step may be."""
    time = np.cumsum(np.tile([0.1, 0.02], 20))
    parts = [pd.DataFrame({"t": time, "id": n, "x": 50 + time, "y": 9.0 * n}) for n in range(2)]
    table = pd.concat(parts, ignore_index=True).assign(heading=0.0)
    layout = TrackLayout(pool=(100.0, 0.0), frame="t")
    assert read_and_counted(table, layout)[1].gaps == 0
    assert read_and_counted(table.drop(index=50), layout)[1].gaps == 1


@pytest.mark.parametrize("source", [{"x": [1.0]}, np.zeros(3), 3, None])
def test_what_is_no_table_or_layout_is_named(seen, source):
    with pytest.raises(TypeError, match="tracks must be a file, a DataFrame"):
        read_tracks(source, LAYOUT)
    with pytest.raises(TypeError, match="layout must be a TrackLayout"):
        read_tracks(seen.table, "tracks.toml" if source is None else source)


@pytest.mark.parametrize(
    "name", ["", "-1", "unassigned", "Unassigned", "None", "nan", "null", -1, "?"]
)
def test_what_is_assigned_to_nobody_is_no_boat(seen, name, tmp_path):
    extra = seen.table.iloc[::7].assign(
        track=name, x_px=600.0 + np.arange(len(seen.table[::7])) % 9
    )
    table = pd.concat([seen.table, extra]).sort_values("frame", kind="stable")
    table.to_csv(tmp_path / "tracks.csv", index=False)
    for source in (table, tmp_path / "tracks.csv"):
        found, report = read_and_counted(source, LAYOUT)
        assert report.left_out == {"without a name": {"": len(extra)}}
        assert found == read_tracks(seen.table, LAYOUT)


@pytest.mark.parametrize("name", ["NA", "N/A", "n/a", "#N/A", "NULL2", "1e5", "0x1", "True"])
def test_boats_whose_names_look_like_something_else_are_boats(seen, name, tmp_path):
    seen.table.replace({"track": {"boat7": name}}).to_csv(tmp_path / "tracks.csv", index=False)
    found, report = read_and_counted(tmp_path / "tracks.csv", LAYOUT)
    assert name in found.ids
    assert (len(found.ids), report.left_out) == (20, {})


def test_rows_that_are_there_twice_are_dropped_and_counted(seen):
    table = pd.concat([seen.table, seen.table.iloc[100:140]]).sort_values("frame", kind="stable")
    found, report = read_and_counted(table, LAYOUT)
    assert sum(report.left_out["that are repeated"].values()) == 40
    assert found == read_tracks(seen.table, LAYOUT)


def test_another_row_of_a_boat_in_a_frame_is_named_with_its_line(seen, tmp_path):
    other = seen.table.iloc[[100]].assign(x_px=700)
    table = pd.concat([seen.table[:101], other, seen.table[101:]])
    table.to_csv(tmp_path / "tracks.csv", index=False)
    with pytest.raises(flockenv.ParameterError, match=r"appears 2 times .* in line 103"):
        read_tracks(tmp_path / "tracks.csv", LAYOUT)


def test_boats_with_too_little_confidence_are_left_out(seen):
    lost = lost_rows(seen.table)
    table = seen.table.assign(score=np.where(lost, 0.2, 0.99))
    layout = but(LAYOUT, confidence="score", least_confidence=0.6)
    found, report = read_and_counted(table, layout)
    assert sum(report.left_out["with too little confidence"].values()) == lost.sum()
    assert found == read_tracks(seen.table[~lost], LAYOUT)
    with pytest.raises(flockenv.ParameterError, match="need each other"):
        but(LAYOUT, confidence="score")


def test_the_least_confidence_is_enough(seen):
    table = seen.table.assign(score=0.6)
    layout = but(LAYOUT, confidence="score", least_confidence=0.6)
    found, report = read_and_counted(table, layout)
    assert report.left_out == {}
    assert found == read_tracks(seen.table, LAYOUT)


def test_one_frame_that_nobody_is_in_is_a_gap(seen):
    frames = seen.table["frame"].unique()
    found, report = read_and_counted(seen.table[seen.table["frame"] != frames[50]], LAYOUT)
    _, before = read_and_counted(seen.table, LAYOUT)
    # Of each boat that is there on both sides of it.
    there = ~np.isnan(found.pose[49:51, :, 0]).any(axis=0)
    assert report.gaps == before.gaps + there.sum() > before.gaps
    # No velocity is taken across: at both sides it is that towards the other one.
    pose, velocity = found.pose[..., :2], found.velocity[..., :2]
    for sample, (early, late) in ((49, (48, 49)), (50, (50, 51))):
        expected = (pose[late] - pose[early]) / (found.time_s[late] - found.time_s[early])
        known = ~np.isnan(expected).any(axis=-1) & there
        np.testing.assert_allclose(velocity[sample][known], expected[known], rtol=1e-9)


def test_boat_frames_without_a_pose_are_counted(seen):
    lost = lost_rows(seen.table)
    _, report = read_and_counted(seen.table[~lost], LAYOUT)
    assert report.missing == seen.missing + lost.sum()
    assert f"missing: {report.missing} of 12020 boat-frames" in str(report)
    # Both are away in one stretch, and others for a frame here and there.
    assert report.longest_gap_s == pytest.approx(25.2, abs=0.3)
    assert report.gaps >= 3


def test_frames_that_nobody_is_in_count_for_every_boat(seen):
    table = seen.table[~seen.table["frame"].between(100, 399)]
    _, report = read_and_counted(table, LAYOUT)
    assert (report.frames, report.boats) == (301, 20)
    assert report.missing == 12020 - len(table)
    assert report.longest_gap_s == pytest.approx(30.1, abs=0.2)


def test_a_pool_that_is_elsewhere_is_refused(seen):
    for changes in ({"center": (0.0, 0.0)}, {"cm_per_unit": 1.0}, {"pool": "wide"}):
        with pytest.raises(flockenv.ParameterError, match="of the centers lie outside the pool"):
            read_tracks(seen.table, but(LAYOUT, **changes))


def test_arrays_with_a_boat_in_no_water_are_refused():
    pose = np.full((30, 2, 3), 80.0) * [1, 0, 0]
    for place in ((0.0, 0.0), (-1.0, -1.0), (101.0, 0.0)):
        pose[20:, 1, :2] = place
        with pytest.raises(flockenv.ParameterError, match=r"17% of the centers \(10\) lie outside"):
            recording_of(np.arange(30.0), pose, pool="narrow")
    # A hull's width beyond a wall is what a camera's errors and a tilted boat may make.
    for place in ((99.0, 0.0), (0.0, -39.0)):
        pose[20:, 1, :2] = place
        assert recording_of(np.arange(30.0), pose, pool="narrow").ids.tolist() == ["0", "1"]
    pose[20:, 1] = np.nan
    assert recording_of(np.arange(30.0), pose, pool="narrow").ids.tolist() == ["0", "1"]


def test_everything_in_no_water_is_named():
    table = pd.DataFrame({"frame": [0, 1, 2], "id": "a", "x": 0.0, "y": 0.0, "heading": 0.0})
    layout = TrackLayout(pool="narrow", fps=10.0)
    for rows, words in (
        (table, "heading in the water: 3 outside the water"),
        (table.assign(heading=np.nan, x=60.0), "water: 3 without a heading"),
        (table[:0], "there are no rows"),
    ):
        with pytest.raises(flockenv.ParameterError, match=words):
            read_tracks(rows, layout)


def test_centers_within_a_hull_of_a_wall_are_kept(seen):
    """Pixels and tilted hulls put centers beyond a wall; ten centimeters are a hull's width."""
    table = seen.table.astype({"x_px": float, "y_px": float})
    row = table["track"] == "boat5"
    for distance, is_kept in ((99.9, True), (100.3, False), (38.7, True), (38.2, False)):
        table.loc[row, "x_px"], table.loc[row, "y_px"] = 812.0 + distance / PIXEL_CM, 604.5
        _, report = read_and_counted(table, LAYOUT)
        assert report.left_out == ({} if is_kept else {"outside the water": {"boat5": row.sum()}})
