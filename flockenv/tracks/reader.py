"""Tracks of tables, datasets and arrays as recordings."""

import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv._io.arguments import check_function, items, materialized, series, with_gaps
from flockenv.errors import ParameterError, refuse_unknown, short_repr
from flockenv.order import order_series
from flockenv.parameters import FlockParameters
from flockenv.recording import PHASES, PRECISIONS, Recording
from flockenv.recording.checks import check_array
from flockenv.tracks.dataset import dataset_table
from flockenv.tracks.layout import TrackLayout, description_of, naming, read_layout
from flockenv.tracks.motion import Floats, Motion, in_water, motion_with_bows, unwrapped
from flockenv.tracks.report import TrackReport, report_of
from flockenv.tracks.samples import REPEATED, check_samples, frames_of, poses_of, samples_of
from flockenv.tracks.table import check_ending, plain_table, read_table

if TYPE_CHECKING:
    import pandas as pd
    import xarray

_FASTEST_CM_S = 1000.0
"""Largest median speed of a boat."""


def read_tracks(
    source: "str | os.PathLike[str] | pd.DataFrame | xarray.Dataset",
    layout: TrackLayout | None = None,
    report: Callable[[TrackReport], object] = lambda report: None,
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
        two positions in one frame, units contradict the layout, no row can be used, the arrays
        would be too large, or there is no layout. Also for the reasons of `recording_of`.
    MissingExtraError
        Without the extra ``plot``.
    """
    if not isinstance(layout, TrackLayout | None):
        raise TypeError(f"layout must be a TrackLayout, not {short_repr(layout)}")
    check_function(report, "report")
    if isinstance(source, str | os.PathLike):
        path = Path(source)
        description = description_of(path)
        check_ending(path)
        layout = read_layout(description) if layout is None else layout
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
    """Return the rows of a table as a recording, and call `report` with what was left out."""
    samples, is_named = samples_of(rows, layout)
    goes_back = samples[samples["why"] != REPEATED].groupby("id")["time"].diff() < 0.0
    samples = samples.sort_values("time", kind="stable")
    samples["frame"] = frames_of(samples)
    used = samples[samples["why"] == ""]
    check_samples(samples, used, is_named)
    names, time_s, stamps, pose = poses_of(samples, used)
    motion = motion_with_bows(stamps, pose, layout)
    flock = {name: getattr(layout, name) for name in ("pool", "hull", "leaders", "target")}
    recording = recording_of(time_s, pose, velocity=motion.velocity, ids=names, **flock)
    track_report = report_of(samples, time_s, pose, motion, layout)
    unnamed = layout.id is not None and not is_named
    report(replace(track_report, unsorted=int(goes_back.sum()), unnamed=unnamed))
    return recording


def recording_of(
    time_s: ArrayLike,
    pose: ArrayLike,
    *,
    pool: str | tuple[float, float],
    hull: tuple[float, float] = (5.0, 0.5),
    velocity: ArrayLike | None = None,
    phase: ArrayLike | None = None,
    ids: Sequence[str] | None = None,
    leaders: Sequence[str] = (),
    target: str | Sequence[str] = "cw",
    discs: Iterable[Sequence[float]] = (),
    walls: Iterable[Sequence[float]] = (),
) -> Recording:
    """Return tracks of real boats, or of anything else with a heading, as a recording.

    It is analyzed, replayed and exported like a simulated one. Quantities at a time are those
    of the normal boats that have a pose and a velocity then.

    Parameters
    ----------
    time_s
        Times in s, increasing, shape (t,).
    pose
        Shape (t, n, 3): [x cm, y cm from the pool's center, heading rad counter-clockwise from x].
        Rows of NaN if a boat is missing.
    pool
        "narrow", "wide", or the outer and the inner radius in cm; (inf, 0) for none.
    hull
        Radius in cm, and half the length of the straight part over the radius; (r, 0) is a disc.
    velocity
        Shape (t, n, 3) in cm/s, cm/s and rad/s. None: differences of the poses, central if there is
        a pose before and after, weighted by the steps in time. No difference is taken across a gap;
        a boat with a single pose has no velocity.
    phase
        "fw", "nop1", "bw" or "nop2" at each time, shape (t,). None: the phases are unknown, and all
        samples are analyzed.
    ids
        A name for each boat, shape (n,); "0", "1", … by default.
    leaders
        Names of the leaders. They come first in the recording.
    target
        The direction in which they lead, "cw" or "ccw", and in which signed order is positive.
    discs, walls
        Obstacles in the pool, as in `FlockParameters`; replay pages show them.

    Raises
    ------
    ParameterError
        For shapes that do not match, rows with only some NaN, no pose at all, median speeds of a
        boat above 10 m/s, centers more than a hull's width outside the water, and unknown or
        repeated names.
    """
    times, poses, velocities = _checked(time_s, pose, velocity)
    names = [str(name) for name in items(range(poses.shape[1]) if ids is None else ids, "ids")]
    leaders = [str(name) for name in items(leaders, "leaders")]
    order = _leaders_first(names, leaders, poses.shape[1])
    poses, velocities = poses[:, order], velocities[:, order]
    if (hull_numbers := series(hull, "hull")).shape != (2,):
        raise ParameterError(f"hull = {short_repr(hull)} is not accepted: two numbers")
    fields = dict(zip(("boat_radius_cm", "boat_shape"), hull_numbers.tolist(), strict=True))
    fields |= {"target": materialized(target), "discs": discs, "walls": walls}
    parameters = FlockParameters(n_boats=len(names), n_leaders=len(leaders), pool=pool, **fields)
    _check_units(poses, velocities, parameters)
    phases, analyzed = _phases(phase, times)
    is_leader = np.arange(len(names)) < len(leaders)
    return Recording(
        time_s=times,
        phase=phases,
        in_analysis_window=analyzed,
        pose=poses,
        velocity=velocities,
        # Quantities leave out boats without a velocity, here the leaders.
        order=order_series(poses, np.where(is_leader[:, None], np.nan, velocities)),
        parameters=parameters,
        seed=0,
        version=_core.__version__,
        ids=np.array(names)[order],
    )


def _checked(
    time_s: ArrayLike, pose: ArrayLike, velocity: ArrayLike | None
) -> tuple[Floats, Floats, Floats]:
    """Check times, poses and velocities, and return them with continuous headings."""
    times, poses = with_gaps(time_s, "time_s"), with_gaps(pose, "pose")
    shape = (times.size, np.atleast_2d(poses).shape[1], 3)
    check_array("time_s", times, shape[:1], PRECISIONS)
    check_array("pose", poses, shape, PRECISIONS, gaps=True)
    if not (np.diff(times) > 0.0).all():
        raise ParameterError("time_s must increase")
    if np.isnan(poses).all():
        raise ParameterError("pose is not accepted: it is NaN everywhere, no boat is ever present")
    poses[..., 2] = unwrapped(poses[..., 2])
    velocity = Motion.from_poses(times, poses).velocity if velocity is None else velocity
    velocities = with_gaps(velocity, "velocity")
    check_array("velocity", velocities, shape, PRECISIONS, gaps=True)
    return times, poses, velocities


def _phases(phase: ArrayLike | None, times: Floats) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """Return each sample's phase, and whether the sample is analyzed.

    Without phases, the phase is "" and every sample is analyzed.
    """
    phases, analyzed = np.full(times.shape, ""), np.ones(times.shape, bool)
    if phase is not None:
        phases = np.array([*map(str, items(phase, "phase"))])
        analyzed = _core.sampled_analysis_window(times, phases.tolist())
    return phases.astype(PHASES.dtype), analyzed


def _leaders_first(names: list[str], leaders: list[str], boats: int) -> list[int]:
    """Return the indices of the leaders, in their order, followed by those of the other boats."""
    if len(names) != boats:
        raise ParameterError(f"ids holds {len(names)} names for {boats} boats")
    refuse_unknown(leaders, names, "leader among the ids")
    if len(set(leaders)) < len(leaders) or len(set(names)) < len(names):
        raise ParameterError("ids or leaders holds a name more than once")
    others = [name for name in names if name not in leaders]
    return [names.index(name) for name in (*leaders, *others)]


def _check_units(pose: Floats, velocity: Floats, parameters: FlockParameters) -> None:
    """Refuse speeds and positions that boats in the pool cannot have, such as those in pixels."""
    speed = np.hypot(velocity[..., 0], velocity[..., 1])
    has_speed = ~np.isnan(speed).all(axis=0)
    fastest_cm_s = np.nanmedian(speed[:, has_speed], axis=0).max(initial=0.0)
    if fastest_cm_s > _FASTEST_CM_S:
        raise ParameterError(
            f"a boat moves at {fastest_cm_s / 100:.3g} m/s in the median, above "
            f"{_FASTEST_CM_S / 100:g} m/s: are positions in cm and times in s?"
        )
    present = ~np.isnan(pose[..., 0])
    outside = present & ~in_water(
        parameters.pool, np.hypot(pose[..., 0], pose[..., 1]), 2 * parameters.boat_radius_cm
    )
    if outside.any():
        raise ParameterError(
            f"{outside.sum() / present.sum():.0%} of the centers ({outside.sum()}) lie outside the "
            "pool, or in the obstacle in its middle: are positions in cm, from the center of the "
            "pool, and rows of missing boats NaN?"
        )
