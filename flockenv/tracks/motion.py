"""Motion of tracked boats: velocities, gaps and speeds."""

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
"""A full turn in the units of headings."""

TINY = 1e-6
"""How much rounding may add to a full turn."""

_MOST_BROKEN, _AXIS_JUMP = 0.5, 0.8


@dataclass(frozen=True)
class Motion:
    """Velocities of boats, and the times and presence of the poses that they come from."""

    #: Times of poses in s, shape (t, n).
    stamps: Floats
    #: Whether a boat has a pose, shape (t, n).
    present: NDArray[np.bool_]
    #: [cm/s, cm/s, rad/s], shape (t, n, 3); NaN for poses without a neighbor in time.
    velocity: Floats
    #: Steps that were too fast.
    broken: int
    #: Steps that last longer are gaps.
    longest_s: float

    @classmethod
    def from_poses(cls, time_s: Floats, pose: Floats, fastest_cm_s: float = np.inf) -> Self:
        """Return the motion of poses (t, n, 3), at times of shape (t,) or (t, n)."""
        stamps = np.ascontiguousarray(np.broadcast_to(np.atleast_2d(time_s.T).T, pose.shape[:2]))
        steps = np.diff(stamps, axis=0)
        # Steps much longer than nine tenths of all steps are gaps.
        usual = np.quantile(steps, 0.9, method="lower") if steps.size else np.inf
        longest_s = 1.5 * float(usual)
        pose = np.ascontiguousarray(pose)
        rows, broken = _core.track_velocities(stamps, pose, longest_s, fastest_cm_s)
        present = ~np.isnan(pose[..., 0])
        motion = cls(stamps, present, rows.reshape(pose.shape), broken, longest_s)
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
        """Return the frames of a boat's poses, split at its gaps, and the lengths of the gaps."""
        frames = np.flatnonzero(self.present[:, boat])
        steps = np.diff(self.stamps[frames, boat])
        is_gap = (np.diff(frames) > 1) | (steps > self.longest_s)
        return np.split(frames, np.flatnonzero(is_gap) + 1), steps[is_gap]

    def cosine(self, heading: Floats) -> float:
        """Return the mean cosine between heading and motion, weighted by speed, or NaN."""
        speed = np.nansum(np.hypot(self.velocity[..., 0], self.velocity[..., 1]))
        return float(np.nansum(self.ahead(heading)) / speed) if speed > 0.0 else np.nan

    def ahead(self, heading: Floats) -> Floats:
        """Return the speeds of boats along their headings."""
        return self.velocity[..., 0] * np.cos(heading) + self.velocity[..., 1] * np.sin(heading)


def in_water(
    pool: str | tuple[float, float], distance_cm: Floats, margin_cm: float
) -> NDArray[np.bool_]:
    """Return whether distances from the center are in the water, or `margin_cm` outside of it."""
    outer_cm, inner_cm = _core.pool_radii_cm(pool)
    return (distance_cm <= outer_cm + margin_cm) & (distance_cm >= inner_cm - margin_cm)


def direction(way: NDArray[np.complex128]) -> Floats:
    """Return the angle of vectors x + iy in rad; NaN for none."""
    return np.where(way == 0.0, np.nan, np.angle(way))


def turned_into_motion(stamps: Floats, pose: Floats, layout: TrackLayout) -> Motion:
    """Return the motion of poses, after turning their headings into continuous ones of the bows."""
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
    zero, given = HEADING_ZERO[layout.heading_zero], layout.heading_unit
    turned = heading - zero
    for unit in (unit for unit in TURN if TURN[unit] < TURN[given]):
        # Headings must stay within a full turn of the smaller unit, and span more than half of one.
        share = TURN[unit] / TURN[given]
        is_within = np.nanmax(np.abs(turned)) <= 1.003 * TURN["rad"] * share
        is_wide = np.ptp(turned[motion.present]) > 0.5 * TURN["rad"] * share
        fits = motion.cosine(zero + turned / share) > motion.cosine(heading)
        if is_within and is_wide and fits:
            raise ParameterError(
                f"headings never exceed a full turn in {unit}, and fit the motion better than "
                f"in {given}: is heading_unit = {unit!r}?"
            )
    jumps = (np.abs(np.diff(heading, axis=0)) > _AXIS_JUMP * np.pi) & motion.steps
    if layout.axis or jumps.sum() < 3 or not _spans_half_turn(heading):
        return
    if motion.cosine(_bows_of(heading, motion)) > motion.cosine(heading):
        raise ParameterError(
            "headings lie within half a turn and jump from one end of it to the other: set "
            "axis = true if they are axes without a bow, as of ellipses"
        )


def _spans_half_turn(heading: Floats) -> bool:
    """Return whether headings lie within half a turn, as axes do, apart from whole turns."""
    starts = np.pi * np.array([[0.0], [0.5], [1.0], [1.5]])
    turned = np.mod(heading[~np.isnan(heading)] - starts, 2 * np.pi)
    return bool((turned <= np.pi + 1e-6).all(axis=1).any())


def _bows_of(axis: Floats, motion: Motion) -> Floats:
    """Return axes as headings: continuous, and mostly along the boat's motion."""
    heading = axis.copy()
    for boat in range(axis.shape[1]):
        for part in motion.split(boat)[0]:
            heading[part, boat] = np.unwrap(axis[part, boat], period=np.pi)
            if np.nansum(motion.ahead(heading)[part, boat]) < 0.0:
                heading[part, boat] += np.pi
    return heading


def unwrapped(heading: Floats) -> Floats:
    """Return headings without jumps of full turns between successive samples of a boat."""
    continuous = heading.copy()
    for boat in continuous.T:
        present = ~np.isnan(boat)
        boat[present] = np.unwrap(boat[present])
    return continuous
