"""Times of tracks: seconds from any column of times, and frames."""

import re
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.extras import require
from flockenv.errors import ParameterError, short_repr
from flockenv.tracks.formats import PER_S, unit_of
from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.table import Floats, Table

if TYPE_CHECKING:
    import pandas as pd

_DAY_S = 86_400.0
_STOPWATCH = re.compile(r"^\s*(\d+:\d+\.\d*)\s*$")


def times_of(table: Table) -> Floats:
    """Return the times of all boats' rows in s, from the earliest one on."""
    layout, found = table.layout, table.column(table.layout.frame)
    times = _typed(require("pandas", "plot"), found)
    if times is None:
        times = table.numbers(layout.frame)
        _check_kind(times, layout)
        times = times / (layout.fps or 1.0)
    elif layout.fps is not None:
        raise ParameterError(f"column {layout.frame!r} holds times: leave fps out")
    if not np.isfinite(times).all():
        line = found.index[~np.isfinite(times)][0]
        raise ParameterError(
            f"column {layout.frame!r} has rows without a number, such as {found.index.name} {line}"
        )
    return np.tile(times - times.min() if len(times) else times, len(table.boats))


def _typed(pandas: ModuleType, found: "pd.Series[Any]") -> Floats | None:
    """Return dates, clock times or durations in s; None for anything else."""
    types = pandas.api.types
    if types.is_datetime64_any_dtype(found):
        found = found - found.min()
    if types.is_timedelta64_dtype(found):
        seconds: Floats = found.dt.total_seconds().to_numpy(np.float64)
        return seconds
    texts = found.dropna()
    if types.is_numeric_dtype(found) or not len(texts) or ":" not in str(texts.iloc[0]):
        return None
    # Loggers write 12:34:56,789, and stopwatches 34:56.7.
    points = found.astype(str).str.replace(",", ".")
    points = points.str.replace(_STOPWATCH, r"00:\1", regex=True)
    times = pandas.to_timedelta(points, errors="coerce")
    if times[texts.index].notna().all():
        return _past_midnight(times.dt.total_seconds().to_numpy(np.float64))
    for form in ("ISO8601", "%d.%m.%Y %H:%M:%S", "%d.%m.%Y %H:%M:%S.%f"):
        dates = pandas.to_datetime(points, errors="coerce", utc=True, format=form)
        if dates[texts.index].notna().all():
            return _typed(pandas, dates)
    raise ParameterError(
        f"column {found.name!r} holds {short_repr(str(texts.iloc[0]))}, which is not a number, "
        "a time 12:34:56.7 or a date 2026-01-31 12:34:56.7 or 31.01.2026 12:34:56.7"
    )


def _past_midnight(seconds: Floats) -> Floats:
    """Return clock times, with a day added to those past midnight: the ones before a long gap."""
    stamps = np.unique(seconds[np.isfinite(seconds)])
    gap = int(np.diff(stamps).argmax()) if len(stamps) > 1 else 0
    if len(stamps) < 2 or stamps[-1] > _DAY_S or stamps[gap + 1] - stamps[gap] < _DAY_S / 2:
        return seconds
    return np.where(seconds <= stamps[gap], seconds + _DAY_S, seconds)


def _check_kind(times: Floats, layout: TrackLayout) -> None:
    """Refuse frame numbers that would count as seconds, and seconds as frame numbers."""
    stamps = np.unique(times[np.isfinite(times)])
    steps = np.diff(stamps)
    if not len(steps):
        return
    is_whole = bool((stamps == np.rint(stamps)).all())
    per_s = PER_S.get(unit_of(layout.frame))
    # Steps of 12 may be seconds if the column's name says so; 0, 1, 2 are frames whatever it says.
    says_s = per_s == 1.0 and steps.min() > 1.0
    missing = f"fps is missing: column {layout.frame!r}"
    if layout.fps is None and per_s not in (None, 1.0):
        raise ParameterError(f"{missing} counts {unit_of(layout.frame)} (fps = {per_s:.6g})")
    if layout.fps is None and is_whole and not says_s:
        raise ParameterError(f"{missing} holds whole numbers (fps = 1 if it counts s)")
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
