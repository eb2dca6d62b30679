"""Flocks that start in order: all boats circulating, or all pressing outward.

At a transition of first order both states last at one density, and where a run ends depends on
where it started; a random start shows one of the two, or neither.
"""

import numpy as np

from flockenv import _core
from flockenv.errors import ParameterError
from flockenv.parameters import FlockParameters

__all__ = ["STARTS", "initial_flock"]

STARTS = ("rotating", "jammed")
"""All boats clockwise along the tangent at their full speed; all facing the outer wall at rest."""


def initial_flock(parameters: FlockParameters, seed: int, start: str) -> _core.Flock:
    """Return a flock in an initial state of that name, its boats at the places of a random start.

    Turning boats where they are may let some overlap; the contact solver takes that out again.

    Parameters
    ----------
    parameters
        Of the flock.
    seed
        Seed of all random streams.
    start
        One of `STARTS`.

    Raises
    ------
    ParameterError
        For an unknown start, and boats that do not fit the pool.
    """
    if start not in STARTS:
        raise ParameterError(f"start = {start!r} is not accepted: {', '.join(STARTS)}")
    flock = _core.Flock(parameters, seed)
    pose, velocity = flock.pose, np.zeros((parameters.n_boats, 3))
    outward = np.arctan2(pose[:, 1], pose[:, 0])
    pose[:, 2] = outward
    if start == "rotating":
        heading = outward - np.pi / 2
        pose[:, 2] = heading
        velocity[:, 0] = parameters.speed_cm_s * np.cos(heading)
        velocity[:, 1] = parameters.speed_cm_s * np.sin(heading)
    flock.set_state(pose, velocity, allow_overlap=True)
    return flock
