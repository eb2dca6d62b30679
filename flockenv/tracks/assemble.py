"""What a recording of tracked boats is made of: poses with gaps, velocities, order parameters."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv.errors import ParameterError, shown
from flockenv.order import OrderSeries, order_series
from flockenv.parameters import FlockParameters
from flockenv.recording import PHASES, Recording

__all__ = ["recording_of", "unwrapped", "velocities"]

_FASTEST_CM_S = 1000.0
_MOST_OUTSIDE = 0.1


def recording_of(
    time_s: ArrayLike,
    pose: ArrayLike,
    *,
    pool: Any,
    hull: tuple[float, float] = (5.0, 0.5),
    velocity: ArrayLike | None = None,
    phase: ArrayLike | None = None,
    ids: Sequence[str] | None = None,
    leaders: Sequence[str] = (),
    target: str | Sequence[str] = "cw",
    discs: Any = (),
    walls: Any = (),
) -> Recording:
    """Return tracks of real boats, or of anything else that heads somewhere, as a recording.

    It is analyzed, replayed and exported like a simulated one. Quantities at a time are those
    of the normal boats that have a pose and a velocity then.

    Parameters
    ----------
    time_s
        Times in s, increasing, shape (t,).
    pose
        Shape (t, n, 3): [x cm, y cm from the pool's center, heading rad counter-clockwise from
        x]. Rows of NaN where a boat is not there.
    pool
        "narrow", "wide", or the outer and the inner radius in cm; (inf, 0) for none.
    hull
        Radius in cm, and half the length of the straight part in radii; (r, 0) is a disc.
    velocity
        Shape (t, n, 3) in cm/s, cm/s and rad/s. None: differences of the poses, central ones
        where a boat is there before and after; a boat that is there for one sample has none.
    phase
        "fw", "nop1", "bw" or "nop2" at each time, shape (t,). None: not known, and all samples
        count as analyzed.
    ids
        A name for each boat, shape (n,); "0", "1", … by default.
    leaders
        Those of the names that lead. They come first in the recording.
    target
        Where they lead, "cw" or "ccw"; the direction that signed order counts towards.
    discs, walls
        Obstacles in the pool, as in `FlockParameters`; replay pages show them.

    Raises
    ------
    ParameterError
        For shapes that do not match, rows of which a part is NaN, no pose at all, speeds above
        10 m/s (in the median of a boat), more than a tenth of the centers outside the pool, and
        for names that are unknown or there twice.
    """
    times = _floats("time_s", time_s)
    if not np.isfinite(times).all() or not (np.diff(times) > 0).all():
        raise ParameterError("time_s must increase, in finite numbers")
    poses = _states("pose", pose, times)
    names = _names(ids, poses.shape[1])
    order = _leaders_first(names, leaders)
    names, poses = names[order], poses[:, order]
    if not np.isfinite(poses).any():
        raise ParameterError("pose is not accepted: it is NaN everywhere, no boat is ever there")
    poses[..., 2] = unwrapped(poses[..., 2])
    if velocity is None:
        motion = velocities(times, poses)
    else:
        motion = _states("velocity", velocity, times, poses.shape)[:, order]
    radius, shape = hull
    parameters = FlockParameters(
        n_boats=len(names),
        n_leaders=len(leaders),
        pool=pool,
        boat_radius_cm=radius,
        boat_shape=shape,
        target=target if isinstance(target, str) else tuple(target),
        discs=discs,
        walls=walls,
    )
    _check_units(poses, motion, parameters)
    phases, analyzed = _phases(phase, times)
    return Recording(
        time_s=times,
        phase=phases,
        in_analysis_window=analyzed,
        pose=poses,
        velocity=motion,
        order=_order(poses[:, len(leaders) :], motion[:, len(leaders) :]),
        parameters=parameters,
        seed=0,
        version=_core.__version__,
        ids=names,
    )


def velocities(
    time_s: NDArray[np.float64],
    pose: NDArray[np.float64],
    broken: NDArray[np.bool_] | None = None,
) -> NDArray[np.float64]:
    """Return differences of poses, of shape (t, n, 3), in cm/s, cm/s and rad/s.

    Central ones where a boat is there before and after, one-sided ones at the ends of its tracks,
    NaN where it is there for one sample only. No difference is taken across steps that are
    `broken`, of shape (t - 1, n).
    """
    there = ~np.isnan(pose[..., 0])
    steps = np.diff(pose, axis=0) / np.diff(time_s)[:, None, None]
    if broken is not None:
        steps[broken] = np.nan
    none = np.full((1, *pose.shape[1:]), np.nan)
    before, after = np.concatenate([none, steps]), np.concatenate([steps, none])
    mean = (before + after) / 2
    found = np.where(np.isnan(mean), np.where(np.isnan(before), after, before), mean)
    return np.where(there[..., None], found, np.nan)


def _floats(name: str, values: ArrayLike) -> NDArray[np.float64]:
    try:
        return np.array(values, np.float64)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"{name} is not accepted: numbers") from error


def _states(
    name: str,
    values: ArrayLike,
    times: NDArray[np.float64],
    shape: tuple[int, ...] | None = None,
) -> NDArray[np.float64]:
    states = _floats(name, values)
    expected = shape or (len(times) if times.ndim == 1 else 0, *states.shape[1:2], 3)
    if states.ndim != 3 or states.shape != expected or 0 in states.shape:
        wanted = "(t, n, 3) for t times" if shape is None else f"{shape}, that of pose"
        raise ParameterError(
            f"{name} has shape {states.shape} for time_s of shape {times.shape}, expected {wanted}"
        )
    if np.isinf(states).any():
        raise ParameterError(f"{name} is not accepted: finite numbers, or rows of NaN")
    absent = np.isnan(states)
    partly = absent.any(axis=-1) & ~absent.all(axis=-1)
    if partly.any():
        sample, boat = np.argwhere(partly)[0]
        raise ParameterError(
            f"{name}[{sample}, {boat}] = {states[sample, boat].tolist()} is not accepted: "
            "all three numbers, or NaN for all three where a boat is not there"
        )
    return states


def _names(ids: Sequence[str] | None, boats: int) -> NDArray[np.str_]:
    names = [str(each) for each in (range(boats) if ids is None else ids)]
    if len(names) != boats:
        raise ParameterError(f"ids holds {len(names)} names for {boats} boats")
    twice = [name for name in dict.fromkeys(names) if names.count(name) > 1]
    if twice:
        raise ParameterError(f"ids holds {shown(twice[0])} more than once")
    return np.array(names, np.str_)


def _leaders_first(names: NDArray[np.str_], leaders: Sequence[str]) -> list[int]:
    known = names.tolist()
    leading = [str(each) for each in leaders]
    for name in leading:
        if name not in known:
            raise ParameterError(f"leaders holds {shown(name)}, which is none of the ids")
    if len(set(leading)) < len(leading):
        raise ParameterError("leaders holds a name more than once")
    first = [known.index(name) for name in leading]
    return first + [place for place in range(len(known)) if place not in set(first)]


def unwrapped(heading: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return headings without jumps of full turns, each boat's from sample to sample it is in."""
    whole = heading.copy()
    for boat in whole.T:
        there = ~np.isnan(boat)
        boat[there] = np.unwrap(boat[there])
    return whole


