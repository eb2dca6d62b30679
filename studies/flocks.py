"""Flocks of several studies: those that start in order, and those whose leaders lean.

Some start with all boats circulating, or with all in one jam. At a transition of first order both
states last at one density, and where a run ends depends on where it started; a random start shows
one of the two, or neither.
"""

import math
from typing import Any

import numpy as np

import flockenv
from flockenv.errors import ParameterError

RADII_CM = {"wide": (180.0, 97.0), "narrow": (90.0, 48.5)}
"""Outer and inner radius of the named pools."""

_STRETCH = 0.75
"""Largest part of the wall that the boats of one jam cover before they stand in several rows."""

_ROOM = 1.001  # Distance of boats in a jam, over that at which their hulls touch.


def lean(pool: str, episode_s: float) -> dict[str, Any]:
    """Return the task of examples/train_leaders.py: three leaders lean about the tangent.

    No lean is the tuned law. The reward is the order alone.
    """
    others = dict.fromkeys(("own", "phase", "target", "order"), False)
    return {
        "pool": pool,
        "n_boats": 27,
        "n_leaders": 3,
        "bw_s": flockenv.FlockParameters.critical_bw_s("simulation", pool),
        "observation": {**others, "neighbors": 0, "lean_features": True},
        "action_mode": "lean",
        "decision_period_s": 1.0,
        "episode_s": episode_s,
        "physics": "training",
    }


def rotating(parameters: flockenv.FlockParameters, seed: int) -> flockenv.Flock:
    """Return a flock of boats at their places of a random start, clockwise at their full speed.

    Turning boats where they are may let some overlap; the contact solver takes that out again.
    """
    flock = flockenv.Flock(parameters, seed)
    pose, velocity = flock.pose, np.zeros((parameters.n_boats, 3))
    pose[:, 2] = np.arctan2(pose[:, 1], pose[:, 0]) - np.pi / 2
    velocity[:, 0] = parameters.speed_cm_s * np.cos(pose[:, 2])
    velocity[:, 1] = parameters.speed_cm_s * np.sin(pose[:, 2])
    flock.set_state(pose, velocity, allow_overlap=True)
    return flock


def one_jam(parameters: flockenv.FlockParameters, seed: int) -> flockenv.Flock:
    """Return a flock at rest side by side along the outer wall, all facing it.

    The seed decides where on the wall they stand, in several rows where they are too many for one.
    """
    flock = flockenv.Flock(parameters, seed)
    first = math.atan2(flock.pose[0, 1], flock.pose[0, 0])
    pool = parameters.pool
    outer_cm, inner_cm = RADII_CM[pool] if isinstance(pool, str) else pool
    radius_cm = parameters.boat_radius_cm
    core_cm = radius_cm * parameters.boat_shape
    pose, wall_cm = np.empty((0, 3)), outer_cm
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
    flock.set_state(pose, np.zeros_like(pose), allow_overlap=True)
    return flock
