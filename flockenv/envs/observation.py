"""What leaders observe: spaces, tables, and a flock observed without an environment."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv.flock import Flock

#: Version of the observation: of its entries, their order, scales and bounds.
OBSERVATION_VERSION: int = _core.OBSERVATION_VERSION

#: The blocks with their defaults: on or off, and how many neighbors or obstacles.
BLOCKS: dict[str, Any] = _core.env_defaults()["observation"]


class Entry(NamedTuple):
    """One number of an observation or of the global state."""

    block: str
    place: int
    name: str
    unit: str
    scale: str
    low: float
    high: float
    mirrored: bool
    meaning: str


def observation_entries(blocks: Mapping[str, Any] | None = None) -> list[Entry]:
    """Return every entry of an observation, in order; blocks differ from `BLOCKS`."""
    return [Entry(**row) for row in _core.observation_table(dict(blocks or {}))]


def flock_feature_entries() -> list[Entry]:
    """Return every feature of a whole flock, in order."""
    return [Entry(**row) for row in _core.FLOCK_FEATURES]


def flock_feature_space() -> "_Box":
    """Return the space of a flock's features."""
    low, high = _bounds(flock_feature_entries()).T.copy()
    return _Box(low, high, dtype=np.float32)


def state_entries(n_boats: int) -> list[Entry]:
    """Return every entry of the global state of a flock of this size, in order."""
    return [Entry(**row) for row in _core.state_table(n_boats)]


def _bounds(entries: Iterable[Entry]) -> NDArray[np.float32]:
    return np.array([(entry.low, entry.high) for entry in entries], np.float32)


if TYPE_CHECKING:
    _Box = gymnasium.spaces.Box[np.float32]
else:
    # Not generic before gymnasium 1.4.
    _Box = gymnasium.spaces.Box


class ObservationSpace(_Box):
    """The space of one leader's observation, or of several leaders' one after another.

    Models keep the space that they were trained on, also in their files. This one says how its
    observations are made, so that a model gets such ones wherever it steers.

    Attributes
    ----------
    leaders
        Number of leaders.
    options
        Options of the environment that a policy depends on: ``observation``, ``mirror_to_target``,
        ``control_hz``, ``action_mode`` and ``decision_period_s``.
    """

    def __init__(self, options: Mapping[str, Any], leaders: int = 1) -> None:
        bounds = np.tile(_bounds(observation_entries(options["observation"])), (leaders, 1))
        super().__init__(*bounds.T.copy(), dtype=np.float32)
        self.leaders = leaders
        names = (
            "observation",
            "mirror_to_target",
            "control_hz",
            "action_mode",
            "decision_period_s",
        )
        self.options = {name: options[name] for name in names}


def state_space(n_boats: int) -> _Box:
    """Return the space of the global state."""
    boat_and_rest, rest = _bounds(state_entries(1)), _bounds(state_entries(0))
    boats = np.tile(boat_and_rest[: -len(rest)], (n_boats, 1))
    low, high = np.concatenate([boats, rest]).T.copy()
    return _Box(low, high, dtype=np.float32)


def observe(
    flock: Flock,
    observation: Mapping[str, Any] | None = None,
    *,
    mirror_to_target: bool = False,
    rudder: ArrayLike | None = None,
) -> NDArray[np.float32]:
    """Return what the leaders of a flock observe now.

    Parameters
    ----------
    flock
        The flock; its own target is the one observed.
    observation
        Blocks that differ from the default layout.
    mirror_to_target
        Whether the view is reflected where the target is counter-clockwise.
    rudder
        The rudders as they stand, shape (k,) in [-1, 1], positive counter-clockwise;
        0 if not given.

    Returns
    -------
    numpy.ndarray
        Shape (k, observation size), float32.

    Raises
    ------
    ParameterError
        For unknown blocks, and where a block needs normal boats that are not there.
    """
    return _core.observe(flock.core, dict(observation or {}), mirror_to_target, rudder)
