"""Tracks of a camera give back the run they were made of; what is wrong with a file is named."""

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.tracks import TrackLayout, guess_layout, read_layout, read_tracks

from .conftest import CENTER, LAYOUT, PIXEL_CM, read_and_counted


def test_a_camera_gives_back_the_run(seen):
    found, report = read_and_counted(seen.table, LAYOUT)
    assert report.samples == len(seen.table)
    assert report.samples + seen.missing == seen.truth.pose[..., 0].size
    assert (report.missing, report.broken, report.left_out) == (seen.missing, 0, {})
    assert 0.5 < report.cosine < 0.9
    assert found.ids.tolist() == [f"boat{number + 1}" for number in range(20)]
    assert found.parameters.n_leaders == 2
    assert np.allclose(found.time_s, seen.truth.time_s)
    there = np.isfinite(found.pose[..., 0])
    assert (~there).sum() == seen.missing
    error = without_turns(found.pose - seen.truth.pose)[there]
    # Half a pixel and half a degree.
    assert np.abs(error[:, :2]).max() <= 0.5 * PIXEL_CM + 1e-9
    assert np.abs(error[:, 2]).max() <= np.radians(0.5) + 1e-9
    assert np.isnan(found.velocity[~there]).all()


def without_turns(error):
    """Take away each boat's full turns, the same at all times, which are in no file."""
    turns = np.rint(np.nanmean(error[..., 2], axis=0) / (2 * np.pi))
    error[..., 2] -= 2 * np.pi * turns
    return error


def test_boats_that_are_all_there_have_the_very_order_parameters(seen):
    truth = seen.truth
    found = flockenv.tracks.recording_of(
        truth.time_s, truth.pose, pool="narrow", velocity=truth.velocity, phase=truth.phase,
        leaders=("0", "1"),
    )  # fmt: skip
    for name in ("psi_o", "phi_o", "c_o", "psi_v", "phi_v", "c_v", "nematic", "milling"):
        assert (getattr(found.order, name) == getattr(truth.order, name)).all()
    assert (found.phase == truth.phase).all()
    # Sampled phases place the middle of a phase to within a sample.
    assert np.mean(found.in_analysis_window != truth.in_analysis_window) < 0.05


def test_heading_from_two_key_points(seen):
    angle = np.radians(seen.table["angle"])
    table = seen.table.assign(
        xt=seen.table["x_px"] - 20 * np.cos(angle),
        yt=seen.table["y_px"] - 20 * np.sin(angle),
        xh=seen.table["x_px"] + 20 * np.cos(angle),
        yh=seen.table["y_px"] + 20 * np.sin(angle),
    )
    layout = TrackLayout(**{**fields(LAYOUT), "heading": ("xt", "yt", "xh", "yh")})
    by_points, by_angle = (read_tracks(table, each).pose for each in (layout, LAYOUT))
    assert np.nanmax(np.abs(without_turns(by_points - by_angle))) < 1e-9


def test_heading_from_motion():
    time_s = np.arange(0.0, 10.0, 0.1)
    angle = 0.1 * time_s
    table = pd.DataFrame(
        {"frame": time_s, "id": "a", "x": 100 * np.cos(angle), "y": 100 * np.sin(angle)}
    )
    found = read_tracks(table, TrackLayout(pool="wide", heading=None))
    # Counter-clockwise on a circle: a quarter turn ahead of the place.
    assert np.allclose(found.pose[1:-1, 0, 2], angle[1:-1] + np.pi / 2, atol=1e-6)
    expected = np.stack([-10 * np.sin(angle), 10 * np.cos(angle), 0.1 + 0 * angle], axis=1)
    assert np.allclose(found.velocity[2:-2, 0], expected[2:-2], atol=1e-3)


def fields(layout: TrackLayout) -> dict:
    return {name: getattr(layout, name) for name in layout.__slots__}


def line(**columns) -> pd.DataFrame:
    """Three robots that move at 10 cm/s along x, 10 frames."""
    frame, robot = np.divmod(np.arange(30), 3)
    table = {"frame": frame, "id": robot, "x": 1.0 * frame, "y": 20.0 * robot, "heading": 0.0}
    return pd.DataFrame({**table, **columns})


OPEN = TrackLayout(pool=(180.0, 0.0), fps=10.0)


@pytest.mark.parametrize(("frame", "steps"), [(0, 1), (4, 2), (9, 1)])
def test_a_jump_is_counted_and_gives_no_velocity(frame, steps):
    table = line()
    table.loc[(table["frame"] == frame) & (table["id"] == 1), "x"] = 90.0
    recording, report = read_and_counted(table, OPEN)
    assert (report.broken, report.lone, report.samples) == (steps, 1, 30)
    assert np.nanmax(np.abs(recording.velocity[..., 0] - 10.0)) < 1e-9


