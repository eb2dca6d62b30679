"""Tracks of tables and datasets as recordings, with a report of omitted rows."""

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.arguments import check_function
from flockenv.errors import ParameterError, short_repr
from flockenv.recording import Recording
from flockenv.tracks.assemble import recording_of
from flockenv.tracks.layout import TrackLayout, description_of, naming, read_layout
from flockenv.tracks.motion import Motion, bows_of, check_by_motion, direction, unwrapped
from flockenv.tracks.report import TrackReport
from flockenv.tracks.samples import TWICE, samples_of
from flockenv.tracks.table import Floats, check_ending, dataset_table, plain_table, read_table

if TYPE_CHECKING:
    import pandas as pd
    import xarray

_STUCK = 20


def read_tracks(
    source: "str | os.PathLike[str] | pd.DataFrame | xarray.Dataset",
    layout: TrackLayout | None = None,
    report: Callable[[TrackReport], object] = lambda found: None,
) -> Recording:
    """Read tracks as a recording, to analyze and replay it like a simulated one.

    Rows without a name, a position or a heading, outside the water, with too little confidence, or
    repeated in the table are left out and counted. Rows may be in any order.

    Parameters
    ----------
    source
        A table with one row per frame and boat, or one per frame (extra ``plot``); a dataset with
        ``position`` and ``confidence`` as the package `movement` makes it (extra ``sweep``); or a
        file in which nothing is executed: text (.csv, .tsv, .txt, also with .gz) or Parquet.
    layout
        The layout of the source; None for the TOML file beside it: ``a.toml`` for ``a.csv``.
    report
        Called with a report of what was used and left out; it prints as a few lines.

    Raises
    ------
    ParameterError
        If the file cannot be read, a column is missing or holds anything but numbers, a boat has
        two positions in one frame, units contradict the layout, all data are missing, the arrays
        would be too large, or there is no layout. Also for the reasons of `recording_of`.
    MissingExtraError
        Without the extra ``plot``.
    """
    if not isinstance(layout, TrackLayout | None):
        raise TypeError(f"layout must be a TrackLayout, not {short_repr(layout)}")
    check_function(report, "report")
    if isinstance(source, str | os.PathLike):
        path = Path(source)
        if layout is None:
            description = description_of(path)
            check_ending(path)
            layout = read_layout(description)
        with naming(path):
            return _recording(read_table(path, layout), layout, report)
    if layout is None:
        raise ParameterError("layout is missing: a table in memory has no file beside it")
    table: Any = source
    if hasattr(table, "data_vars"):
        return _recording(*dataset_table(table, layout), report)
    return _recording(plain_table(table), layout, report)


def _recording(
    rows: "pd.DataFrame", layout: TrackLayout, report: Callable[[TrackReport], object]
) -> Recording:
    samples, is_named = samples_of(rows, layout)
    unsorted = samples[samples["why"] != TWICE].groupby("id")["time"].diff() < 0.0
    samples = samples.sort_values("time", kind="stable")
    samples["frame"] = _frames(samples)
    _check_samples(samples, layout, is_named)
    names, time_s, stamps, pose = _poses(samples)
    motion = _turned_into_motion(stamps, pose, layout)
    flock = {name: getattr(layout, name) for name in ("pool", "hull", "leaders", "target")}
    recording = recording_of(time_s, pose, velocity=motion.velocity, ids=names, **flock)
    found = _report(samples, time_s, pose, motion, layout)
    unnamed = layout.id is not None and not is_named
    report(replace(found, unsorted=int(unsorted.sum()), unnamed=unnamed))
    return recording


def _turned_into_motion(stamps: Floats, pose: Floats, layout: TrackLayout) -> Motion:
    """Return the motion of poses, after turning their headings into continuous ones of the bows."""
    motion = Motion.from_poses(stamps, pose, layout.max_speed_cm_s)
    if layout.heading is None and layout.quaternion is None:
        pose[..., 2] = direction(motion.velocity[..., 0] + 1j * motion.velocity[..., 1])
        pose[np.isnan(pose[..., 2])] = np.nan
    elif layout.axis:
        pose[..., 2] = bows_of(pose[..., 2], motion)
    pose[..., 2] = unwrapped(pose[..., 2])
    motion = Motion.from_poses(stamps, pose, layout.max_speed_cm_s)
    check_by_motion(pose[..., 2], motion, layout)
    return motion


def _report(
    samples: "pd.DataFrame", time_s: Floats, pose: Floats, motion: Motion, layout: TrackLayout
) -> TrackReport:
    """Return the report of used and omitted samples."""
    speed = np.hypot(*np.moveaxis(motion.velocity, -1, 0)[:2])
    used, omitted = samples[samples["why"] == ""], samples[samples["why"] != ""]
    counts = omitted.fillna({"id": ""}).groupby(["why", "id"]).size()
    gaps = np.concatenate([motion.split(boat)[1] for boat in range(pose.shape[1])])
    steps, speeds, count = np.diff(time_s), speed[~np.isnan(speed)], int(motion.present.sum())
    step_s = float(np.median(steps)) if len(steps) else 0.0
    # On a regular clock, frames without a boat have no row.
    empty = int((np.rint(steps[steps > motion.longest_s] / step_s) - 1).sum())
    return TrackReport(
        frames=len(time_s),
        boats=pose.shape[1],
        samples=count,
        missing=pose.shape[1] * (len(time_s) + empty) - count,
        duration_s=float(time_s[-1]),
        step_s=step_s,
        median_speed_cm_s=float(np.median(speeds)) if len(speeds) else float("nan"),
        left_out={why: counts[why].to_dict() for why in counts.index.unique(0)},
        gaps=len(gaps),
        longest_gap_s=float(gaps.max(initial=0.0)),
        broken=motion.broken,
        lone=int((motion.present & np.isnan(speed)).sum()),
        cosine=motion.cosine(pose[..., 2]),
        stuck=_stuck(used, layout),
        held=_held(used),
    )


