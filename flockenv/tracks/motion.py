"""Motion of tracked boats: velocities, gaps, and whether motion fits the headings."""

from dataclasses import dataclass
from typing import Any, Self

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

_AXIS_JUMP = 0.8
_MOST_BROKEN = 0.5


@dataclass(frozen=True)
class Motion:
    """Velocities of boats, and the times and presence of the poses that they come from."""

    #: Times of poses in s, shape (t, n).
    stamps: Floats
    #: Whether a boat has a pose, shape (t, n).
    present: NDArray[np.bool_]
    #: [cm/s, cm/s, rad/s], shape (t, n, 3), NaN where there is no neighbor in time.
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
        return cls(stamps, present, rows.reshape(pose.shape), broken, longest_s)

    def gaps(self) -> Floats:
        """Return the length of each gap in s: between two poses of a boat that are no neighbors."""
        found = [np.zeros(0)]
        for stamps, present in zip(self.stamps.T, self.present.T, strict=True):
            frames = np.flatnonzero(present)
            steps = np.diff(stamps[frames])
            found.append(steps[(np.diff(frames) > 1) | (steps > self.longest_s)])
        return np.concatenate(found)

    def empty_frames(self, time_s: Floats) -> int:
        """Return the number of empty frames, of those that a regular clock has."""
        steps = np.diff(time_s)
        long = steps[steps > self.longest_s]
        return int((np.rint(long / np.median(steps)) - 1).sum()) if len(long) else 0

    def cosine(self, heading: Floats) -> float:
        """Return the mean cosine between heading and motion, weighted by speed; NaN for none."""
        speed = np.nansum(np.hypot(self.velocity[..., 0], self.velocity[..., 1]))
        return float(np.nansum(self.ahead(heading)) / speed) if speed > 0.0 else np.nan

    def ahead(self, heading: Floats) -> Floats:
        """Return the speeds of boats along their headings."""
        return self.velocity[..., 0] * np.cos(heading) + self.velocity[..., 1] * np.sin(heading)

    def check(self, heading: Floats, layout: TrackLayout) -> None:
        """Refuse tracks in which most steps are too fast, and axes given as directions."""
        steps = (
            self.present[1:] & self.present[:-1] & (np.diff(self.stamps, axis=0) <= self.longest_s)
        )
        if self.broken > _MOST_BROKEN * steps.sum():
            raise ParameterError(
                f"{self.broken} of {steps.sum()} steps are faster than max_speed_cm_s = "
                f"{layout.max_speed_cm_s:g}: do cm_per_unit, fps and times fit this table, and "
                "is it one film?"
            )
        if len(layout.columns["heading"]) != 1:
            return
        self._check_unit(heading, layout)
        jumps = (np.abs(np.diff(heading, axis=0)) > _AXIS_JUMP * np.pi) & steps
        if layout.axis or jumps.sum() < 3 or not _is_half(heading):
            return
        if self.cosine(bows_of(heading, self)) > self.cosine(heading):
            raise ParameterError(
                "headings lie within half a turn and jump from one end of it to the other: set "
                "axis = true if they are axes without a bow, as of ellipses"
            )

    def _check_unit(self, heading: Floats, layout: TrackLayout) -> None:
        """Refuse headings that never reach a turn of a smaller one of the units, if they fit it."""
        turned = heading - HEADING_ZERO[layout.heading_zero]
        for unit, turn in TURN.items():
            # A full turn of the smaller unit, and headings over more than half of one.
            share = turn / TURN[layout.heading_unit]
            least = TURN["rad"] * share
            if share >= 1.0 or np.nanmax(np.abs(turned)) > 1.003 * least:
                continue
            other = heading + turned * (1.0 / share - 1.0)
            is_wide = np.ptp(turned[self.present]) > 0.5 * least
            if is_wide and self.cosine(other) > self.cosine(heading):
                raise ParameterError(
                    f"headings never exceed a full turn in {unit}, and fit the motion better than "
                    f"in {layout.heading_unit}: is heading_unit = {unit!r}?"
                )


def _is_half(heading: Floats) -> bool:
    """Whether headings, up to whole turns, lie within half a turn as axes are given."""
    wrapped = np.mod(heading[~np.isnan(heading)], np.pi * 2)
    return any(
        (np.mod(wrapped - start, 2 * np.pi) <= np.pi + 1e-6).all()
        for start in np.pi * np.array([0.0, 0.5, 1.0, 1.5])
    )


def bows_of(axis: Floats, motion: Motion) -> Floats:
    """Return axes as headings: continuous, and mostly along the boat's motion."""
    heading = axis.copy()
    for boat in range(axis.shape[1]):
        frames = np.flatnonzero(motion.present[:, boat])
        steps = np.diff(motion.stamps[frames, boat])
        cuts = np.flatnonzero((np.diff(frames) > 1) | (steps > motion.longest_s)) + 1
        for part in np.split(frames, cuts):
            heading[part, boat] = np.unwrap(axis[part, boat], period=np.pi)
            if np.nansum(motion.ahead(heading)[part, boat]) < 0.0:
                heading[part, boat] += np.pi
    return heading


def unwrapped(heading: Floats) -> Floats:
    """Return headings without jumps of full turns, each boat's from sample to sample it is in."""
    continuous = heading.copy()
    for boat in continuous.T:
        present = ~np.isnan(boat)
        boat[present] = np.unwrap(boat[present])
    return continuous


def in_water(pool: Any, indices: Floats, margin_cm: float) -> NDArray[np.bool_]:
    """Return whether places are in the water of a pool, or at most so far beyond its walls."""
    outer_cm, inner_cm = _core.pool_radii_cm(pool)
    distance = np.hypot(indices[..., 0], indices[..., 1])
    return np.asarray((distance <= outer_cm + margin_cm) & (distance >= inner_cm - margin_cm))
