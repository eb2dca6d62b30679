"""Observations of leaders: their tables, and observing a flock without an environment."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv.envs.options import OPTIONS
from flockenv.flock import Flock

#: Version of the observation: of its entries, their order, scales and bounds.
OBSERVATION_VERSION: int = _core.OBSERVATION_VERSION

#: The blocks with their defaults: on or off, and how many neighbors or obstacles.
BLOCKS: dict[str, Any] = OPTIONS["observation"].default


class Entry(NamedTuple):
    """One number of an observation or of the global state."""

    block: str
    #: Index of the neighbor, obstacle or boat in its block; 0 in other blocks.
    place: int
    name: str
    #: Unit of the physical value; empty for none.
    unit: str
    #: The physical value that is observed as 1, or the scaling in words.
    scale: str
    #: Bounds of the observed value, to which it is clipped.
    low: float
    high: float
    #: Whether `mirror_to_target` changes its sign.
    mirrored: bool
    meaning: str


def observation_entries(blocks: Mapping[str, Any] | None = None) -> list[Entry]:
    """Return every entry of an observation, in order; `blocks` replace those of `BLOCKS`."""
    return [Entry(**row) for row in _core.observation_table(dict(blocks or {}))]


def flock_feature_entries() -> list[Entry]:
    """Return every feature of a whole flock, in order."""
    return [Entry(**row) for row in _core.FLOCK_FEATURES]


def state_entries(n_boats: int) -> list[Entry]:
    """Return every entry of the global state of a flock of this size, in order."""
    return [Entry(**row) for row in _core.state_table(n_boats)]


def observe(
    flock: Flock,
    observation: Mapping[str, Any] | None = None,
    *,
    mirror_to_target: bool = False,
    rudder: ArrayLike | None = None,
) -> NDArray[np.float32]:
    """Return the present observations of a flock's leaders.

    Parameters
    ----------
    flock
        The flock; its own target is the one observed.
    observation
        The blocks that differ from the default layout.
    mirror_to_target
        Whether the view is reflected if the target is counter-clockwise.
    rudder
        The leaders' present rudders, shape (k,) in [-1, 1], positive counter-clockwise. None: 0.

    Returns
    -------
    numpy.ndarray
        Shape (k, observation size), float32.

    Raises
    ------
    ParameterError
        For unknown blocks, and if a block needs normal boats and there are none.
    """
    return _core.observe(flock._in_core, dict(observation or {}), mirror_to_target, rudder)
