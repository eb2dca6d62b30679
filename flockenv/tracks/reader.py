"""Tracks of tables (CSV, Parquet), datasets of `movement` and arrays (npz), cleaned and counted."""

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.array_file import is_special, read_arrays
from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.recording import Recording
from flockenv.tracks.assemble import recording_of, unwrapped, velocities
from flockenv.tracks.layout import TrackLayout, layout_beside

if TYPE_CHECKING:
    import pandas as pd
    import xarray

__all__ = [
    "SUFFIXES",
    "TrackReport",
    "Tracks",
    "from_movement",
    "from_table",
    "load_tracks",
    "read_table",
    "read_tracks",
]

SUFFIXES = (".csv", ".parquet", ".pq")
"""Endings of files that `read_tracks` takes for tables; arrays end in ``.npz``."""

_MOST_POSES = 1 << 27
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
        Rows without a position or a heading, which are left out.
    jumps : int
        Samples left out because it took more than the greatest speed to reach them from the sample
        before and to reach the one after.
    broken : int
        Other steps above the greatest speed, such as names that were exchanged: both samples are
        used, and no velocity is taken across.
    lone : int
        Samples without a neighbor in time. They have no velocity, and no quantity counts them.
    """

    frames: int
    boats: int
    samples: int
    missing: int
    jumps: int
    broken: int
    lone: int

    def __str__(self) -> str:
        return (
            f"{self.samples} poses of {self.boats} boats in {self.frames} frames; left out: "
            f"{self.missing} rows without a pose, {self.jumps} jumps; steps too fast for "
            f"a velocity: {self.broken}; samples without a velocity: {self.lone}"
        )


@dataclass(frozen=True, slots=True)
class Tracks:
    """Tracks as arrays: in cm and s, from the center of the pool.

    Attributes
    ----------
    time_s : float64 array, shape (t,)
        Times from the first frame on.
    pose, velocity : float64 array, shape (t, n, 3)
        As for `recording_of`; rows of NaN where a boat is not there, or has no velocity.
    ids : str array, shape (n,)
        Names.
    report : TrackReport
        What was left out.
    layout : TrackLayout
        As they were read.
    """

    time_s: NDArray[np.float64]
    pose: NDArray[np.float64]
    velocity: NDArray[np.float64]
    ids: NDArray[np.str_]
    report: TrackReport
    layout: TrackLayout

    def to_recording(self) -> Recording:
        """Return the tracks as a recording; errors are those of `recording_of`."""
        layout = self.layout
        return recording_of(
            self.time_s,
            self.pose,
            pool=layout.pool,
            hull=layout.hull,
            velocity=self.velocity,
            ids=self.ids.tolist(),
            leaders=layout.leaders,
            target=layout.target,
        )


def read_tracks(path: str | os.PathLike[str], layout: TrackLayout | None = None) -> Recording:
    """Read tracks from a file as a recording, which is analyzed and replayed like a simulated one.

    Parameters are those of `load_tracks`, errors also those of `recording_of`.
    """
    return load_tracks(path, layout).to_recording()


def load_tracks(path: str | os.PathLike[str], layout: TrackLayout | None = None) -> Tracks:
    """Read tracks from a file as arrays, with the report of what was left out.

    Parameters
    ----------
    path
        A CSV or Parquet table with one row per frame and boat (extra ``plot``), or an ``.npz`` file
        of the arrays ``time_s``, ``pose`` (see `recording_of`; units and center as in the
        layout) and perhaps ``ids``. Nothing in the file is executed.
    layout
        How tracks lie in it; None for the TOML file beside it, see `layout_beside`.

    Raises
    ------
    ParameterError
        If the file cannot be read, a column is missing or holds other things than numbers, a name
        is there twice in a frame, headings look like degrees where radians are said, everything is
        missing, or the arrays would be too large.
    MissingExtraError
        Without the extra ``plot``, for a table.
    """
    path = Path(path)
    layout = layout_beside(path) if layout is None else layout
    try:
        if path.suffix.lower() == ".npz":
            return _from_arrays(read_arrays(path), layout)
        return from_table(read_table(path), layout)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error
    except OSError as error:
        raise ParameterError(f"{path} cannot be read: {error.strerror or error}") from error


def read_table(path: Path) -> "pd.DataFrame":
    """Return the rows of a CSV or Parquet file (extra ``plot``).

    Raises
    ------
    ParameterError
        If it is no such table.
    OSError
        If it cannot be opened.
    """
    pandas = require("pandas", "plot")
    if is_special(path):
        raise ParameterError("it is no table but a device, a pipe or a socket")
    reading = {".csv": pandas.read_csv, ".parquet": pandas.read_parquet, ".pq": pandas.read_parquet}
    if path.suffix.lower() not in reading:
        raise ParameterError(f"it ends in none of .npz, {', '.join(reading)}")
    try:
        table: pd.DataFrame = reading[path.suffix.lower()](path)
    except OSError:
        raise
    except Exception as error:  # Parsers raise errors of many unrelated classes.
        raise ParameterError(f"it is no table: {error}") from error
    return table


def from_table(table: "pd.DataFrame", layout: TrackLayout) -> Tracks:
    """Return tracks of a table with one row per frame and boat; see `read_tracks`."""
    frames = _numbers(table, layout.frame)
    if not np.isfinite(frames).all():
        raise ParameterError(f"column {layout.frame!r} has rows without a number")
    names = _column(table, layout.id).astype(str).to_numpy(dtype=np.str_)
    points, heading = _points(table, layout)
    frame_values, at_frame = np.unique(frames, return_inverse=True)
    ids, at_id = np.unique(names, return_inverse=True)
    ids, at_id = _in_order(ids, at_id)
    if len(frame_values) * len(ids) > _MOST_POSES:
        raise ParameterError(
            f"{len(ids)} names in {len(frame_values)} frames are too many for one recording: join "
            "fragments of tracks, or read a part of the file"
        )
    places = at_frame * len(ids) + at_id
    counts = np.bincount(places, minlength=1)
    if (counts > 1).any():
        frame, name = np.divmod(int(counts.argmax()), len(ids))
        raise ParameterError(
            f"{str(ids[name])!r} is there {counts.max()} times in frame {frame_values[frame]:g}"
        )
    pose = np.full((len(frame_values), len(ids), 3), np.nan)
    pose[at_frame, at_id, :2] = points
    pose[at_frame, at_id, 2] = heading
    times = frame_values / (1.0 if layout.fps is None else layout.fps)
    return _cleaned(times, pose, ids, layout)


def _in_order(
    ids: NDArray[np.str_], at_id: NDArray[np.intp]
) -> tuple[NDArray[np.str_], NDArray[np.intp]]:
    """Return names by their length, then alphabet, so that 2 comes before 10; and new places."""
    order = sorted(range(len(ids)), key=lambda place: (len(ids[place]), ids[place]))
    new = np.empty(len(ids), np.intp)
    new[order] = np.arange(len(ids))
    return ids[order], new[at_id]


def _column(table: "pd.DataFrame", name: str) -> "pd.Series[Any]":
    if name not in table:
        raise ParameterError(
            f"column {name!r} is missing; there are {', '.join(map(str, table.columns))}"
        )
    column: pd.Series[Any] = table[name]
    return column


def _numbers(table: "pd.DataFrame", name: str) -> NDArray[np.float64]:
    column = _column(table, name)
    try:
        return column.to_numpy(dtype=np.float64, na_value=np.nan)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"column {name!r} holds other things than numbers") from error


def _points(
    table: "pd.DataFrame", layout: TrackLayout
) -> tuple[NDArray[np.float64], NDArray[np.float64] | float]:
    points = np.stack([_numbers(table, name) for name in (layout.x, layout.y)], axis=-1)
    if layout.heading is None:
        return points, 0.0
    if isinstance(layout.heading, str):
        return points, _numbers(table, layout.heading)
    x_tail, y_tail, x_head, y_head = (_numbers(table, name) for name in layout.heading)
    return points, _direction(x_head - x_tail, y_head - y_tail)


def _direction(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angle of vectors, in radians; NaN for none."""
    return np.where((x == 0.0) & (y == 0.0), np.nan, np.arctan2(y, x))


