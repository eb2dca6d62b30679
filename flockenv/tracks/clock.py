"""Times of tracks: seconds from any column of times, and frames."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.extras import require
from flockenv.errors import ParameterError, short_repr
from flockenv.tracks.formats import PER_S, unit_of
from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.table import Floats, numbers

if TYPE_CHECKING:
    import pandas as pd

_DAY_S = 86_400.0
_DATES = ("ISO8601", "%d.%m.%Y %H:%M:%S", "%d.%m.%Y %H:%M:%S.%f")


def times_of(column: "pd.Series[Any]", layout: TrackLayout) -> Floats:
    """Return times in s, from the earliest one on."""
    first = str(next(iter(column.dropna()), ""))
    if column.dtype.kind in "mM" or (column.dtype.kind not in "iuf" and ":" in first):
        if layout.fps is not None:
            raise ParameterError(f"column {layout.frame!r} holds times: leave fps out")
        times: Floats = _seconds(column) if column.dtype.kind in "mM" else _read(column, first)
    else:
        times = numbers(column, layout)
        _check_kind(times, layout)
        times = times / (layout.fps or 1.0)
    if not np.isfinite(times).all():
        line = column.index[~np.isfinite(times)][0]
        raise ParameterError(
            f"column {layout.frame!r} has rows without a number, such as {column.index.name} {line}"
        )
    since: Floats = times - times.min(initial=np.inf)
    return since


def _seconds(times: "pd.Series[Any]") -> Floats:
    """Return dates, from the earliest one on, or durations in s."""
    durations = times - times.min() if times.dtype.kind == "M" else times
    seconds: Floats = durations.dt.total_seconds().to_numpy(np.float64)
    return seconds


def _read(column: "pd.Series[Any]", first: str) -> Floats:
    """Return dates or clock times that are written as text in s."""
    pandas = require("pandas", "plot")
    # Loggers write 12:34:56,789, and stopwatches 34:56.7.
    texts = column.astype(str).str.replace(",", ".")
    clock = texts.str.replace(r"^\s*(\d+:\d+\.\d*)\s*$", r"00:\1", regex=True)
    times = pandas.to_timedelta(clock, errors="coerce")
    if (times.notna() | column.isna()).all():
        return _past_midnight(_seconds(times))
    for form in _DATES:
        times = pandas.to_datetime(texts, errors="coerce", utc=True, format=form)
        if (times.notna() | column.isna()).all():
            return _seconds(times)
    raise ParameterError(
        f"column {column.name!r} holds {short_repr(first)}, which is not a number, "
        "a time 12:34:56.7 or a date 2026-01-31 12:34:56.7 or 31.01.2026 12:34:56.7"
    )


def _past_midnight(seconds: Floats) -> Floats:
    """Return clock times, with a day added to those past midnight: the ones before a long gap."""
    stamps = np.unique(seconds[np.isfinite(seconds)])
    steps = np.diff(stamps)
    if steps.max(initial=0.0) < _DAY_S / 2 or stamps[-1] > _DAY_S:
        return seconds
    return np.where(seconds <= stamps[steps.argmax()], seconds + _DAY_S, seconds)


def _check_kind(times: Floats, layout: TrackLayout) -> None:
    """Refuse frame numbers that would count as seconds, and seconds as frame numbers."""
    stamps = np.unique(times[np.isfinite(times)])
    steps = np.diff(stamps)
    if not len(steps):
        return
    is_whole = bool((stamps == np.rint(stamps)).all())
    unit = unit_of(layout.frame)
    per_s = PER_S.get(unit)
    # Steps of 12 may be seconds if the column's name says so; 0, 1, 2 are frames whatever it says.
    says_s = per_s == 1.0 and steps.min() > 1.0
    if layout.fps is None and (per_s not in (None, 1.0) or (is_whole and not says_s)):
        holds = "holds whole numbers (fps = 1 if it counts s)"
        if per_s not in (None, 1.0):
            holds = f"counts {unit} (fps = {per_s:.6g})"
        raise ParameterError(f"fps is missing: column {layout.frame!r} {holds}")
    if (layout.fps or 0.0) > 1.0 and not is_whole and np.median(steps) < 0.5:
        raise ParameterError(
            f"fps = {layout.fps:g} is given, but column {layout.frame!r} has steps of "
            f"{np.median(steps):.4g}, which are not frames: leave fps out if it holds times in s"
        )


def frames_of(rows: "pd.DataFrame") -> NDArray[np.intp]:
    """Return the frame of each row, of rows in the order of time.

    Rows with the same time are one frame. If each boat has its own time stamps, a frame ends before
    one of its boats is seen again, and is shorter than the time between two rows of a boat.
    """
    stamps, frames = np.unique(rows["time"], return_inverse=True)
    own = rows.groupby("id", sort=False)["time"].diff()
    own = own[own > 0.0]
    if len(stamps) < 3 or not len(own):
        return frames
    if np.quantile(np.diff(stamps), 0.25) > 0.6 * own.quantile(0.1):
        return frames
    names, times = rows["id"].to_numpy(), rows["time"].to_numpy()
    within, number, start, last_seen = 0.9 * float(own.median()), -1, -np.inf, dict[str, float]()
    for index, (name, time) in enumerate(zip(names, times, strict=True)):
        # Repeated rows are in one frame, and rows without a name belong to no boat.
        if last_seen.get(name, time) < time or time - start > within:
            number, start, last_seen = number + 1, time, {}
        if isinstance(name, str):
            last_seen[name] = time
        frames[index] = number
    return frames
