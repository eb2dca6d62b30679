"""Samples of tracks in s, cm and rad, and why some of them are omitted."""

from contextlib import suppress
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.extras import require
from flockenv.errors import ParameterError, short_repr
from flockenv.tracks.formats import PER_S, unit_of
from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.motion import HEADING_ZERO, TINY, TURN, direction, in_water
from flockenv.tracks.table import (
    Floats,
    boats_of,
    index_of,
    indices_of,
    listed,
    long_table,
    numbers,
)

if TYPE_CHECKING:
    import pandas as pd

REPEATED = "that are repeated"
_MOST_OUTSIDE, _MOST_TOO_LARGE = 0.5, 0.01
_DAY_S = 86_400.0
_DATES = ("ISO8601", "%d.%m.%Y %H:%M:%S", "%d.%m.%Y %H:%M:%S.%f")


def samples_of(rows: "pd.DataFrame", layout: TrackLayout) -> "tuple[pd.DataFrame, bool]":
    """Return a table of samples, and whether boats have names.

    Its columns are id, time in s from the earliest one, x and y in cm from the pool's center with y
    up, heading in rad, and why: the reason why a sample is omitted, "" for samples that count. If
    no row has a name, all rows belong to one boat.
    """
    table, names = long_table(rows, layout)
    columns = layout.columns
    points, is_lost = points_of(table, columns["x"], columns["y"], layout)
    # The center, or the corner of a box. Without a box `half_size` has no columns, and adds 0.
    reference, half_size = points.mean(axis=0), table[[*columns["box"]]].to_numpy() / 2
    position = reference + half_size @ [1, 1j][: half_size.shape[1]]
    position = (position - complex(*layout.center)) * (layout.cm_per_unit or 1.0)
    position = position.conj() if layout.y_down else position
    if len(columns["heading"]) == 1:
        _check_no_component(rows, columns["heading"][0], layout)
    heading, is_too_large = _headings(table, layout)
    ids, time = "0" if names is None else names, _times(table[layout.frame], layout)
    values = {"id": ids, "time": time, "x": position.real, "y": position.imag, "heading": heading}
    samples: pd.DataFrame = require("pandas", "plot").DataFrame(values, table.index)
    is_confident = table[[*columns["confidence"]]] >= (layout.least_confidence or 0.0)
    reasons = {
        "without a name": samples["id"].isna(),
        "at a point that stands for a lost boat": is_lost,
        "without a position": np.isnan(position),
        "with too little confidence": ~is_confident.all(axis=1),
        "with a heading beyond a full turn": is_too_large,
        "without a heading": np.isnan(heading),
        "outside the water": ~in_water(layout.pool, np.abs(position), 2 * layout.hull[0]),
        REPEATED: samples.duplicated(),
    }
    samples["why"] = np.select(list(reasons.values()), list(reasons), "")
    _check_water(samples)
    return samples, names is not None


def points_of(
    table: "pd.DataFrame", x: tuple[str, ...], y: tuple[str, ...], layout: TrackLayout
) -> tuple[NDArray[np.complex128], NDArray[np.bool_]]:
    """Return points x + iy, shape (points, rows), and whether any of them marks a lost boat."""
    points = table[[*x]].to_numpy().T + 1j * table[[*y]].to_numpy().T
    is_mark = np.isin(points, [complex(*mark) for mark in layout.lost])
    return points, np.asarray(is_mark.any(axis=0))


def _check_water(samples: "pd.DataFrame") -> None:
    """Refuse tracks of which most lie outside the pool.

    The three points outside that most rows share do not count, since they may mark lost boats.
    """
    counts = samples[samples["why"] == "outside the water"].value_counts(["x", "y"])
    outside = counts.sum() - counts[counts > 1].head(3).sum()
    share = outside / max(1, outside + samples["why"].isin(["", REPEATED]).sum())
    if share > _MOST_OUTSIDE:
        raise ParameterError(
            f"{share:.0%} of the centers lie outside the pool, or in the obstacle in its middle: "
            "do cm_per_unit, center and pool fit this table?"
        )


