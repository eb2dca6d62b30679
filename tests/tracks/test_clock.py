"""Times are in s, whatever a column holds; clocks that go back and other units are named."""

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.tracks import TrackLayout, read_tracks

from .conftest import LAYOUT, but, read_and_counted

TIMED = but(LAYOUT, frame="t", fps=None)


def timed(seen, times):
    """The table with other times, of the seconds that it has."""
    return seen.table.drop(columns="frame").assign(t=times(seen.table["frame"] / 10.0))


START = pd.Timestamp("2026-03-29 01:59:30")


@pytest.mark.parametrize(
    "times",
    [
        lambda s: START + pd.to_timedelta(s, "s"),
        lambda s: (START + pd.to_timedelta(s, "s")).astype("datetime64[ms]"),
        lambda s: (
            (START + pd.to_timedelta(s, "s")).dt.tz_localize("UTC").dt.tz_convert("Asia/Tokyo")
        ),
        lambda s: pd.to_timedelta(s, "s"),
        lambda s: (START + pd.to_timedelta(s, "s")).dt.strftime("%Y-%m-%d %H:%M:%S.%f"),
        lambda s: (START + pd.to_timedelta(s, "s")).dt.strftime("%Y-%m-%dT%H:%M:%S.%fZ"),
        lambda s: (START + pd.to_timedelta(s, "s")).dt.strftime("%H:%M:%S.%f"),
        lambda s: (START + pd.to_timedelta(s, "s")).dt.time,
        lambda s: s.astype(str),
        lambda s: s + 1.7e9,
    ],
)
def test_times_of_any_type_are_converted(seen, times, tmp_path):
    expected = read_tracks(seen.table, LAYOUT)
    table = timed(seen, times)
    table.to_csv(tmp_path / "tracks.csv", index=False)
    for source in (table, tmp_path / "tracks.csv"):
        found = read_tracks(source, TIMED)
        assert np.allclose(found.time_s, expected.time_s, atol=1e-5)
        assert np.allclose(found.order.psi_v, expected.order.psi_v, rtol=1e-3, atol=1e-4)
    with pytest.raises(flockenv.ParameterError, match=r"fps"):
        read_tracks(timed(seen, lambda s: pd.to_timedelta(s, "s")), but(TIMED, fps=25.0))


def test_a_morning_and_an_evening_with_dates_stay_in_order(seen):
    """Only times of day may be of the day after."""

    def in_two_sessions(s):
        return pd.Timestamp("2026-01-31 08:00") + pd.to_timedelta(s + 45e3 * (s > s.median()), "s")

    dates = timed(seen, in_two_sessions)
    texts = timed(seen, lambda s: in_two_sessions(s).dt.strftime("%Y-%m-%d %H:%M:%S.%f"))
    expected, found = (read_tracks(table, TIMED) for table in (dates, texts))
    assert np.ptp(found.time_s) > 45e3
    assert np.allclose(found.time_s, expected.time_s, atol=1e-5)
    assert np.allclose(found.order.psi_v, expected.order.psi_v, atol=1e-4, equal_nan=True)


@pytest.mark.parametrize("per_s", [1e3, 1e6, 1e9])
def test_units_of_time_are_refused_until_they_are_said(seen, per_s):
    table = timed(seen, lambda s: np.rint(s * per_s).astype(np.int64))
    with pytest.raises(flockenv.ParameterError, match="fps is missing"):
        read_tracks(table, TIMED)
    found = read_tracks(table, but(TIMED, fps=per_s))
    assert np.allclose(found.order.psi_v, read_tracks(seen.table, LAYOUT).order.psi_v, rtol=1e-6)


