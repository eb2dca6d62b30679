"""Law: whatever habits of trackers a file of tracks has, the quantities of its boats, a named
error, or a report that says what is doubtful; never a wrong number without a word."""

import contextlib
import dataclasses
import io
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd
from hypothesis import example, given, settings
from hypothesis import strategies as st

from flockenv import FlockError, FlockParameters, simulate
from flockenv.tracks import TrackLayout, guess_layout, read_layout, read_tracks

FUZZ = settings.get_profile("fuzz")
BOATS, FRAMES = 8, 300
LAYOUT = TrackLayout(
    pool="narrow",
    fps=10.0,
    heading_unit="deg",
    cm_per_unit=0.25,
    center=(400.0, 380.0),
    y_down=True,
)


@cache
def truth() -> pd.DataFrame:
    """Long tracks of a flock in pixels, and the order without any habit, under `attrs`."""
    run = simulate(FlockParameters(n_boats=BOATS, pool="narrow", bw_s=0.3), 3, FRAMES / 10)
    poses = run.to_dataframe(boats=True)
    return pd.DataFrame(
        {
            "frame": np.rint(poses["time_s"] * 10).astype(int),
            "id": "r" + poses["boat"].astype(str),
            "x": (poses["x_cm"] * 4 + 400).round(1),
            "y": (-poses["y_cm"] * 4 + 380).round(1),
            "heading": (-np.degrees(poses["heading_rad"]) % 360).round(1),
        }
    )


#: Each habit changes the table and may say so in the layout.
def _lost(mark):
    def habit(table, layout, lost):
        return table.astype({"x": object, "y": object, "heading": object}).assign(
            **{name: table[name].astype(object).mask(lost, mark) for name in ("x", "y")}
        ), layout

    return habit


def _frozen(table, layout, lost):
    places = table[["x", "y", "heading"]].mask(lost).groupby(table["id"]).ffill().bfill()
    return table.assign(**places), layout