def _times(column: "pd.Series[Any]", layout: TrackLayout) -> Floats:
    """Return times in s, from the earliest one on."""
    kind, first = column.dtype.kind, str(next(iter(column.dropna()), ""))
    is_text = kind not in "iufmM" and ":" in first
    if is_text or kind in "mM":
        if layout.fps is not None:
            raise ParameterError(f"column {layout.frame!r} holds times: leave fps out")
        stamps = _dates_or_durations(column, first) if is_text else column
        has_dates = stamps.dtype.kind == "M"
        stamps = stamps - stamps.min() if has_dates else stamps
        times: Floats = stamps.dt.total_seconds().to_numpy(np.float64)
        times = _past_midnight(times) if is_text and not has_dates else times
    else:
        times = numbers(column, layout)
        _check_clock(times, layout)
        times = times / (layout.fps or 1.0)
    without_time = column.index[~np.isfinite(times)]
    if len(without_time):
        raise ParameterError(
            f"column {layout.frame!r} has rows without a number, such as {column.index.name} "
            f"{without_time[0]}"
        )
    return np.asarray(times - times.min(initial=np.inf))


def _dates_or_durations(column: "pd.Series[Any]", first: str) -> "pd.Series[Any]":
    """Return texts as dates, or as durations since midnight if they are clock times.

    `first` is the text that the error for other texts quotes.
    """
    pandas = require("pandas", "plot")
    # Loggers write 12:34:56,789, and stopwatches 34:56.7.
    texts = column.astype(str).str.replace(",", ".")
    with_hours = texts.str.replace(r"^\s*(\d+:\d+\.\d*)\s*$", r"00:\1", regex=True)
    dates = (pandas.to_datetime(texts, "coerce", utc=True, format=form) for form in _DATES)
    for times in (pandas.to_timedelta(with_hours, errors="coerce"), *dates):
        if (times.notna() | column.isna()).all():
            return times  # type: ignore[no-any-return]
    raise ParameterError(
        f"column {column.name!r} holds {short_repr(first)}, which is not a number, "
        "a time 12:34:56.7 or a date 2026-01-31 12:34:56.7 or 31.01.2026 12:34:56.7"
    )


def _past_midnight(seconds: Floats) -> Floats:
    """Return times of day, with a day added to those past midnight.

    If the sorted times have a gap of at least half a day, those before the gap are past midnight.
    """
    stamps = np.unique(seconds[np.isfinite(seconds)])
    steps = np.diff(stamps)
    if steps.max(initial=0.0) < _DAY_S / 2 or stamps[-1] > _DAY_S:
        return seconds
    return np.where(seconds <= stamps[steps.argmax()], seconds + _DAY_S, seconds)


def _check_clock(times: Floats, layout: TrackLayout) -> None:
    """Refuse frame numbers that would be read as seconds, and seconds as frame numbers."""
    stamps = np.unique(times[np.isfinite(times)])
    steps = np.diff(stamps)
    if not len(steps):
        return
    is_whole = bool((stamps == np.rint(stamps)).all())
    unit = unit_of(layout.frame)
    per_s = PER_S.get(unit)
    has_other_unit = per_s not in (None, 1.0)
    # In a column named "seconds", steps of 12 are seconds, but 0, 1, 2 are frames even there.
    are_seconds = per_s == 1.0 and steps.min() > 1.0
    if layout.fps is None and (has_other_unit or (is_whole and not are_seconds)):
        content = "holds whole numbers (fps = 1 if it counts s)"
        if has_other_unit:
            content = f"counts {unit} (fps = {per_s:.6g})"
        raise ParameterError(f"fps is missing: column {layout.frame!r} {content}")
    if (layout.fps or 0.0) > 1.0 and not is_whole and np.median(steps) < 0.5:
        raise ParameterError(
            f"fps = {layout.fps:g} is given, but column {layout.frame!r} has steps of "
            f"{np.median(steps):.4g}, which are not frames: leave fps out if it holds times in s"
        )