def test_ms_of_a_fast_camera_are_doubted_by_their_speeds():
    """200 frames per second in ms with decimals: steps of 5 are possible, mm per minute are not."""
    t = np.arange(0, 20_000, 5.01)
    table = pd.DataFrame({"t": t, "id": "a", "x": 60 * np.cos(t / 3e3), "y": 60 * np.sin(t / 3e3)})
    layout = TrackLayout(pool=(100.0, 0.0), frame="t", heading=None)
    _, report = read_and_counted(table, layout)
    assert "median speed 0.02 cm/s" in str(report)
    assert "slow for boats: are times in s?" in str(report)
    found, report = read_and_counted(table, but(layout, fps=1000.0))
    assert found.order.psi_v[10] == pytest.approx(20, abs=0.1)
    assert "slow" not in str(report)


@pytest.mark.parametrize(
    ("times", "changes", "words"),
    [
        (lambda s: np.rint(s * 10).astype(int), {"frame": "frame_no"}, "fps is missing"),
        (lambda s: np.rint(s * 10), {"frame": "Step"}, "fps is missing"),
        (lambda s: np.rint(s * 10), {"frame": "image_idx"}, "fps is missing"),
        (lambda s: s, {"fps": 25.0}, "which are not frames"),
        (lambda s: s / 1e6, {}, "do cm_per_unit, fps and times fit"),
        (lambda s: "about " + s.astype(str), {}, "other things than numbers: 'about 0.0'"),
        (lambda s: "12:00 or " + s.astype(str), {}, "is not a number, a time"),
        (lambda s: s > 3, {}, "other things than numbers"),
        (lambda s: s.where(s != 3.0), {}, "rows without a number, such as row "),
    ],
)
def test_times_that_cannot_be_are_named(seen, times, changes, words):
    layout = but(TIMED, **changes)
    table = timed(seen, times).rename(columns={"t": layout.frame})
    with pytest.raises(flockenv.ParameterError, match=words):
        read_tracks(table, layout)


def two_films(seen, offset):
    other = seen.table.assign(frame=seen.table["frame"] + offset)
    return pd.concat([seen.table, other.assign(x_px=1624 - other["x_px"])])


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (lambda seen: two_films(seen, 0.0), "were there two films"),
        (lambda seen: two_films(seen, 0.5), "is it one film"),
        (lambda seen: two_films(seen, 300.0), "were there two films"),
        (
            lambda seen: two_films(seen, 0.5).sort_values(["track", "frame"])[::-1],
            "is it one film",
        ),
        (
            lambda seen: seen.table.assign(frame=seen.table["frame"] % 400),
            "was the clock set back",
        ),
    ],
)
def test_two_films_and_clocks_that_are_set_back_are_refused(seen, table, words):
    """A name is there twice at a time, or most steps are too fast once rows are sorted."""
    with pytest.raises(flockenv.ParameterError, match=words):
        read_tracks(table(seen), LAYOUT)


def test_two_films_that_were_sorted_into_each_other_are_refused(seen):
    table = two_films(seen, 0.5).sort_values("frame", kind="stable")
    with pytest.raises(flockenv.ParameterError, match="is it one film"):
        read_tracks(table, LAYOUT)


def test_a_table_sorted_by_boat_is_one_film(seen):
    table = seen.table.sort_values(["track", "frame"])
    assert read_tracks(table, LAYOUT) == read_tracks(seen.table, LAYOUT)
    # Fragments one after another: the second boat starts when the first one has ended.
    part = table[~((table["track"] == "boat1") & (table["frame"] > 300))]
    part = part[~((part["track"] == "boat10") & (part["frame"] < 300))]
    assert read_and_counted(part, LAYOUT)[1].boats == 20


def test_velocities_on_an_irregular_clock_are_weighted_by_the_steps():
    """On a circle at 20 cm/s, steps of 20 to 180 ms: weighted differences err five times less."""
    t = np.cumsum(np.random.default_rng(0).uniform(0.02, 0.18, 600))
    angle = t * 20 / 60
    table = pd.DataFrame({"t": t, "id": "a", "x": 60 * np.cos(angle), "y": 60 * np.sin(angle)})
    found = read_tracks(
        table.assign(heading=angle + np.pi / 2),
        TrackLayout(pool=(90.0, 0.0), frame="t", wrapped=False),
    )
    truth = 20 * np.stack([-np.sin(angle), np.cos(angle)], axis=-1)
    steps = np.diff(found.pose[:, 0, :2], axis=0) / np.diff(t)[:, None]
    plain = np.abs((steps[1:] + steps[:-1]) / 2 - truth[1:-1]).mean()
    weighted = np.abs(found.velocity[1:-1, 0, :2] - truth[1:-1]).mean()
    assert weighted < plain / 5
    assert np.abs(found.velocity[1:-1, 0, 2] - 20 / 60).max() < 1e-9


