"""Where jams are around the pool, and how they form, grow and dissolve: a map over time."""

from collections.abc import Sequence

import numpy as np

from flockenv import _core
from flockenv.recording import Recording
from flockenv.reproduce.transition.design import Growth, TransitionDesign

__all__ = ["JamMap", "mapped"]

_BINS = 180
_MAPPED_BOATS = 800


class JamMap:
    """Boats that face outward, around the pool and in time.

    Attributes
    ----------
    share : float64 array, shape (t, bins)
        Part of the flock that faces outward within 60°, in each bin of the polar angle, in
        units of what each bin would hold of a flock spread evenly.
    minutes : float
        Length of the run.
    n_boats : int
        Boats of the flock.
    """

    def __init__(self, runs: Sequence[Recording]) -> None:
        (run,) = runs
        pose = np.asarray(run.pose, np.float64)
        facing = abs(_core.lap_orientation(pose)) <= _core.JAM_ANGLE
        place = (np.arctan2(pose[..., 1], pose[..., 0]) / (2.0 * np.pi) % 1.0 * _BINS).astype(int)
        frame, boat = np.nonzero(facing)
        counts = np.zeros((len(pose), _BINS))
        np.add.at(counts, (frame, np.minimum(place[frame, boat], _BINS - 1)), 1.0)
        self.n_boats = pose.shape[1]
        self.share = counts * _BINS / self.n_boats
        self.minutes = run.duration_s / 60.0


def mapped(design: TransitionDesign, way: str) -> tuple[Growth, int]:
    """Return the size and density of the runs that are mapped: large flocks, the middle density."""
    every = design.growths(way)
    growth = next((each for each in reversed(every) if each.n_boats <= _MAPPED_BOATS), every[0])
    return growth, design.middle(way)