LOST = {
    "zeros": _lost(0.0),
    "minus one": _lost(-1.0),
    "infinite": _lost(np.inf),
    "empty": _lost(None),
    "dash": _lost("-"),
    "absent": lambda table, layout, lost: (table[~lost], layout),
    "frozen": _frozen,
    "far": _lost(1e6),
}
HEADINGS = {
    "as said": lambda table, layout: (table, layout),
    "rad for deg": lambda table, layout: (
        table.assign(heading=np.radians(table["heading"])),
        layout,
    ),
    "deg for rad": lambda table, layout: (table, dataclasses.replace(layout, heading_unit="rad")),
    "compass": lambda table, layout: (
        table.assign(heading=(table["heading"] + 90) % 360),
        dataclasses.replace(layout, heading_zero="up", heading_turns="cw"),
    ),
    "other sense": lambda table, layout: (table.assign(heading=-table["heading"] % 360), layout),
    "axes": lambda table, layout: (table.assign(heading=table["heading"] % 180), layout),
    "behind": lambda table, layout: (table.assign(heading=(table["heading"] + 180) % 360), layout),
    "whole turns": lambda table, layout: (
        table.assign(heading=table["heading"] + 360 * (table["frame"] // 20)),
        layout,
    ),
    "whole turns as said": lambda table, layout: (
        table.assign(heading=table["heading"] + 360 * (table["frame"] // 20)),
        dataclasses.replace(layout, wrapped=False),
    ),
    "quaternion": lambda table, layout: (
        _quaternions(table),
        dataclasses.replace(layout, quaternion=("qx", "qy", "qz", "qw"), heading_turns="ccw"),
    ),
    "part of a quaternion": lambda table, layout: (
        _quaternions(table),
        dataclasses.replace(layout, heading="qz", heading_unit="rad"),
    ),
}


def _quaternions(table):
    half = -np.radians(table["heading"]) / 2
    return table.assign(qx=0.0, qy=0.0, qz=np.sin(half), qw=np.cos(half))


ORDERS = {
    "as it was": lambda table, seed: table,
    "by boat": lambda table, seed: table.sort_values(["id", "t"], kind="stable"),
    "shuffled": lambda table, seed: table.sample(frac=1.0, random_state=seed),
    "newest first": lambda table, seed: table[::-1],
    "blocks": lambda table, seed: pd.concat([table[seed:], table[:seed]]),
}
SECONDS = dataclasses.replace(LAYOUT, fps=None)
CLOCKS = {
    "frames": lambda frame, number: (frame, 10.0),
    "later frames": lambda frame, number: (frame + 1234, 10.0),
    "every third frame": lambda frame, number: (frame * 3, 30.0),
    "seconds": lambda frame, number: (frame / 10, None),
    "Unix time": lambda frame, number: (1.7e9 + frame / 10, None),
    "ms": lambda frame, number: (frame * 100, 1000.0),
    "ms without a word": lambda frame, number: (frame * 100, None),
    "µs without a word": lambda frame, number: (frame * 100_000, None),
    "seconds as frames": lambda frame, number: (frame / 10, 25.0),
    "dates": lambda frame, number: (
        pd.Timestamp("2026-05-04 10:00") + pd.to_timedelta(frame / 10, "s"),
        None,
    ),
    "stamps of each boat": lambda frame, number: (frame / 10 + number * 0.007, None),
    "set back": lambda frame, number: (frame % 200, 10.0),
    "minutes": lambda frame, number: (frame / 600, 1 / 60),
    "minutes without a word": lambda frame, number: (frame / 600, None),
    "frames without a word": lambda frame, number: (frame, None),
}
HONEST = {
    "lost": ("infinite", "empty", "dash", "absent"),
    "headings": ("as said", "compass", "whole turns as said", "quaternion"),
    "clocks": (
        *("frames", "later frames", "every third frame", "seconds", "Unix time", "ms", "dates"),
        *("stamps of each boat", "minutes"),
    ),
    "films": ("one", "rows twice", "unassigned"),
}
"""Habits of trackers that a table may have and must be read."""
FILMS = ("one", "two in a row", "two in each other", "rows twice", "unassigned", "a second header")
SPELLINGS = ((",", "."), (";", ","), (";", "."), ("\t", "."), ("|", ","))


def with_films(table, films):
    mirrored = table.assign(x=790 - pd.to_numeric(table["x"], errors="coerce"))
    if films == "two in a row":
        return pd.concat([table, mirrored])
    if films == "two in each other":
        return pd.concat([table, mirrored]).sort_index(kind="stable")
    if films == "rows twice":
        return pd.concat([table, table[::9]]).sort_index(kind="stable")
    if films == "unassigned":
        return pd.concat([table, table[::9].assign(id="unassigned", x=401.5)]).sort_index(
            kind="stable"
        )
    return table


def quantities(found):
    return found.order.psi_o, found.order.psi_v


def written(folder, table, layout, spelling, is_spelled):
    """A file of a table, and the layout that may say how it is spelled."""
    separator, decimal = spelling
    path = Path(folder, "tracks.csv")
    path.write_text(table.to_csv(index=False, sep=separator, decimal=decimal))
    if is_spelled:
        layout = dataclasses.replace(layout, separator=separator, decimal=decimal)
    return path, layout


@FUZZ
@given(
    st.sampled_from(HONEST["lost"]),
    st.sampled_from(HONEST["headings"]),
    st.sampled_from(HONEST["clocks"]),
    st.sampled_from(HONEST["films"]),
    st.sampled_from(sorted(ORDERS)),
    st.sampled_from(SPELLINGS),
    st.integers(0, 1000),
)
def test_honest_tables_are_never_refused(lost, heading, clock, films, order, spelling, seed):
    rng = np.random.default_rng(seed)
    boat, start = f"r{rng.integers(BOATS)}", rng.integers(10, 250)
    table, layout = HEADINGS[heading](truth(), LAYOUT)
    gone = (table["id"] == boat) & table["frame"].between(start, start + 40)
    table, layout = LOST[lost](table, layout, gone)
    times, fps = CLOCKS[clock](table["frame"], table["id"].str[1:].astype(int))
    table = ORDERS[order](with_films(table.assign(t=times), films), seed)
    with TemporaryDirectory() as folder:
        layout = dataclasses.replace(layout, fps=fps, frame="t")
        reports = []
        found = read_tracks(*written(folder, table, layout, spelling, True), reports.append)
    expected = read_tracks(truth()[~gone], LAYOUT)
    assert reports[0].missing == gone.sum()
    for values, known in zip(quantities(found), quantities(expected), strict=True):
        assert np.nanmean(np.abs(values - known)) < 0.05 * np.nanmean(known)


@FUZZ
@example("absent", "as said", "stamps of each boat", "rows twice", (",", "."), False, 0)
@example("absent", "as said", "stamps of each boat", "unassigned", (",", "."), False, 0)
@example("absent", "as said", "stamps of each boat", "two in each other", (",", "."), True, 0)
@given(
    st.sampled_from(sorted(LOST)),
    st.sampled_from(sorted(HEADINGS)),
    st.sampled_from(sorted(CLOCKS)),
    st.sampled_from(FILMS),
    st.sampled_from(SPELLINGS),
    st.booleans(),
    st.integers(0, 1000),
)
def test_habits_of_trackers(lost, heading, clock, films, spelling, is_spelled, seed):
    rng = np.random.default_rng(seed)
    boat, start = f"r{rng.integers(BOATS)}", rng.integers(10, 250)
    table, layout = HEADINGS[heading](truth(), LAYOUT)
    gone = (table["id"] == boat) & table["frame"].between(start, start + 40)
    expected = read_tracks(truth()[~gone], LAYOUT)
    table, layout = LOST[lost](table, layout, gone)
    number = table["id"].str[1:].astype(int)
    times, fps = CLOCKS[clock](table["frame"], number)
    table = with_films(table.assign(frame=times), films).rename(columns={"frame": "t"})
    separator, decimal = spelling
    text = table.to_csv(index=False, sep=separator, decimal=decimal)
    text = text + text if films == "a second header" else text
    layout = dataclasses.replace(layout, fps=fps, frame="t")
    if is_spelled:
        layout = dataclasses.replace(layout, separator=separator, decimal=decimal)
    with TemporaryDirectory() as folder:
        Path(folder, "tracks.csv").write_text(text)
        reports = []
        try:
            found = read_tracks(Path(folder, "tracks.csv"), layout, reports.append)
        except FlockError:
            return
    (report,) = reports
    if report.cosine < 0.3 or boat in report.stuck:
        return
    assert (report.boats, len(found)) == (BOATS, FRAMES + 1)
    for values, known in zip(quantities(found), quantities(expected), strict=True):
        off = np.nanmean(np.abs(values - known)) / np.nanmean(known)
        assert off < 0.05, (lost, heading, clock, films)
    assert report.samples + report.missing == BOATS * (FRAMES + 1)
    assert report.missing == gone.sum()


@FUZZ
@given(st.data())
def test_changed_texts(data):
    buffer = io.StringIO()
    truth()[:60].to_csv(buffer, index=False)
    text = buffer.getvalue()
    start, end = sorted(data.draw(st.tuples(*[st.integers(0, len(text))] * 2)))
    end = min(end, start + 40)
    odd = data.draw(st.text(alphabet=" ,;.:-+\"'\n\t0123456789eEinfaNx#\x00ü", max_size=12))
    with TemporaryDirectory() as folder:
        path = Path(folder, "tracks.csv")
        path.write_text(text[:start] + odd + text[end:])
        with contextlib.suppress(FlockError):
            read_tracks(path, LAYOUT)
        try:
            guess_layout(path)
            read_tracks(path, read_layout(path.with_suffix(".toml")))
        except FlockError:
            pass


@FUZZ
@given(st.binary(max_size=300))
def test_foreign_bytes(blob):
    with TemporaryDirectory() as folder:
        for name in ("tracks.csv", "tracks.parquet"):
            path = Path(folder, name)
            path.write_bytes(blob)
            for read in (guess_layout, lambda path: read_tracks(path, LAYOUT)):
                with contextlib.suppress(FlockError):
                    read(path)