def test_exchanged_names_are_counted_and_give_no_velocity():
    table = line()
    late = table["frame"] >= 5
    table.loc[late, "y"] = np.where(table["id"] == 0, 40.0, np.where(table["id"] == 2, 0.0, 20.0))[
        late
    ]
    recording, report = read_and_counted(table, OPEN)
    assert (report.broken, report.samples) == (2, 30)
    assert np.nanmax(np.abs(recording.velocity[..., 1])) < 1e-9
    assert np.isfinite(recording.velocity).all()


def test_boats_that_come_and_go():
    table = line()
    table = table[~((table["id"] == 2) & (table["frame"] < 6))]
    table = table[~((table["id"] == 0) & ~table["frame"].isin([3]))]
    recording, report = read_and_counted(table, OPEN)
    assert report.lone == 1
    boats_there = np.isfinite(recording.pose[..., 0]).sum(axis=1)
    assert boats_there.tolist() == [1, 1, 1, 2, 1, 1, 2, 2, 2, 2]
    # A lone sample has no velocity and counts in no quantity; one boat has no pairs.
    assert np.isfinite(recording.order.c_o).tolist() == [False] * 6 + [True] * 4
    assert np.isfinite(recording.order.psi_o).all()


def test_rows_without_a_name_are_left_out_and_counted():
    for names in ([1.0, 2.0, np.nan], ["ann", "bob", None], ["ann", "bob", " "]):
        table = line(id=pd.Series(np.resize(np.array(names, object), 30)).infer_objects())
        recording, report = read_and_counted(table, OPEN)
        assert recording.ids.tolist() == [str(each).removesuffix(".0") for each in names[:2]]
        assert (report.left_out, report.samples) == ({"without a name": {"": 10}}, 20)


def test_rows_of_which_all_is_missing_are_counted():
    table = line()
    table.loc[7:9, ["x", "y", "heading"]] = np.nan
    report = read_and_counted(table, OPEN)[1]
    assert report.left_out == {"without a position": {"0": 1, "1": 1, "2": 1}}
    assert report.missing == 3


def test_fragments_that_would_fill_the_memory_are_refused():
    count = 10_000
    places = {"frame": np.arange(count), "id": np.arange(count), "x": 1.0, "y": 0.0}
    table = pd.DataFrame({**places, "heading": 0.0})
    with pytest.raises(flockenv.ParameterError, match="10000 names in 10000 frames are too many"):
        read_tracks(table, OPEN)
    assert read_and_counted(table[:2000], OPEN)[1].lone == 2000


@pytest.mark.parametrize("names", [("a", "A"), ("Boat 01", "boat 1"), ("é", "e\u0301")])
def test_one_name_in_two_spellings_is_refused(names):
    with pytest.raises(flockenv.ParameterError, match="never in one frame, and differ in case"):
        read_tracks(line(id=np.repeat(names, 15), frame=np.arange(30)), OPEN)
    # Two boats that are there at once are two.
    assert len(read_tracks(line(id=np.tile([*names, "b"], 10)), OPEN).ids) == 3


def test_a_report_is_a_function(seen):
    with pytest.raises(TypeError, match="report must be a function, not None"):
        read_tracks(seen.table, LAYOUT, None)


def test_names_are_sorted_as_numbers():
    recording = read_tracks(line(id=np.tile([10, 2, 1], 10)), OPEN)
    assert recording.ids.tolist() == ["1", "2", "10"]