def from_movement(
    dataset: "xarray.Dataset",
    layout: TrackLayout,
    *,
    center: str | None = None,
    tail: str | None = None,
    head: str | None = None,
) -> Tracks:
    """Return tracks of a dataset of poses of the package `movement`.

    Its ``position`` has the dimensions time, space, keypoints and individuals; ``time`` is in s, or
    in frames where the attribute ``time_unit`` says so. Columns and frames per second of the layout
    are not used.

    Parameters
    ----------
    dataset
        The dataset.
    layout
        Pool, hull, scale, center and greatest speed.
    center
        Key point that is a boat's position; the mean of all by default.
    tail, head
        Key points that the heading joins; without them the heading is the direction of motion.

    Raises
    ------
    ParameterError
        For a dataset without positions in the plane, unknown key points, and as for `read_tracks`.
    """
    if "position" not in dataset or not {"time", "space", "individuals"} <= set(
        dataset["position"].dims
    ):
        raise ParameterError(
            "the dataset has no position by time, space, keypoints and individuals"
        )
    position = dataset["position"]
    if "keypoints" not in position.dims:
        position = position.expand_dims("keypoints")
    position = position.sel(space=["x", "y"]).transpose("time", "individuals", "keypoints", "space")
    known = (
        [str(each) for each in position.coords["keypoints"].values]
        if ("keypoints" in position.coords)
        else []
    )

    def point(name: str) -> NDArray[np.float64]:
        if name not in known:
            raise ParameterError(f"key point {name!r} is not there: {', '.join(known)}")
        return position.values[:, :, known.index(name)].astype(np.float64)

    values = position.values.astype(np.float64)
    points = values.mean(axis=2) if center is None else point(center)
    if (tail is None) != (head is None):
        raise ParameterError("a heading joins two key points: tail and head, or neither")
    pose = np.full((*points.shape[:2], 3), np.nan)
    pose[..., :2] = points
    if tail is None or head is None:
        layout = replace(layout, heading=None)
        pose[..., 2] = 0.0
    else:
        pose[..., 2] = _direction(*np.moveaxis(point(head) - point(tail), -1, 0))
        layout = replace(layout, heading="heading", heading_unit="rad")
    times = dataset["time"].values.astype(np.float64)
    if dataset.attrs.get("time_unit") == "frames":
        if layout.fps is None:
            raise ParameterError("times are in frames: name fps in the layout")
        times = times / layout.fps
    ids = np.array([str(each) for each in dataset["individuals"].values], np.str_)
    return _cleaned(times, pose, ids, layout)


