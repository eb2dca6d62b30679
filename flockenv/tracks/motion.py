"""Motion of tracked boats: their velocities, gaps and continuous headings."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv.errors import ParameterError
from flockenv.tracks.layout import TrackLayout

Floats = NDArray[np.float64]

HEADING_ZERO = {"right": 0.0, "up": np.pi / 2, "left": np.pi, "down": -np.pi / 2}
"""Zero of headings, in rad counter-clockwise from x."""

TURN = {"turn": 1.0, "rad": 2 * np.pi, "deg": 360.0}
"""A full turn in each unit of headings."""

TINY = 1e-6
"""Tolerance for the rounding of a full turn, in the unit of the heading."""

_MOST_BROKEN, _AXIS_JUMP = 0.5, 0.8


@dataclass(frozen=True)
class Motion:
    """Velocities of t poses of n boats, and the times at which the poses exist."""

    #: Each boat's own times of poses in s, shape (t, n).
    stamps: Floats
    #: Whether a boat has a pose, shape (t, n).
    present: NDArray[np.bool_]
    #: [cm/s, cm/s, rad/s], shape (t, n, 3); NaN for poses without a neighbor in time.
    velocity: Floats
    #: Number of steps that were too fast for a velocity.
    broken: int
    #: Longest step in s; longer ones are gaps.
    longest_s: float

    @classmethod
    def from_poses(cls, time_s: Floats, pose: Floats, fastest_cm_s: float = np.inf) -> Self:
        """Return the motion of poses (t, n, 3), at times of shape (t,) or (t, n).

        Raises ParameterError if more than half of the steps are faster than `fastest_cm_s`.
        """
        by_boat = time_s[:, np.newaxis] if time_s.ndim == 1 else time_s
        stamps = np.ascontiguousarray(np.broadcast_to(by_boat, pose.shape[:2]))
        steps = np.diff(stamps, axis=0)
        # Steps of more than 1.5 times the 0.9 quantile of all steps are gaps.
        usual = np.quantile(steps, 0.9, method="lower") if steps.size else np.inf
        longest_s = 1.5 * float(usual)
        pose = np.ascontiguousarray(pose)
        velocities, broken = _core.track_velocities(stamps, pose, longest_s, fastest_cm_s)
        present = ~np.isnan(pose[..., 0])
        motion = cls(stamps, present, velocities.reshape(pose.shape), broken, longest_s)
        if broken > _MOST_BROKEN * motion.steps.sum():
            raise ParameterError(
                f"{broken} of {motion.steps.sum()} steps are faster than max_speed_cm_s = "
                f"{fastest_cm_s:g}: do cm_per_unit, fps and times fit this table, and is it one "
                "film?"
            )
        return motion

    @property
    def steps(self) -> NDArray[np.bool_]:
        """Whether a boat has a pose at a time and at the next one, shape (t - 1, n)."""
        is_short = np.diff(self.stamps, axis=0) <= self.longest_s
        return np.asarray(self.present[1:] & self.present[:-1] & is_short)

    def split(self, boat: int) -> tuple[list[NDArray[np.intp]], Floats]:
        """Return the frames of a boat's poses, split at its gaps, and the gaps' lengths in s."""
        frames = np.flatnonzero(self.present[:, boat])
        steps = np.diff(self.stamps[frames, boat])
        is_gap = (np.diff(frames) > 1) | (steps > self.longest_s)
        return np.split(frames, np.flatnonzero(is_gap) + 1), steps[is_gap]

    def cosine(self, heading: Floats) -> float:
        """Return the mean cosine between heading and motion, weighted by speed.

        It is NaN if no boat moves.
        """
        speed = np.nansum(np.hypot(self.velocity[..., 0], self.velocity[..., 1]))
        return float(np.nansum(self.speed_along(heading)) / speed) if speed > 0.0 else np.nan

    def speed_along(self, heading: Floats) -> Floats:
        """Return the velocities in cm/s along headings, negative for backward motion."""
        return self.velocity[..., 0] * np.cos(heading) + self.velocity[..., 1] * np.sin(heading)


def in_water(
    pool: str | tuple[float, float], distance_cm: Floats, margin_cm: float
) -> NDArray[np.bool_]:
    """Return whether distances from the center are in the water, or at most `margin_cm` outside."""
    outer_cm, inner_cm = _core.pool_radii_cm(pool)
    return (distance_cm <= outer_cm + margin_cm) & (distance_cm >= inner_cm - margin_cm)


def direction(vectors: NDArray[np.complex128]) -> Floats:
    """Return the angle of vectors x + iy in rad; NaN for vectors of length 0."""
    return np.where(vectors == 0.0, np.nan, np.angle(vectors))


def motion_with_bows(stamps: Floats, pose: Floats, layout: TrackLayout) -> Motion:
    """Return the motion of poses after changing their headings in place.

    If the layout has no headings, they become directions of motion, and poses without one are
    removed (NaN). Axes become headings of the bows, and jumps of full turns are removed.
    """
    motion = Motion.from_poses(stamps, pose, layout.max_speed_cm_s)
    if not layout.has_headings:
        pose[..., 2] = direction(motion.velocity[..., 0] + 1j * motion.velocity[..., 1])
        pose[np.isnan(pose[..., 2])] = np.nan
    elif layout.axis:
        pose[..., 2] = _bows_of(pose[..., 2], motion)
    pose[..., 2] = unwrapped(pose[..., 2])
    motion = Motion.from_poses(stamps, pose, layout.max_speed_cm_s)
    _check_by_motion(pose[..., 2], motion, layout)
    return motion


def _check_by_motion(heading: Floats, motion: Motion, layout: TrackLayout) -> None:
    """Refuse a column of headings that fits the motion better in another unit, or as axes."""
    if len(layout.columns["heading"]) != 1:
        return
    zero, unit_given = HEADING_ZERO[layout.heading_zero], layout.heading_unit
    from_zero = heading - zero
    for unit in (unit for unit in TURN if TURN[unit] < TURN[unit_given]):
        # Read in the smaller unit, headings must stay within a turn, and span over half of one.
        reread = from_zero * TURN[unit_given] / TURN[unit]
        is_within = np.nanmax(np.abs(reread)) <= 1.003 * 2.0 * np.pi
        is_wide = np.ptp(reread[motion.present]) > np.pi
        fits = motion.cosine(zero + reread) > motion.cosine(heading)
        if is_within and is_wide and fits:
            raise ParameterError(
                f"headings never exceed a full turn in {unit}, and fit the motion better than "
                f"in {unit_given}: is heading_unit = {unit!r}?"
            )
    jumps = (np.abs(np.diff(heading, axis=0)) > _AXIS_JUMP * np.pi) & motion.steps
    if layout.axis or jumps.sum() < 3 or not _is_within_half_turn(heading):
        return
    if motion.cosine(_bows_of(heading, motion)) > motion.cosine(heading):
        raise ParameterError(
            "headings lie within half a turn and jump from one end of it to the other: set "
            "axis = true if they are axes without a bow, as of ellipses"
        )


def _is_within_half_turn(heading: Floats) -> bool:
    """Return whether headings, modulo full turns, lie within half a turn, as those of axes do.

    Four half turns are tried, which start at 0, 90, 180 and 270 degrees.
    """
    starts = np.pi * np.array([[0.0], [0.5], [1.0], [1.5]])
    from_start = np.mod(heading[~np.isnan(heading)] - starts, 2 * np.pi)
    return bool((from_start <= np.pi + TINY).all(axis=1).any())


def _bows_of(axis: Floats, motion: Motion) -> Floats:
    """Return axes as headings of the bows: continuous, and mostly along the boat's motion."""
    heading = axis.copy()
    for boat in range(axis.shape[1]):
        parts, _ = motion.split(boat)
        for frames in parts:
            heading[frames, boat] = np.unwrap(axis[frames, boat], period=np.pi)
            if np.nansum(motion.speed_along(heading)[frames, boat]) < 0.0:
                heading[frames, boat] += np.pi
    return heading


def unwrapped(heading: Floats) -> Floats:
    """Return headings (t, n) without jumps of full turns between successive samples of a boat."""
    continuous = heading.copy()
    for boat in continuous.T:
        present = ~np.isnan(boat)
        boat[present] = np.unwrap(boat[present])
    return continuous
