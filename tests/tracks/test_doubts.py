"""Law: what may be wrong is refused or said: no table gives a wrong number without a word."""

import gzip
import re
import tracemalloc

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.tracks import TrackLayout, guess_layout, read_tracks
from flockenv.tracks import table as tables

from .conftest import LAYOUT, but, read_and_counted
from .corpus import CORPUS, ORDERS, PLAIN
from .honest import PLACE, rows
from .program_tables import METERS, motive, quaternions, ros
from .programs import PROGRAMS

SMALL = TrackLayout(**PLAIN)


@pytest.mark.parametrize("order", ["shuffled", "newest first", "late block first"])
def test_rows_that_were_sorted_are_said(order):
    found, report = read_and_counted(ORDERS[order](rows()), SMALL)
    expected, plain = read_and_counted(rows(), SMALL)
    assert found == expected
    assert report.unsorted > 0 == plain.unsorted
    assert "rows are not in the order of time" in str(report)
    assert "order of time" not in str(plain)


@pytest.mark.parametrize("order", ["by boat", "leaders, then others"])
def test_blocks_of_boats_are_nothing_to_say(order):
    found, report = read_and_counted(ORDERS[order](rows()), SMALL)
    assert report.unsorted == 0
    assert found == read_tracks(rows(), SMALL)


def test_two_films_one_after_the_other_are_sorted_and_said(seen):
    other = seen.table.assign(frame=seen.table["frame"] - 1000)
    _, report = read_and_counted(pd.concat([seen.table, other]), LAYOUT)
    assert report.unsorted == 20
    assert report.longest_gap_s == pytest.approx(40.0, abs=0.3)


@pytest.mark.parametrize("name", ["time", "t", "seconds", "time_s", "Time [s]", "stamp"])
def test_whole_numbers_in_a_row_are_no_times_whatever_their_name(name):
    table = rows().rename(columns={"frame": name})
    layout = but(SMALL, frame=name, fps=None)
    with pytest.raises(
        flockenv.ParameterError, match=r"fps is missing.*\(fps = 1 if it counts s\)"
    ):
        read_tracks(table, layout)
    assert read_tracks(table, but(layout, fps=10.0)) == read_tracks(rows(), SMALL)
    # Every third frame is not a time either, unless the name says so: pictures every 3 s.
    third = table.assign(**{name: 3 * table[name]})
    if name in ("seconds", "time_s", "Time [s]"):
        assert read_and_counted(third, layout)[1].step_s == 3.0
    else:
        with pytest.raises(flockenv.ParameterError, match="fps is missing"):
            read_tracks(third, layout)


def test_duration_and_speed_are_said():
    _, report = read_and_counted(rows(), SMALL)
    assert "15 s, a frame every 0.1 s; median speed 5.43 cm/s" in str(report)
    named = report.named()
    assert (named["duration_s"], named["step_s"]) == (15.0, pytest.approx(0.1))
    assert named["median_speed_cm_s"] == pytest.approx(report.median_speed_cm_s)


@pytest.mark.parametrize("axis", "xyzw")
def test_a_part_of_a_quaternion_is_no_heading(axis):
    layout = TrackLayout(**METERS, fps=10.0, heading=f"q{axis}")
    with pytest.raises(flockenv.ParameterError) as raised:
        read_tracks(quaternions(), layout)
    words = (
        f"heading = 'q{axis}' is a part of a turn: the squares of qx, qy, qz, qw add up to 1. Name"
    )
    assert words in str(raised.value)


ANY_NAMES = [("q1", "q2", "q3", "q0"), ("quat_i", "quat_j", "quat_k", "quat_real"), tuple("abcd")]


@pytest.mark.parametrize("part", range(4))
@pytest.mark.parametrize("names", ANY_NAMES)
def test_a_part_of_a_quaternion_is_no_heading_whatever_it_is_called(names, part):
    table = quaternions().rename(columns=dict(zip(("qx", "qy", "qz", "qw"), names, strict=True)))
    layout = TrackLayout(**METERS, fps=10.0, heading=names[part])
    with pytest.raises(flockenv.ParameterError, match="is a part of a turn: the squares of"):
        read_tracks(table.round(3).assign(remark="good"), layout)


@pytest.mark.parametrize("axis", "XYZW")
def test_a_part_of_a_quaternion_beside_others_is_no_heading(axis, tmp_path):
    fields = {n: v for n, v in PROGRAMS["OptiTrack Motive"].layout.items() if n != "quaternion"}
    (tmp_path / "a.csv").write_text(motive())
    layout = TrackLayout(**fields, heading=f"{{id}}.Rotation_{axis}")
    with pytest.raises(flockenv.ParameterError, match="is a part of a turn: the squares of robot1"):
        read_tracks(tmp_path / "a.csv", layout)