def _headings(table: "pd.DataFrame", layout: TrackLayout) -> tuple[Floats, NDArray[np.bool_]]:
    """Return headings in rad from x, and whether each exceeds a full turn; 0 without a column."""
    columns, is_too_large = layout.columns["heading"], np.zeros(len(table), bool)
    turns = layout.heading_turns or ("cw" if layout.y_down else "ccw")
    if len(columns) == 4:
        (tail, head), is_lost = points_of(table, columns[::2], columns[1::2], layout)
        to_head = (head - tail).conj() if layout.y_down else head - tail
        return np.where(is_lost, np.nan, direction(to_head)), is_too_large
    if columns:
        heading = table[columns[0]].to_numpy()
        is_too_large = (np.abs(heading) > TURN[layout.heading_unit] + TINY) & layout.wrapped
        _check_largest(heading, is_too_large, layout)
        heading = heading * (TURN["rad"] / TURN[layout.heading_unit])
    elif layout.quaternion is not None:
        # If headings grow from y to x of the file, the quaternions are of a mirrored system.
        is_mirrored = (turns == "cw") != layout.y_down
        heading = _yaw(table[[*layout.quaternion]], -1.0 if is_mirrored else 1.0)
    else:
        return np.zeros(len(table)), is_too_large
    heading = heading if turns == "ccw" else -heading
    return HEADING_ZERO[layout.heading_zero] + heading, is_too_large


def _yaw(quaternions: "pd.DataFrame", handedness: float) -> Floats:
    """Return the angle in rad about the vertical of quaternions x, y, z, w; NaN if not of length 1.

    `handedness` is 1 for a right-handed system, and -1 for a mirrored one.
    """
    x, y, z, w = quaternions.to_numpy().T
    error = np.abs(x**2 + y**2 + z**2 + w**2 - 1.0)
    if np.nanmedian(error) > 0.01:
        raise ParameterError(
            f"quaternion = {[*quaternions]} is not accepted: columns x, y, z and w, whose squares "
            "add up to 1"
        )
    yaw = np.arctan2(2 * (w * z + handedness * x * y), 1 - 2 * (y**2 + z**2))
    return np.where(error > 0.1, np.nan, yaw)