@pytest.mark.parametrize("clock", ["frames", "times"])
def test_no_velocity_crosses_frames_that_nobody_is_in(seen, clock):
    table = seen.table[~seen.table["frame"].between(200, 499)]
    layout = LAYOUT if clock == "frames" else TIMED
    table = table if clock == "frames" else table.assign(t=table["frame"] / 10.0)
    found, report = read_and_counted(table, layout)
    whole = read_tracks(seen.table, LAYOUT)
    before, after = 199, 200
    assert found.time_s[after] - found.time_s[before] == pytest.approx(30.1)
    # One-sided beside the gap: a step, not the way across it.
    for here, there, step in ((before, 199, -1), (after, 500, 1)):
        expected = (whole.pose[there + step] - whole.pose[there]) / (0.1 * step)
        both = ~np.isnan(expected[:, 0]) & ~np.isnan(found.velocity[here, :, 0])
        assert both.sum() > 15
        assert np.allclose(found.velocity[here, both, :2], expected[both, :2], atol=1e-6)
    assert report.gaps >= 20


def test_boats_with_time_stamps_of_their_own_share_frames(seen):
    """A ring of cameras sees each boat at a moment of its own within the frame."""
    number = seen.table["track"].str.removeprefix("boat").astype(int)
    truth = seen.truth
    rng = np.random.default_rng(3)
    table = seen.table.assign(
        t=seen.table["frame"] / 10 + number * 0.0041 + rng.uniform(0, 0.0005, len(number))
    ).sort_values("t")
    found, report = read_and_counted(table, TIMED)
    assert report.frames == pytest.approx(601, abs=3)
    assert report.lone < 10
    error = found.order.psi_o[5:590] - truth.order.psi_o[5:590]
    assert np.abs(error).mean() < 0.02
    assert np.nanmean(found.order.psi_v) == pytest.approx(
        np.nanmean(read_tracks(seen.table, LAYOUT).order.psi_v), rel=0.05
    )


def test_rows_that_count_for_nothing_make_no_frames_on_clocks_of_each_boat(seen):
    number = seen.table["track"].str.removeprefix("boat").astype(int)
    table = seen.table.assign(t=seen.table["frame"] / 10 + number * 0.004)
    expected, _ = read_and_counted(table, TIMED)
    for more in (table[::9], table[::9].assign(track="unassigned", x_px=700.0)):
        both = pd.concat([table, more]).sort_index(kind="stable")
        found, report = read_and_counted(both, TIMED)
        assert found == expected
        assert sum(map(len, report.left_out.values())) > 0


def test_two_places_at_one_time_are_refused_on_clocks_of_each_boat(seen):
    number = seen.table["track"].str.removeprefix("boat").astype(int)
    table = seen.table.assign(t=seen.table["frame"] / 10 + number * 0.004)
    other = table.assign(x_px=1600 - table["x_px"])
    with pytest.raises(flockenv.ParameterError, match="appears 2 times"):
        read_tracks(pd.concat([table, other]).sort_index(kind="stable"), TIMED)


def test_boats_seen_in_turn_share_frames():
    frame = np.arange(400)
    table = pd.DataFrame(
        {"frame": frame, "id": frame % 2, "x": 0.5 * frame - 100, "y": 20.0 * (frame % 2)}
    )
    found, report = read_and_counted(
        table.assign(heading=0.0), TrackLayout(pool=(150.0, 0.0), fps=20.0)
    )
    assert (report.frames, report.lone) == (200, 0)
    assert np.allclose(found.velocity[..., 0], 10.0)