@pytest.mark.parametrize("part", ["sine", "cosine"])
def test_a_sine_is_no_heading(part):
    table = rows()
    angle = np.radians(table["angle"])
    table = table.assign(sine=np.sin(angle), cosine=np.cos(angle))
    layout = TrackLayout(**PLACE, fps=10.0, heading=part)
    lost = table.copy()
    lost.loc[::9, ["sine", "cosine"]] = np.nan
    for each in (table, lost):
        with pytest.raises(flockenv.ParameterError, match="make angles of a sine and a cosine"):
            read_tracks(each, layout)


def test_small_headings_beside_a_column_of_ones_are_headings():
    """Its square adds up to about 1 with that of a heading that hardly changes."""
    angle = 0.05 * np.sin(np.arange(200))
    table = pd.DataFrame({"frame": np.arange(200), "id": 1, "x": np.linspace(-90, 90, 200)})
    table = table.assign(y=5 * np.sin(np.arange(200) / 9), heading=angle, sure=1.0, other=0.0)
    assert len(read_tracks(table, TrackLayout(pool=(100.0, 0.0), fps=10.0))) == 200


@pytest.mark.parametrize(
    ("name", "per_s"),
    [("time_ms", 1e3), ("Time [ms]", 1e3), ("time_min", 1 / 60), ("t (h)", 1 / 3600), ("us", 1e6)],
)
def test_a_unit_in_the_name_of_times_is_not_passed_over(name, per_s):
    """Times of slow animals that are not whole numbers would pass as s."""
    table = rows().rename(columns={"frame": name})
    table[name] = table[name] / 10.0 * per_s + 0.25
    layout = TrackLayout(**PLACE, heading="angle", heading_unit="deg", frame=name)
    with pytest.raises(flockenv.ParameterError, match=re.escape(f"(fps = {per_s:.6g})")):
        read_tracks(table, layout)
    _, report = read_and_counted(table, but(layout, fps=per_s))
    assert report.duration_s == pytest.approx(15.0)


def test_quaternions_of_any_sign_are_one_turn():
    layout = TrackLayout(**METERS, fps=10.0, quaternion=("qx", "qy", "qz", "qw"))
    table = quaternions()
    sign = np.where(np.arange(len(table)) % 3 == 0, -1.0, 1.0)
    other = table.assign(**{f"q{axis}": table[f"q{axis}"] * sign for axis in "xyzw"})
    assert np.allclose(read_tracks(other, layout).pose, read_tracks(table, layout).pose)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t: t, "w, whose squares add up to 1"),
        (lambda t: t.drop(columns="qw"), "column 'qw' is missing"),
        (lambda t: t.assign(qw="turned"), "'qw' holds other things"),
    ],
)
def test_what_is_no_quaternion_is_named(change, words):
    columns = ("x", "y", "qz", "qw") if "squares" in words else ("qx", "qy", "qz", "qw")
    layout = TrackLayout(**METERS, fps=10.0, quaternion=columns)
    with pytest.raises(flockenv.ParameterError, match=words):
        read_tracks(change(quaternions()), layout)


def test_lost_quaternions_count_as_missing_headings():
    table = quaternions().astype(float)
    table.loc[7:12, ["qx", "qy", "qz", "qw"]] = 0.0
    layout = TrackLayout(**METERS, fps=10.0, quaternion=("qx", "qy", "qz", "qw"))
    _, report = read_and_counted(table, layout)
    assert sum(report.left_out["without a heading"].values()) == 6


def test_an_empty_column_of_names_is_one_boat_and_said():
    table = rows()[rows()["id"] == 1]
    for empty in (np.nan, None, "", " "):
        found, report = read_and_counted(table.assign(id=empty), SMALL)
        assert found.ids.tolist() == ["0"]
        assert "the column of names is empty: all rows are of one boat" in str(report)
    with pytest.raises(flockenv.ParameterError, match="id is missing: several rows have one time"):
        read_tracks(rows().assign(id=np.nan), SMALL)


def test_detections_beside_the_pool_are_said():
    _, report = read_and_counted(CORPUS["other: a sixth beside the pool"].table(), SMALL)
    assert "17% of the detections lie beside the pool: do cm_per_unit" in str(report)


