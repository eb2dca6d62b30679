"""Flocks that start in order: all boats circulating, all pressing outward, or all in one jam.

At a transition of first order both states last at one density, and where a run ends depends on
where it started; a random start shows one of the two, or neither.
"""

import math

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv.errors import ParameterError
from flockenv.flock import Flock
from flockenv.parameters import FlockParameters

__all__ = ["STARTS", "initial_flock"]

STARTS = ("rotating", "jammed", "one-jam")
"""All boats clockwise along the tangent at their full speed; all facing the outer wall at rest,
where a random start puts them; all facing it at rest side by side, in one stretch of the wall."""

_STRETCH = 0.75
"""Largest part of the wall that the boats of one jam cover before they stand in several rows."""

_ROOM = 1.001
"""Distance of boats in a jam, over that at which their hulls touch."""


def initial_flock(parameters: FlockParameters, seed: int, start: str) -> Flock:
    """Return a flock in an initial state of that name.

    Boats of one jam stand side by side, the seed deciding where on the wall; the others keep the
    places of a random start. Turning boats where they are may let some overlap; the contact solver
    takes that out again.

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
        For an unknown start, and boats that do not fit the pool or, in one jam, its outer wall.
    """
    if start not in STARTS:
        raise ParameterError(f"start = {start!r} is not accepted: {', '.join(STARTS)}")
    flock = Flock(parameters, seed)
    pose, velocity = flock.pose, np.zeros((parameters.n_boats, 3))
    outward = np.arctan2(pose[:, 1], pose[:, 0])
    pose[:, 2] = outward
    if start == "one-jam":
        pose = _one_jam(parameters, outward[0])
    elif start == "rotating":
        heading = outward - np.pi / 2
        pose[:, 2] = heading
        velocity[:, 0] = parameters.speed_cm_s * np.cos(heading)
        velocity[:, 1] = parameters.speed_cm_s * np.sin(heading)
    flock.set_state(pose, velocity, allow_overlap=True)
    return flock


def _one_jam(parameters: FlockParameters, first: float) -> NDArray[np.float64]:
    """Return poses in rows along the outer wall, each from the polar angle `first` on."""
    outer_cm, inner_cm = _core.pool_radii_cm(parameters.pool)
    radius_cm = parameters.boat_radius_cm
    core_cm = radius_cm * parameters.boat_shape
    pose = np.empty((0, 3))
    wall_cm = outer_cm
    while len(pose) < parameters.n_boats:
        center_cm = wall_cm - _ROOM * (core_cm + radius_cm)
        if center_cm - core_cm - radius_cm <= inner_cm:
            raise ParameterError(
                f"{parameters.n_boats} boats are too many for one jam on {_STRETCH:.0%} of the wall"
            )
        # Boats that face outward are nearest to each other at their sterns.
        apart = 2.0 * math.asin(_ROOM * radius_cm / (center_cm - core_cm))
        room = math.floor(_STRETCH * 2.0 * math.pi / apart)
        angle = first + apart * np.arange(min(room, parameters.n_boats - len(pose)))
        row = np.stack([center_cm * np.cos(angle), center_cm * np.sin(angle), angle], axis=1)
        pose = np.concatenate([pose, row])
        wall_cm = center_cm - core_cm - radius_cm
    return pose