def _check_no_component(rows: "pd.DataFrame", heading: str, layout: TrackLayout) -> None:
    """Refuse a component of a quaternion, a sine or a cosine as a heading.

    Such a column is recognized by its values: its squares and those of one or three neighboring
    columns add up to 1.
    """
    name = heading.replace("{id}", boats_of(rows, layout)[0])
    heading_index = index_of(name, rows, indices_of(rows))
    some_rows = rows.iloc[:: len(rows) // 10_000 + 1]  # At most 10 000 rows are enough.
    squares = dict[int, Floats]()
    for index in range(max(0, heading_index - 3), min(heading_index + 4, rows.shape[1])):
        with suppress(ParameterError):  # The neighbor may hold texts.
            values = numbers(some_rows.iloc[:, index], layout)
            if len(values) and np.nan_to_num(np.abs(values)).max() <= 1.01:
                squares[index] = values**2
    square = squares.pop(heading_index, np.zeros(len(some_rows)))
    for others in (*combinations(squares, 3), *combinations(squares, 1)):
        total = square + sum(squares[index] for index in others)
        known = np.isfinite(total)  # A lost boat has no numbers.
        if not known.any():
            continue
        spread = 0.1 * np.std(square[known])
        if np.std(total[known]) < spread and abs(np.mean(total[known]) - 1.0) < 0.1:
            names = [str(rows.columns[index]) for index in sorted((heading_index, *others))]
            raise ParameterError(
                f"heading = {layout.heading!r} is a part of a turn: the squares of {listed(names)} "
                "add up to 1. Name the columns x, y, z and w in quaternion, or make angles of a "
                "sine and a cosine"
            )


def _check_largest(heading: Floats, is_too_large: NDArray[np.bool_], layout: TrackLayout) -> None:
    """Refuse headings if many exceed a full turn; a single such value may mark lost boats.

    It is accepted unless every heading has it.
    """
    share = is_too_large.sum() / max(1, np.isfinite(heading).sum())
    is_mark = len(np.unique(heading[is_too_large])) == 1 and share < 1.0
    if share <= _MOST_TOO_LARGE or is_mark:
        return
    largest, unit_given = np.abs(heading[is_too_large]).max(), layout.heading_unit
    units = (u for u in TURN if TURN[u] > TURN[unit_given] and largest <= TURN[u] + TINY)
    unit = next((f"heading_unit = {u!r} if they are in {u}, " for u in units), "")
    raise ParameterError(
        f"headings reach {largest:.4g}, and {share:.0%} exceed a full turn in {unit_given}: "
        f"{unit}wrapped = false if they count whole turns"
    )


def check_samples(samples: "pd.DataFrame", used: "pd.DataFrame", is_named: bool) -> None:
    """Refuse tracks without used samples, or with two samples of a boat at one time.

    Also refuse two spellings of a name that never appear in one frame: they would be two boats.
    """
    if used.empty:
        counts = [f"{count} {why}" for why, count in samples["why"].value_counts().items()]
        reasons = ", ".join(counts) or "there are no rows"
        raise ParameterError(f"no row has a name, a position and a heading in the water: {reasons}")
    repeated = used[used.duplicated(["id", "time"])]
    if len(repeated) and not is_named:
        raise ParameterError("id is missing: several rows have one time, so boats have names")
    for line, name, time in repeated[["id", "time"]].head(1).itertuples():
        count = ((used["id"] == name) & (used["time"] == time)).sum()
        raise ParameterError(
            f"{name!r} appears {count} times in one frame, at different "
            f"positions, the second time in {used.index.name} {line}: were there two films, or "
            "was the clock set back? Give each film a table of its own"
        )
    names = used["id"].drop_duplicates()
    plain = names.str.normalize("NFKC").str.casefold()
    plain = plain.str.replace(r"(?<!\d)0+(?=\d)", "", regex=True)
    for _, spellings in names.groupby(plain):
        if len(spellings) > 1 and used.loc[used["id"].isin(spellings), "frame"].is_unique:
            raise ParameterError(
                f"the names {', '.join(map(repr, spellings))} are never in one frame, and differ "
                "in case or leading zeros only: give each boat one spelling of its name"
            )


def poses_of(
    samples: "pd.DataFrame", used: "pd.DataFrame"
) -> tuple[list[str], Floats, Floats, Floats]:
    """Return the names (n,), times (t,), each boat's own times (t, n), and poses (t, n, 3)."""
    # Sorted by length, then alphabetically, so that 2 comes before 10.
    names = sorted(used["id"].unique(), key=lambda name: (len(name), name))
    time_s = samples.groupby("frame")["time"].agg(["min", "max"]).mean(axis=1).to_numpy()
    # The array holds a pose for each frame and name. If it is large, a sixteenth must be filled.
    if len(time_s) * len(names) > max(1 << 22, 16 * len(samples)):
        raise ParameterError(
            f"{len(names)} names in {len(time_s)} frames are too many for {len(samples)} rows: "
            "join fragments of tracks"
        )
    pose = np.full((len(time_s), len(names), 3), np.nan)
    stamps = np.tile(time_s[:, None], len(names))
    boats = require("pandas", "plot").Index(names).get_indexer(used["id"])
    pose[used["frame"], boats] = used[["x", "y", "heading"]]
    stamps[used["frame"], boats] = used["time"]
    return names, time_s - time_s[0], stamps, pose


def frames_of(rows: "pd.DataFrame") -> NDArray[np.intp]:
    """Return each row's frame number, from 0; rows must be in the order of time.

    Rows with the same time are one frame. If each boat has its own time stamps, a frame ends before
    one of its boats is seen again, and lasts at most 0.9 of the time between two rows of a boat.
    """
    stamps, frames = np.unique(rows["time"], return_inverse=True)
    boat_steps = rows.groupby("id", sort=False)["time"].diff()
    boat_steps = boat_steps[boat_steps > 0.0]
    if len(stamps) < 3 or not len(boat_steps):
        return frames
    # If stamps are about as far apart as the samples of one boat, all boats share their stamps.
    if np.quantile(np.diff(stamps), 0.25) > 0.6 * boat_steps.quantile(0.1):
        return frames
    names, times = rows["id"].to_numpy(), rows["time"].to_numpy()
    longest_s = 0.9 * float(boat_steps.median())
    frame, start, last_seen = -1, -np.inf, dict[str, float]()
    for index, (name, time) in enumerate(zip(names, times, strict=True)):
        # Repeated rows are in one frame, and rows without a name belong to no boat.
        if last_seen.get(name, time) < time or time - start > longest_s:
            frame, start, last_seen = frame + 1, time, {}
        if isinstance(name, str):
            last_seen[name] = time
        frames[index] = frame
    return frames