def _check_samples(samples: "pd.DataFrame", layout: TrackLayout, is_named: bool) -> None:
    """Refuse samples of which none counts, or two of one boat at one time."""
    used = samples[samples["why"] == ""]
    if used.empty:
        counts = [f"{count} {why}" for why, count in samples["why"].value_counts().items()]
        found = ", ".join(counts) or "there are no rows"
        raise ParameterError(f"no row has a name, a position and a heading in the water: {found}")
    again = used[used.duplicated(["id", "time"])]
    if len(again) and not is_named:
        raise ParameterError("id is missing: several rows have one time, so boats have names")
    for line, name, time in again[["id", "time"]].head(1).itertuples():
        count = ((used["id"] == name) & (used["time"] == time)).sum()
        raise ParameterError(
            f"{name!r} appears {count} times in frame {time * (layout.fps or 1):g}, at different "
            f"positions, the second time in {used.index.name} {line}: were there two films, or "
            "was the clock set back? Give each film a table of its own"
        )
    _check_names(used)


def _poses(samples: "pd.DataFrame") -> tuple[list[str], Floats, Floats, Floats]:
    """Return the names (n,), times (t,), each boat's own times (t, n), and poses (t, n, 3)."""
    used = samples[samples["why"] == ""]
    # Sorted by length, then alphabetically, so that 2 comes before 10.
    names = sorted(used["id"].unique(), key=lambda name: (len(name), name))
    time_s = samples.groupby("frame")["time"].agg(["min", "max"]).mean(axis=1).to_numpy()
    # Arrays hold a pose for each frame and name; in large ones at least a sixteenth must exist.
    if len(time_s) * len(names) > max(1 << 22, 16 * len(samples)):
        raise ParameterError(
            f"{len(names)} names in {len(time_s)} frames are too many for {len(samples)} rows: "
            "join fragments of tracks"
        )
    pose = np.full((len(time_s), len(names), 3), np.nan)
    stamps = np.tile(time_s[:, None], len(names))
    at = used["frame"], used["id"].map({name: index for index, name in enumerate(names)})
    pose[at], stamps[at] = used[["x", "y", "heading"]], used["time"]
    return names, time_s - time_s[0], stamps, pose


def _frames(rows: "pd.DataFrame") -> NDArray[np.intp]:
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


def _check_names(used: "pd.DataFrame") -> None:
    """Refuse two spellings of a name that never appear in one frame: they would be two boats."""
    names = used["id"].drop_duplicates()
    plain = names.str.normalize("NFKC").str.casefold()
    plain = plain.str.replace(r"(?<!\d)0+(?=\d)", "", regex=True)
    for _, like in names.groupby(plain):
        if len(like) > 1 and used.loc[used["id"].isin(like), "frame"].is_unique:
            raise ParameterError(
                f"the names {', '.join(map(repr, like))} are never in one frame, and differ in "
                "case or leading zeros only: give each boat one spelling of its name"
            )


def _stuck(used: "pd.DataFrame", layout: TrackLayout) -> dict[str, tuple[float, float, int]]:
    """Return boats that stay at exactly one point in many samples, in units of the file."""
    counts = used.value_counts(["id", "x", "y"]).reset_index()
    share = counts["id"].map(used["id"].value_counts()) / 10
    # Two boats are never at one point.
    shared = used[used.duplicated(["frame", "x", "y"], keep=False)].value_counts(["x", "y"])
    is_shared = counts.set_index(["x", "y"]).index.isin(shared.index[shared >= 6])
    counts = counts[is_shared | ((counts["count"] >= _STUCK) & (counts["count"] >= share))]
    (x, y), scale = layout.center, layout.cm_per_unit or 1.0
    up = -scale if layout.y_down else scale
    found = counts.drop_duplicates("id").itertuples(index=False)
    return {str(n): (at / scale + x, above / up + y, int(count)) for n, at, above, count in found}


def _held(used: "pd.DataFrame") -> dict[str, int]:
    """Return boats that move with one heading in many samples, and every other one in few."""
    # A boat that never moves keeps its heading, too.
    moving = used.drop_duplicates(["id", "x", "y"])
    counts: Any = moving.value_counts(["id", "heading"]).groupby("id")
    most, second = (counts.nth(rank).droplevel("heading").sort_index() for rank in (0, 1))
    held = most[(most >= _STUCK) & (most >= 10 * second.reindex(most.index))]
    return {str(name): int(count) for name, count in held.items()}