def _check_units(
    pose: NDArray[np.float64], velocity: NDArray[np.float64], parameters: FlockParameters
) -> None:
    speed = np.hypot(velocity[..., 0], velocity[..., 1])
    known = np.isfinite(speed)
    medians = [
        np.median(column[at]) for column, at in zip(speed.T, known.T, strict=True) if at.any()
    ]
    if medians and max(medians) > _FASTEST_CM_S:
        raise ParameterError(
            f"a boat moves at {max(medians) / 100:.3g} m/s in the median, above "
            f"{_FASTEST_CM_S / 100:g} m/s: are positions in cm and times in s?"
        )
    outer_cm, _ = _core.pool_radii_cm(parameters.pool)
    distance = np.hypot(pose[..., 0], pose[..., 1])
    outside = float(np.mean(distance[np.isfinite(distance)] > outer_cm))
    if outside > _MOST_OUTSIDE:
        raise ParameterError(
            f"{outside:.0%} of the centers lie outside the pool of radius {outer_cm:g} cm: are "
            "positions in cm, from the center of the pool?"
        )


def _phases(
    phase: ArrayLike | None, times: NDArray[np.float64]
) -> tuple[NDArray[np.str_], NDArray[np.bool_]]:
    if phase is None:
        return np.full(times.shape, "", PHASES.dtype), np.ones(times.shape, bool)
    phases = np.asarray(phase, np.str_)
    if phases.shape != times.shape or not np.isin(phases, PHASES).all():
        raise ParameterError(f"phase is not accepted: {', '.join(PHASES)} for each time")
    analyzed = _core.sampled_analysis_window(times, phases.tolist())
    return phases.astype(PHASES.dtype), analyzed


def _order(pose: NDArray[np.float64], velocity: NDArray[np.float64]) -> OrderSeries:
    """Return the quantities of normal boats; NaN where too few of them are there."""
    if pose.shape[1] == 0:
        undefined = np.full(len(pose), np.nan)
        return OrderSeries(undefined)
    return order_series(pose, velocity)