def _from_arrays(arrays: dict[str, NDArray[Any]], layout: TrackLayout) -> Tracks:
    if not {"time_s", "pose"} <= arrays.keys() <= {"time_s", "pose", "ids"}:
        raise ParameterError(
            f"it holds {', '.join(arrays) or 'nothing'}, not time_s, pose and perhaps ids"
        )
    time_s, pose = arrays["time_s"], arrays["pose"]
    if pose.ndim != 3 or pose.shape[2] != 3 or time_s.shape != pose.shape[:1]:
        raise ParameterError(
            f"pose has shape {pose.shape} for time_s of shape {time_s.shape}, expected (t, n, 3)"
        )
    ids = arrays.get("ids", np.arange(pose.shape[1])).astype(np.str_)
    if ids.shape != pose.shape[1:2]:
        raise ParameterError(f"ids holds {ids.size} names for {pose.shape[1]} boats")
    return _cleaned(time_s.astype(np.float64), pose.astype(np.float64), ids, layout)


def _cleaned(
    times: NDArray[np.float64],
    raw: NDArray[np.float64],
    ids: NDArray[np.str_],
    layout: TrackLayout,
) -> Tracks:
    if len(times) == 0 or not (np.diff(times) > 0).all():
        raise ParameterError("times must increase, and there must be one at least")
    pose = _scaled(raw, layout)
    absent = ~np.isfinite(pose).all(axis=-1)
    pose[absent] = np.nan
    if absent.all():
        raise ParameterError("no row has both a position and a heading")
    missing = int(np.isfinite(raw[..., :2]).any(axis=-1).sum() - (~absent).sum())
    jumps, broken = _jumps(times, pose, layout.max_speed_cm_s)
    pose[jumps] = np.nan
    if layout.heading is None:
        motion = velocities(times, pose, broken)
        pose[..., 2] = _direction(motion[..., 0], motion[..., 1])
        pose[np.isnan(pose[..., 2])] = np.nan
    pose[..., 2] = unwrapped(pose[..., 2])
    velocity = velocities(times, pose, broken)
    there = np.isfinite(pose[..., 0])
    report = TrackReport(
        frames=len(times),
        boats=len(ids),
        samples=int(there.sum()),
        missing=missing,
        jumps=int(jumps.sum()),
        broken=int(broken.sum()),
        lone=int((there & np.isnan(velocity[..., 0])).sum()),
    )
    return Tracks(times - times[0], pose, velocity, ids, report, layout)


