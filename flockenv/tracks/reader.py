"""Tracks of tables (CSV, Parquet), cleaned and counted."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flockenv.errors import ParameterError
from flockenv.recording import Recording
from flockenv.tracks.assemble import Floats, direction, recording_of, unwrapped, velocities
from flockenv.tracks.layout import TrackLayout, read_layout, read_table, rows_of

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True)
class TrackReport:
    """What of tracks was used, and what was left out.

    Attributes
    ----------
    frames, boats, samples : int
        Different times, different names, and poses that are used.
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
    layout, table = layout or read_layout(path.with_suffix(".toml")), read_table(path)
    try:
        return _recording(table, layout, report)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error


def _recording(
    table: "pd.DataFrame", layout: TrackLayout, report: Callable[[TrackReport], object]
) -> Recording:
    names, frames, pose = _poses(rows_of(table, layout))
    missing = len(table) - int(np.isfinite(pose[..., 0]).sum())
    time_s = (frames - frames[0]) / (layout.fps or 1.0)
    if layout.heading is None:
        motion, _ = velocities(time_s, pose, layout.max_speed_cm_s)
        pose[..., 2] = direction(motion[..., 0], motion[..., 1])
        pose[np.isnan(pose[..., 2])] = np.nan
    pose[..., 2] = unwrapped(pose[..., 2])
    velocity, broken = velocities(time_s, pose, layout.max_speed_cm_s)
    flock = {name: getattr(layout, name) for name in ("pool", "hull", "leaders", "target")}
    recording = recording_of(time_s, pose, velocity=velocity, ids=names, **flock)
    there = ~np.isnan(pose[..., 0])
    samples, lone = int(there.sum()), int((there & np.isnan(velocity[..., 0])).sum())
    report(TrackReport(len(frames), len(names), samples, missing, broken, lone))
    return recording


def _poses(every: "pd.DataFrame") -> tuple[list[str], Floats, Floats]:
    """Return the names (n,), frames (t,) and poses (t, n, 3) of rows with a name and a pose."""
    is_placed = np.isfinite(every[["x", "y", "heading"]].to_numpy()).all(axis=1)
    rows = every[every["id"].notna() & is_placed].astype({"id": str})
    if rows.empty:
        raise ParameterError("no row has a name, a position and a heading")
    counts = rows.value_counts(["id", "frame"])
    if counts.iloc[0] > 1:
        name, frame = counts.index[0]
        raise ParameterError(f"{name!r} is there {counts.iloc[0]} times in frame {frame:g}")
    # By their length, then alphabet, so that 2 comes before 10.
    names = sorted(rows["id"].unique(), key=lambda name: (len(name), name))
    frames = np.unique(every["frame"])
    # Arrays hold a pose for each frame and name: in large ones every sixteenth must be there.
    if len(frames) * len(names) > max(1 << 22, 16 * len(every)):
        raise ParameterError(
            f"{len(names)} names in {len(frames)} frames are too many for {len(every)} rows: join "
            "fragments of tracks, or read a part of the file"
        )
    wide = rows.pivot(index="frame", columns="id").reindex(frames)
    return names, frames, np.stack([wide[each][names] for each in ("x", "y", "heading")], axis=-1)
