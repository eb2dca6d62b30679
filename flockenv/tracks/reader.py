"""Tracks of tables (CSV, Parquet), cleaned and counted."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flockenv._io.array_file import is_special
from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.recording import Recording
from flockenv.tracks.assemble import recording_of, unwrapped, velocities
from flockenv.tracks.layout import TrackLayout, read_layout

if TYPE_CHECKING:
    import pandas as pd

SUFFIXES = (".csv", ".parquet", ".pq")
"""Endings of files that `read_tracks` takes."""

_FEW = 1 << 22
_SPARSEST = 16
"""Arrays hold a pose for each frame and name; above `_FEW` a row must be there for so many."""
_FULL_TURN = 2 * np.pi + 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackReport:
    """What of tracks was used, and what was left out.

    Attributes
    ----------
    frames, boats : int
        Different times and names.
    samples : int
        Poses that are used.
    missing : int
        Rows without a name, a position or a heading, which are left out.
    broken : int
        Steps above the greatest speed, such as of wrong detections and of names that were
        exchanged: both samples are used, and no velocity is taken across.
    lone : int
        Samples without a neighbor in time. They have no velocity, and no quantity counts them.
    """

    frames: int
    boats: int
    samples: int
    missing: int
    broken: int
    lone: int

    def __str__(self) -> str:
        return (
            f"{self.samples} poses of {self.boats} boats in {self.frames} frames; left out: "
            f"{self.missing} rows without a name or a pose; steps too fast for a velocity: "
            f"{self.broken}; samples without a velocity: {self.lone}"
        )


def read_tracks(
    source: "str | os.PathLike[str] | pd.DataFrame",
    layout: TrackLayout | None = None,
    report: Callable[[TrackReport], object] = lambda found: None,
) -> Recording:
    """Read tracks as a recording, which is analyzed and replayed like a simulated one.

    Parameters
    ----------
    source
        A table with one row per frame and boat (extra ``plot``), or the CSV or Parquet file of one,
        in which nothing is executed.
    layout
        How tracks lie in it; None for the TOML file beside it: ``a.toml`` for ``a.csv``.
    report
        Called with what was used and left out, which prints as a line.

    Raises
    ------
    ParameterError
        If the file cannot be read, a column is missing or holds other things than numbers, a name
        is there twice in a frame, headings look like degrees where radians are said, everything is
        missing, the arrays would be too large, there is no layout, and as for `recording_of`.
    MissingExtraError
        Without the extra ``plot``.
    """
    if not isinstance(source, str | os.PathLike):
        if layout is None:
            raise ParameterError("layout is missing: a table has no file beside it")
        return _recording(source, layout, report)
    path = Path(source)
    if layout is None:
        beside = path.with_suffix(".toml")
        if not beside.exists():
            raise ParameterError(
                f"{beside} is missing: it names the columns and units of {path.name}"
            )
        layout = read_layout(beside)
    table = read_table(path)
    try:
        return _recording(table, layout, report)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error


def read_table(path: Path) -> "pd.DataFrame":
    """Return the rows of a CSV or Parquet file; a ParameterError names one that is none."""
    pandas = require("pandas", "plot")
    if path.suffix.lower() not in SUFFIXES:
        raise ParameterError(f"{path}: it ends in none of {', '.join(SUFFIXES)}")
    read = pandas.read_csv if path.suffix.lower() == ".csv" else pandas.read_parquet
    try:
        if is_special(path):
            raise ParameterError("a device, a pipe or a socket")
        table: pd.DataFrame = read(path)
    except OSError as error:
        raise ParameterError(f"{path} cannot be read: {error.strerror or error}") from error
    except Exception as error:  # Parsers raise errors of many unrelated classes.
        raise ParameterError(f"{path}: it is no table: {error}") from error
    return table


def _recording(
    table: "pd.DataFrame", layout: TrackLayout, report: Callable[[TrackReport], object]
) -> Recording:
    every = _rows(table, layout)
    frames, rows = np.unique(every["frame"]), _whole(every)
    missing = len(table) - len(rows)
    # By their length, then alphabet, so that 2 comes before 10.
    names = sorted(rows["id"].unique(), key=lambda name: (len(name), name))
    if len(frames) * len(names) > max(_FEW, _SPARSEST * len(table)):
        raise ParameterError(
            f"{len(names)} names in {len(frames)} frames are too many for {len(table)} rows: join "
            "fragments of tracks, or read a part of the file"
        )
    per_s = 1.0 if layout.fps is None else layout.fps
    at = (
        np.searchsorted(frames, rows["frame"]),
        rows["id"].map({name: place for place, name in enumerate(names)}),
    )
    pose = np.full((len(frames), len(names), 3), np.nan)
    pose[at] = rows[["x", "y", "heading"]].to_numpy()
    times = (frames - frames[0]) / per_s
    if layout.heading is None:
        motion, _ = velocities(times, pose, layout.max_speed_cm_s)
        pose[..., 2] = _direction(motion[..., 0], motion[..., 1])
        pose[np.isnan(pose[..., 2])] = np.nan
    pose[..., 2] = unwrapped(pose[..., 2])
    velocity, broken = velocities(times, pose, layout.max_speed_cm_s)
    there = np.isfinite(pose[..., 0])
    recording = recording_of(
        times,
        pose,
        pool=layout.pool,
        hull=layout.hull,
        velocity=velocity,
        ids=names,
        leaders=layout.leaders,
        target=layout.target,
    )
    report(
        TrackReport(
            frames=len(frames),
            boats=len(names),
            samples=int(there.sum()),
            missing=missing,
            broken=broken,
            lone=int((there & np.isnan(velocity[..., 0])).sum()),
        )
    )
    return recording


def _rows(table: "pd.DataFrame", layout: TrackLayout) -> "pd.DataFrame":
    """Return frame, id, x and y in cm and heading in rad, from the center of the pool, y up."""
    names = [layout.frame, layout.id, layout.x, layout.y]
    names += [layout.heading] if isinstance(layout.heading, str) else layout.heading or ()
    for name in names:
        if name not in table:
            there = ", ".join(map(str, table.columns))
            raise ParameterError(f"column {name!r} is missing; there are {there}")
    frames, x, y = (numbers_of(table, name) for name in (layout.frame, layout.x, layout.y))
    if not np.isfinite(frames).all():
        raise ParameterError(f"column {layout.frame!r} has rows without a number")
    up = -1.0 if layout.y_down else 1.0
    if layout.heading is None:
        heading = np.zeros(len(table))
    elif isinstance(layout.heading, str):
        heading = numbers_of(table, layout.heading)
        largest = np.nanmax(np.abs(heading), initial=0.0)
        if layout.heading_unit == "deg":
            heading = np.radians(heading)
        elif layout.wrapped and largest > _FULL_TURN:
            raise ParameterError(
                f"headings reach {largest:.4g}, more than a full turn in radians: if they are in "
                "degrees, say heading_unit = 'deg'"
            )
    else:
        x_tail, y_tail, x_head, y_head = (numbers_of(table, name) for name in layout.heading)
        heading = _direction(x_head - x_tail, y_head - y_tail)
    rows = table[[layout.id]].convert_dtypes().set_axis(["id"], axis=1)
    return rows.assign(
        frame=frames,
        x=(x - layout.center[0]) * layout.cm_per_unit,
        y=(y - layout.center[1]) * layout.cm_per_unit * up,
        heading=up * heading,
    )


def _whole(rows: "pd.DataFrame") -> "pd.DataFrame":
    """Return the rows with a name and a pose, by name, then frame; no name is there twice."""
    is_placed = np.isfinite(rows[["x", "y", "heading"]].to_numpy()).all(axis=1)
    rows = rows[rows["id"].notna() & is_placed]
    if len(rows) == 0:
        raise ParameterError("no row has a name, a position and a heading")
    rows = rows.astype({"id": str}).sort_values(["id", "frame"])
    counts = rows.value_counts(["id", "frame"])
    if counts.iloc[0] > 1:
        name, frame = counts.index[0]
        raise ParameterError(f"{name!r} is there {counts.iloc[0]} times in frame {frame:g}")
    return rows


def numbers_of(table: "pd.DataFrame", name: str) -> NDArray[np.float64]:
    """Return a column, NaN where nothing stands; a ParameterError names one of other things."""
    try:
        return table[name].to_numpy(dtype=np.float64, na_value=np.nan)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"column {name!r} holds other things than numbers") from error


def _direction(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angle of vectors, in radians; NaN for none."""
    return np.where((x == 0.0) & (y == 0.0), np.nan, np.arctan2(y, x))