def _scaled(raw: NDArray[np.float64], layout: TrackLayout) -> NDArray[np.float64]:
    """Return poses in cm and rad from the center of the pool, y up."""
    pose = raw.copy()
    up = -1.0 if layout.y_down else 1.0
    pose[..., :2] = (raw[..., :2] - layout.center) * (layout.cm_per_unit * np.array([1.0, up]))
    if isinstance(layout.heading, str):
        heading = raw[..., 2]
        if layout.heading_unit == "deg":
            heading = np.radians(heading)
        elif layout.wrapped and np.nanmax(np.abs(heading), initial=0.0) > _FULL_TURN:
            raise ParameterError(
                f"headings reach {np.nanmax(np.abs(heading)):.4g}, more than a full turn in "
                "radians: if they are in degrees, say heading_unit = 'deg'"
            )
        pose[..., 2] = heading * up
    else:
        pose[..., 2] = raw[..., 2] * up
    return pose


def _jumps(
    times: NDArray[np.float64], pose: NDArray[np.float64], most_cm_s: float
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return samples that only faster steps than the greatest reach, and the other such steps."""
    samples, boats = pose.shape[:2]
    jumps = np.zeros((samples, boats), bool)
    broken = np.zeros((max(samples - 1, 0), boats), bool)
    for boat in range(boats):
        there = np.flatnonzero(np.isfinite(pose[:, boat, 0]))
        too_fast = _too_fast(times[there], pose[there, boat, :2], most_cm_s)
        # A track's first and last sample have no other side.
        ends = np.r_[True, too_fast] & np.r_[too_fast, True]
        jumps[there, boat] = ends & (too_fast.any() if len(too_fast) else False)
        there = there[~jumps[there, boat]]
        left = _too_fast(times[there], pose[there, boat, :2], most_cm_s)
        broken[there[1:][left] - 1, boat] = True
    return jumps, broken


def _too_fast(
    times: NDArray[np.float64], points: NDArray[np.float64], most_cm_s: float
) -> NDArray[np.bool_]:
    steps = np.diff(points, axis=0)
    return np.hypot(steps[:, 0], steps[:, 1]) > most_cm_s * np.diff(times)