@pytest.mark.parametrize(
    ("table", "changes", "words"),
    [
        (
            line(id=np.where(np.arange(30) == 7, 0, np.arange(30) % 3)),
            {},
            "'0' appears 2 times in one frame, at different positions, the second time in row 7",
        ),
        (line(heading=np.linspace(0, 350, 30)), {}, "heading_unit = 'deg'"),
        (line(x=np.nan), {}, "no row has a name, a position and a heading"),
        (line(heading="left"), {}, "'heading' holds other things than numbers"),
        (line(frame=np.nan), {}, "'frame' has rows without a number"),
        (line().drop(columns="y"), {}, "'y' is missing; there are frame, id, x, heading"),
        (line().iloc[:0], {}, "no row has a name"),
        (line(), {"cm_per_unit": 0.0}, "cm_per_unit = 0.0"),
        (line(), {"fps": -1.0}, "fps = -1.0"),
        (line(), {"heading_unit": "grad"}, "'grad' is not accepted: rad or deg"),
        (line(), {"heading": ("x", "y")}, "the tail and x, y of the head"),
        (line(), {"leaders": ("7",)}, "'7' is not a leader among the ids"),
        (
            line(),
            {"cm_per_unit": 200.0, "max_speed_cm_s": 1e9, "pool": (np.inf, 0.0)},
            "20 m/s in the median",
        ),
        (line(), {"center": (-500.0, 0.0)}, "100% of the centers lie outside the pool"),
        (line(), {"pool": "bathtub"}, "bathtub"),
        (line(), {"y_down": "false"}, "y_down = 'false' is not accepted: true or false"),
        (line(), {"leaders": "10"}, "leaders = '10' is not accepted: a list of names"),
        (line(), {"x": ("x", "y")}, "x = ('x', 'y') and y = 'y' are not as many columns"),
        (line(), {"x": [], "y": []}, "x = () and y = () are not as many columns"),
        (line(), {"x": 3}, "x = 3 is not accepted: the name of a column"),
        (line(), {"hull": (5.0,)}, "hull = (5.0,) is not accepted: two numbers"),
        (line(), {"hull": (-5.0, 0.5)}, "boat_radius_cm = -5 is not accepted"),
        (line(), {"target": 5}, "target must be a string or a list of strings, not 5"),
    ],
)
def test_mistakes_are_named(table, changes, words):
    with pytest.raises(flockenv.ParameterError) as raised:
        read_tracks(table, TrackLayout(**{**fields(OPEN), **changes}))
    assert words in str(raised.value)


def test_numbers_of_numpy_are_numbers():
    kinds = {"fps": np.int64(10), "cm_per_unit": np.float32(1.0), "max_speed_cm_s": np.int16(200)}
    found = read_tracks(line(), TrackLayout(**{**fields(OPEN), **kinds}))
    assert found == read_tracks(line(), OPEN)


def test_files_with_their_layout_beside_them(seen, tmp_path):
    layout = (
        'pool = "narrow"\nleaders = ["boat1", "boat2"]\nfps = 10\nid = "track"\nx = "x_px"\n'
        'y = "y_px"\nheading = "angle"\nheading_unit = "deg"\ncm_per_unit = 0.25\n'
        f"center = [{CENTER[0]}, {CENTER[1]}]\ny_down = true\n"
    )
    (tmp_path / "tracks.toml").write_text(layout)
    assert read_layout(tmp_path / "tracks.toml") == LAYOUT
    seen.table.to_csv(tmp_path / "tracks.csv", index=False)
    seen.table.to_parquet(tmp_path / "tracks.parquet", index=False)
    expected = read_tracks(seen.table, LAYOUT)
    for name in ("tracks.csv", "tracks.parquet"):
        assert read_tracks(tmp_path / name) == expected


def test_files_that_are_none(tmp_path):
    for name, content in (
        ("wrong.txt", b"1 2 3"),
        ("wrong.xlsx", b"1 2 3"),
        ("noise.parquet", bytes(range(256))),
        ("wrong.toml", b"pool = 'narrow'\nfbs = 25\n"),
    ):
        (tmp_path / name).write_bytes(content)
    for read, arguments, words in (
        (read_tracks, [tmp_path / "tracks.csv"], r"tracks\.csv cannot be read: No such"),
        (read_tracks, [tmp_path / "absent.csv", OPEN], r"absent\.csv cannot be read: No such file"),
        (
            read_tracks,
            [tmp_path / "wrong.xlsx", OPEN],
            r"ends in none of \.csv, \.tsv, \.txt, \.csv\.gz",
        ),
        (read_tracks, [tmp_path / "wrong.txt", OPEN], "column 'id' is missing; there are 1 2 3"),
        (read_tracks, [tmp_path / "noise.parquet", OPEN], "cannot be read as a table"),
        (read_tracks, [line()], "layout is missing"),
        (read_tracks, [""], "is not the name of a table"),
        (guess_layout, [""], "is not the name of a table"),
        (read_layout, [tmp_path / "wrong.toml"], "'fbs' is not a field of a layout"),
        (read_layout, ["a\0.toml"], "is not the name of a file"),
    ):
        with pytest.raises(flockenv.ParameterError, match=words):
            read(*arguments)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("pool = 5", "pool must be a pool's name or"),
        ("pool = 'narrow'\ntarget = 5", "target must be a string or a list of strings, not 5"),
        ("pool = 'narrow'\nleaders = 5", "leaders = 5 is not accepted: a list of names"),
        ("pool = 'narrow'\nleaders = [true]", "leaders = (True,) is not accepted"),
        ("fps = 5", "pool is missing"),
        ("pool = ", "is not TOML"),
    ],
)
def test_a_layout_of_the_wrong_kind_names_its_file(tmp_path, text, words):
    (tmp_path / "layout.toml").write_text(text)
    with pytest.raises(flockenv.ParameterError, match=r"layout\.toml") as raised:
        read_layout(tmp_path / "layout.toml")
    assert words in str(raised.value)
