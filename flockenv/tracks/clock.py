"""Times of tracks: seconds from whatever a column holds, clocks that go back, and frames."""

import re
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.extras import require
from flockenv.errors import ParameterError, shown
from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.table import Floats, column, numbers

if TYPE_CHECKING:
    import pandas as pd

_STEPS_S = (1e-4, 10.0)
"""Steps between samples of anything that swims or drives."""


def times_of(table: "pd.DataFrame", layout: TrackLayout) -> Floats:
    """Return the column of times as it counts, from its least: frames, or s if it has a type."""
    pandas, found = require("pandas", "plot"), column(table, layout.frame)
    times = _typed(pandas, found)
    if times is None:
        times = numbers(table, layout.frame, layout)
        _check_kind(times, layout)
    elif layout.fps is not None:
        raise ParameterError(f"column {layout.frame!r} holds times: leave fps out")
    if not np.isfinite(times).all():
        line = found.index[~np.isfinite(times)][0]
        raise ParameterError(
            f"column {layout.frame!r} has rows without a number, such as {found.index.name} {line}"
        )
    return times - times.min() if len(times) else times


def _typed(pandas: Any, found: Any) -> Floats | None:
    """Return dates, clock times and durations in s, and None for anything else."""
    types = pandas.api.types
    if types.is_datetime64_any_dtype(found):
        found = found - found.min()
    if types.is_timedelta64_dtype(found):
        seconds: Floats = found.dt.total_seconds().to_numpy(np.float64)
        return seconds
    texts = found.dropna()
    if types.is_numeric_dtype(found) or not len(texts) or ":" not in str(texts.iloc[0]):
        return None
    for convert, options in (
        (pandas.to_timedelta, {}),
        (pandas.to_datetime, {"utc": True, "format": "ISO8601"}),
    ):
        values = convert(found.astype(str), errors="coerce", **options)
        if values[texts.index].notna().all():
            return _typed(pandas, values)
    raise ParameterError(
        f"column {found.name!r} holds {shown(str(texts.iloc[0]))}, which is no number, no time "
        "12:34:56.7 and no date 2026-01-31 12:34:56.7"
    )


def _check_kind(times: Floats, layout: TrackLayout) -> None:
    """Refuse frame numbers that would count as seconds, and seconds as frame numbers."""
    steps = np.diff(np.unique(times[np.isfinite(times)]))
    if not len(steps):
        return
    is_whole = (times == np.rint(times)).all()
    counts = re.search("frame|step|image|index|idx|sample|number", layout.frame.lower())
    if layout.fps is None and is_whole and counts:
        raise ParameterError(
            f"fps is missing: column {layout.frame!r} holds whole numbers (fps = 1 if it counts s)"
        )
    if layout.fps is not None and not is_whole and np.median(steps) < 0.5:
        raise ParameterError(
            f"fps = {layout.fps:g} is given, but column {layout.frame!r} has steps of "
            f"{np.median(steps):.4g}, which are no frames: leave fps out if it holds times in s"
        )


def check_order(rows: "pd.DataFrame", layout: TrackLayout) -> None:
    """Refuse rows, of which `time` is in s and in the order of the file, whose clock goes back."""
    steps = rows.groupby("id", sort=False)["time"].diff()
    if (steps < 0.0).any():
        place = int((steps < 0.0).to_numpy().argmax())
        _refuse_order(rows, place, f"of {rows['id'].iloc[place]!r} go")
    # Blocks of several boats each, one after another, are films too, though no name is in both.
    back = rows["time"].diff() < 0.0
    blocks = rows["time"].groupby(back.cumsum().to_numpy())
    if (blocks.size() >= 1.5 * blocks.nunique()).sum() > 1:
        _refuse_order(rows, int(back.to_numpy().argmax()), "go")
    typical = steps[steps > 0.0].median()
    if typical < _STEPS_S[0] or typical > _STEPS_S[1]:
        raise ParameterError(
            f"a boat's samples are {typical:.3g} s apart (median), and {_STEPS_S[0]:g} to "
            f"{_STEPS_S[1]:g} s are accepted: are times in s? fps is the number of units of column "
            f"{layout.frame!r} in a second"
        )


def _refuse_order(rows: "pd.DataFrame", place: int, whose: str) -> None:
    raise ParameterError(
        f"times {whose} back to {rows['time'].iloc[place]:g} s after the start in "
        f"{rows.index.name} {rows.index[place]}: were there two films, or was the clock set back? "
        "Give each film a table of its own, in the order of time"
    )


def frames_of(rows: "pd.DataFrame") -> NDArray[np.intp]:
    """Return the frame of each row.

    Rows of one time are one frame. Where each boat has time stamps of its own, a frame lasts until
    one of its boats is seen again, and less than the boats' own step.
    """
    stamps, frames = np.unique(rows["time"], return_inverse=True)
    own = rows.groupby("id", sort=False)["time"].diff()
    own = own[own > 0.0]
    if len(stamps) < 3 or not len(own):
        return frames
    if np.quantile(np.diff(stamps), 0.25) > 0.6 * own.quantile(0.1):
        return frames
    order = np.argsort(rows["time"].to_numpy(), kind="stable")
    names, times = rows["id"].to_numpy(), rows["time"].to_numpy()
    within, number, start, there = 0.9 * float(own.median()), -1, -np.inf, dict[str, float]()
    for place in order:
        name, time = names[place], times[place]
        # A row that is there twice is in one frame, and one without a name is nobody's.
        if there.get(name, time) < time or time - start > within:
            number, start, there = number + 1, time, {}
        if isinstance(name, str):
            there[name] = time
        frames[place] = number
    return frames
