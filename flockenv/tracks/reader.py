"""Tracks of tables (CSV, Parquet) and datasets of `movement`, cleaned and counted."""

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flockenv._io.array_file import is_special
from flockenv._io.extras import require
from flockenv.errors import ParameterError, refuse_unknown
from flockenv.recording import Recording
from flockenv.tracks.assemble import recording_of, unwrapped, velocities
from flockenv.tracks.layout import TrackLayout, layout_beside

if TYPE_CHECKING:
    import pandas as pd
    import xarray

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
            f"{self.missing} rows without a name or a pose, {self.jumps} jumps; steps too fast for "
            f"a velocity: {self.broken}; samples without a velocity: {self.lone}"
        )


class Tracks(NamedTuple):
    """Tracks as a recording, and what of them was left out."""

    recording: Recording
    report: TrackReport


def read_tracks(path: str | os.PathLike[str], layout: TrackLayout | None = None) -> Recording:
    """Read tracks from a file as a recording, which is analyzed and replayed like a simulated one.

    Parameters and errors are those of `load_tracks`.
    """
    return load_tracks(path, layout).recording


def load_tracks(path: str | os.PathLike[str], layout: TrackLayout | None = None) -> Tracks:
    """Read tracks from a file, with the report of what was left out.

    Parameters
    ----------
    path
        A CSV or Parquet table with one row per frame and boat (extra ``plot``). Nothing in the file
        is executed.
    layout
        How tracks lie in it; None for the TOML file beside it, see `layout_beside`.

    Raises
    ------
    ParameterError
        If the file cannot be read, a column is missing or holds other things than numbers, a name
        is there twice in a frame, headings look like degrees where radians are said, everything is
        missing, the arrays would be too large, and as for `recording_of`.
    MissingExtraError
        Without the extra ``plot``.
    """
    path = Path(path)
    layout = layout_beside(path) if layout is None else layout
    try:
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
    if path.suffix.lower() not in SUFFIXES:
        raise ParameterError(f"it ends in none of {', '.join(SUFFIXES)}")
    if is_special(path):
        raise ParameterError("it is no table but a device, a pipe or a socket")
    read = pandas.read_csv if path.suffix.lower() == ".csv" else pandas.read_parquet
    try:
        table: pd.DataFrame = read(path)
    except OSError:
        raise
    except Exception as error:  # Parsers raise errors of many unrelated classes.
        raise ParameterError(f"it is no table: {error}") from error
    return table


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
    in frames where the attribute ``time_unit`` says so. Columns of the layout are not used.

    Parameters
    ----------
    dataset
        The dataset.
    layout
        Pool, hull, scale, center and greatest speed; frames per second where times are in frames.
    center
        Key point that is a boat's position; the mean of all by default.
    tail, head
        Key points that the heading joins; without them the heading is the direction of motion.

    Raises
    ------
    ParameterError
        For a dataset without positions in the plane, unknown key points, and as for `load_tracks`.
    """
    position = dataset.get("position")
    if position is None or not {"time", "space", "individuals"} <= set(position.dims):
        raise ParameterError("the dataset has no position by time, space and individuals")
    if (tail is None) != (head is None):
        raise ParameterError("a heading joins two key points: tail and head, or neither")
    if "keypoints" not in position.dims:
        position = position.expand_dims(keypoints=["position"])
    known = [str(each) for each in position.coords["keypoints"].values]
    chosen = {name: name for name in (center, tail, head) if name is not None}
    refuse_unknown(chosen, known, "key point")
    points = {name: position.sel(keypoints=name, drop=True) for name in chosen}
    points["mean"] = position.mean("keypoints", skipna=False)
    columns = {
        f"{name}_{axis}": point.sel(space=axis, drop=True)
        for name, point in points.items()
        for axis in "xy"
    }
    table = dataset.assign(columns)[list(columns)].to_dataframe().reset_index()
    is_in_frames = dataset.attrs.get("time_unit") == "frames"
    if is_in_frames and layout.fps is None:
        raise ParameterError("times are in frames: name fps in the layout")
    place, ends = center or "mean", (tail, head)
    heading = None if tail is None else tuple(f"{end}_{axis}" for end in ends for axis in "xy")
    described: dict[str, Any] = {
        "frame": "time",
        "fps": layout.fps if is_in_frames else None,
        "id": "individuals",
        "x": f"{place}_x",
        "y": f"{place}_y",
        "heading": heading,
    }
    return from_table(table, replace(layout, **described))


def from_table(table: "pd.DataFrame", layout: TrackLayout) -> Tracks:
    """Return tracks of a table with one row per frame and boat; see `load_tracks`."""
    names = [layout.frame, layout.id, layout.x, layout.y]
    names += [layout.heading] if isinstance(layout.heading, str) else layout.heading or ()
    for name in names:
        if name not in table:
            there = ", ".join(map(str, table.columns))
            raise ParameterError(f"column {name!r} is missing; there are {there}")
    frames, ids = _numbers(table, layout.frame), table[layout.id].convert_dtypes()
    if not np.isfinite(frames).all():
        raise ParameterError(f"column {layout.frame!r} has rows without a number")
    rows = _poses(table, layout)
    used = np.isfinite(rows).all(axis=1) & ids.notna().to_numpy(bool)
    if not used.any():
        raise ParameterError("no row has a name, a position and a heading")
    given = np.array(ids[used].astype(str).tolist())
    # By their length, then alphabet, so that 2 comes before 10.
    order = np.array(sorted(set(given.tolist()), key=lambda name: (len(name), name)))
    by_name = np.argsort(order)
    at_id = by_name[np.searchsorted(order, given, sorter=by_name)]
    times = np.unique(frames)
    at_frame = np.searchsorted(times, frames[used])
    if len(times) * len(order) > max(_FEW, _SPARSEST * len(table)):
        raise ParameterError(
            f"{len(order)} names in {len(times)} frames are too many for {len(table)} rows: join "
            "fragments of tracks, or read a part of the file"
        )
    counts = np.bincount(at_frame * len(order) + at_id)
    if (counts > 1).any():
        frame, boat = np.divmod(int(counts.argmax()), len(order))
        raise ParameterError(
            f"{str(order[boat])!r} is there {counts.max()} times in frame {times[frame]:g}"
        )
    pose = np.full((len(times), len(order), 3), np.nan)
    pose[at_frame, at_id] = rows[used]
    seconds = (times - times[0]) / (1.0 if layout.fps is None else layout.fps)
    return _cleaned(seconds, pose, order, layout, missing=int((~used).sum()))


def _numbers(table: "pd.DataFrame", name: str) -> NDArray[np.float64]:
    try:
        return table[name].to_numpy(dtype=np.float64, na_value=np.nan)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"column {name!r} holds other things than numbers") from error


def _poses(table: "pd.DataFrame", layout: TrackLayout) -> NDArray[np.float64]:
    """Return each row's x and y in cm and heading in rad, from the center of the pool, y up."""
    places = np.stack([_numbers(table, name) for name in (layout.x, layout.y)], axis=-1)
    up = -1.0 if layout.y_down else 1.0
    xy = (places - layout.center) * layout.cm_per_unit * np.array([1.0, up])
    if layout.heading is None:
        heading = np.zeros(len(table))
    elif isinstance(layout.heading, str):
        heading = _numbers(table, layout.heading)
        largest = np.nanmax(np.abs(heading), initial=0.0)
        if layout.heading_unit == "deg":
            heading = np.radians(heading)
        elif layout.wrapped and largest > _FULL_TURN:
            raise ParameterError(
                f"headings reach {largest:.4g}, more than a full turn in radians: if they are in "
                "degrees, say heading_unit = 'deg'"
            )
    else:
        x_tail, y_tail, x_head, y_head = (_numbers(table, name) for name in layout.heading)
        heading = _direction(x_head - x_tail, y_head - y_tail)
    return np.column_stack([xy, up * heading])


def _direction(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angle of vectors, in radians; NaN for none."""
    return np.where((x == 0.0) & (y == 0.0), np.nan, np.arctan2(y, x))


def _cleaned(
    times: NDArray[np.float64],
    pose: NDArray[np.float64],
    ids: NDArray[np.str_],
    layout: TrackLayout,
    missing: int,
) -> Tracks:
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
    recording = recording_of(
        times,
        pose,
        pool=layout.pool,
        hull=layout.hull,
        velocity=velocity,
        ids=ids.tolist(),
        leaders=layout.leaders,
        target=layout.target,
    )
    return Tracks(recording, report)


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
        jumps[there, boat] = ends & too_fast.any()
        there = there[~jumps[there, boat]]
        left = _too_fast(times[there], pose[there, boat, :2], most_cm_s)
        broken[there[1:][left] - 1, boat] = True
    return jumps, broken


def _too_fast(
    times: NDArray[np.float64], points: NDArray[np.float64], most_cm_s: float
) -> NDArray[np.bool_]:
    steps = np.diff(points, axis=0)
    return np.hypot(steps[:, 0], steps[:, 1]) > most_cm_s * np.diff(times)
