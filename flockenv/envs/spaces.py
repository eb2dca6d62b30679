"""What Gymnasium knows of an environment: its spaces."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from flockenv.envs.observation import (
    BLOCKS,
    Entry,
    flock_feature_entries,
    observation_entries,
    state_entries,
)
from flockenv.envs.options import OPTIONS
from flockenv.errors import refuse_unknown

if TYPE_CHECKING:
    _Box = gymnasium.spaces.Box[np.float32]
else:
    # Not generic before gymnasium 1.4.
    _Box = gymnasium.spaces.Box


_OPTIONS = ("observation", "mirror_to_target", "control_hz", "action_mode", "decision_period_s")


def _bounds(entries: Iterable[Entry]) -> NDArray[np.float32]:
    return np.array([(entry.low, entry.high) for entry in entries], np.float32)


class ObservationSpace(_Box):
    """The space of one leader's observation, or of several leaders' one after another.

    Models keep the space that they were trained on, also in their files. It says how observations
    are made, so that a model gets the same ones wherever it steers.

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
        self.options = {name: options[name] for name in _OPTIONS}

    def policy_options(self) -> dict[str, Any]:
        """Return `options`, also of a space that another build stored in the file of a model.

        An option or a block that is younger than the file has its default. ParameterError for
        unknown ones.
        """
        refuse_unknown(self.options, _OPTIONS, "option that a policy depends on")
        options = {name: OPTIONS[name].default for name in _OPTIONS} | self.options
        refuse_unknown(options["observation"], BLOCKS, "block of the observation")
        return {**options, "observation": {**BLOCKS, **options["observation"]}}


def flock_feature_space() -> _Box:
    """Return the space of a flock's features."""
    low, high = _bounds(flock_feature_entries()).T.copy()
    return _Box(low, high, dtype=np.float32)


def state_space(n_boats: int) -> _Box:
    """Return the space of the global state."""
    boat_and_rest, rest = _bounds(state_entries(1)), _bounds(state_entries(0))
    boats = np.tile(boat_and_rest[: -len(rest)], (n_boats, 1))
    low, high = np.concatenate([boats, rest]).T.copy()
    return _Box(low, high, dtype=np.float32)


def leader_action_space(levels: int | None) -> gymnasium.Space[Any]:
    """Return one leader's space: a rudder in [-1, 1], or the number of a level."""
    if levels is None:
        return gymnasium.spaces.Box(-1.0, 1.0, (1,), np.float32)
    return gymnasium.spaces.Discrete(levels)


def joint_action_space(levels: int | None, leaders: int) -> gymnasium.Space[Any]:
    """Return the space of all leaders' rudders."""
    if levels is None:
        return gymnasium.spaces.Box(-1.0, 1.0, (leaders,), np.float32)
    return gymnasium.spaces.MultiDiscrete([levels] * leaders)