def test_a_file_without_a_header_is_named_and_described(tmp_path):
    text = rows()[["frame", "id", "x", "y", "angle"]].to_csv(index=False, header=False)
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(flockenv.ParameterError, match="`header` names the columns of a file"):
        read_tracks(tmp_path / "a.csv", SMALL)
    checks = guess_layout(tmp_path / "a.csv")
    assert 'header = ["column 0", "column 1", "column 2", "column 3", "column 4"]' in checks[0]
    with pytest.raises(flockenv.ParameterError, match="the header names 3 columns, and line 1"):
        read_tracks(tmp_path / "a.csv", but(SMALL, header=("frame", "id", "x")))


def test_radians_that_go_on_are_among_the_guesses(tmp_path):
    table = rows()[["frame", "id", "x", "y", "angle"]]
    table = table.assign(angle=lambda t: np.radians(t["angle"] + 360 * (t["frame"] // 20)))
    table.to_csv(tmp_path / "a.csv", index=False)
    checks = guess_layout(tmp_path / "a.csv")
    assert any("wrapped = false if they are in rad" in line for line in checks)


def test_axes_stay_refused_beside_headings_of_0_and_half_a_turn():
    """Boats that turn back on a line have such headings, and fit their motion."""
    table = CORPUS["other: headings 0 and π"].table()
    layout = TrackLayout(pool=(100.0, 0.0), fps=10.0)
    _, report = read_and_counted(table, layout)
    assert report.cosine == pytest.approx(1.0)
    axes = rows().assign(angle=lambda t: t["angle"] % 180)
    with pytest.raises(flockenv.ParameterError, match="axis = true"):
        read_tracks(axes, SMALL)


@pytest.mark.parametrize("name", ["zeros.csv.gz", "zeros.parquet"])
def test_a_small_file_that_would_fill_the_memory_is_refused(name, tmp_path):
    path = tmp_path / name
    if name.endswith(".gz"):
        with gzip.open(path, "wb") as file:
            file.write(b"frame,id,x,y,heading\n")
            for _ in range(70):
                file.write(b"0,0,0,0,0\n" * 100_000)
    else:
        zeros = np.zeros(1_800_000)
        pd.DataFrame(dict.fromkeys(("frame", "id", "x", "y", "heading"), zeros)).to_parquet(path)
    assert path.stat().st_size < 1 << 20
    tracemalloc.start()
    try:
        with pytest.raises(flockenv.ParameterError, match="it holds"):
            read_tracks(path, SMALL)
        assert tracemalloc.get_traced_memory()[1] < 150 << 20
    finally:
        tracemalloc.stop()


def test_columns_are_found_without_looking_through_all(tmp_path, monkeypatch):
    """Names are looked at a few times each: 200 000 of them would take an hour otherwise."""
    boats = 1500
    names = [f"{axis}{n}" for n in range(boats) for axis in "xy"]
    calls, key = [], tables._key
    monkeypatch.setattr(tables, "_key", lambda name: calls.append(1) or key(name))
    line = ",".join(["10.5,20.5"] * boats)
    (tmp_path / "wide.csv").write_text(f"frame,{','.join(names)}\n0,{line}\n1,{line}\n")
    layout = TrackLayout(pool=(100.0, 0.0), fps=1.0, x="x{id}", y="y{id}", heading=None)
    with pytest.raises(flockenv.ParameterError, match="no boat is ever present"):
        read_tracks(tmp_path / "wide.csv", layout)
    assert len(calls) < 6 * len(names)


@pytest.mark.parametrize("prefix", ["field.", "/robot1/odom/pose."])
def test_a_ros_bag_of_one_robot_is_guessed(prefix, tmp_path):
    table = ros(prefix, "%time" if prefix == "field." else "rosbagTimestamp")
    table[table["robot"] == 1].drop(columns="robot").to_csv(tmp_path / "bag.csv", index=False)
    checks = guess_layout(tmp_path / "bag.csv")
    assert not [line for line in checks if line.startswith(("fps", "heading", "quaternion"))]
    text = (tmp_path / "bag.toml").read_text()
    assert "orientation.w" in text
    assert "fps = 1000000000.0" in text
    assert PLACE["y_down"]


@pytest.mark.timeout(60)
@pytest.mark.parametrize("name", ["x" * 100_000, "_" * 100_000 + "a", "w" * 100_000, "a." * 50_000])
def test_names_as_long_as_a_page_tell_nothing_and_take_no_time(name, tmp_path):
    text = f"{name},frame,id,x,y,heading\n" + "".join(f"1,{k},a,{k},2,0\n" for k in range(30))
    (tmp_path / "a.csv").write_text(text)
    checks = guess_layout(tmp_path / "a.csv")
    assert not [line for line in checks if line.startswith(("x", "y =", "frame", "id"))]
    layout = TrackLayout(pool=(100.0, 0.0), fps=1.0)
    assert len(read_tracks(tmp_path / "a.csv", layout)) == 30
