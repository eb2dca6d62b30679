"""The spaces of the environments."""

import math
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


#: Options of the environment that a policy depends on.
POLICY_OPTIONS = (
    "observation",
    "mirror_to_target",
    "control_hz",
    "action_mode",
    "decision_period_s",
)


def _bounds(entries: Iterable[Entry]) -> NDArray[np.float32]:
    return np.array([(entry.low, entry.high) for entry in entries], np.float32)


class ObservationSpace(_Box):
    """The space of one leader's observation, or of several leaders' one after another.

    Models keep the space that they were trained on, also in their files. It says how observations
    are made, so that a model gets the same ones wherever it steers. Spaces with other options are
    not equal, so that libraries refuse a model for flocks whose observations have the same shape
    and another meaning. A plain `Box` has no options, and is equal if its bounds are.

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
        self.options = {name: options[name] for name in POLICY_OPTIONS}

    def __eq__(self, other: object) -> bool:
        """Whether another space has the same bounds and, if it has any, the same options."""
        if not isinstance(other, ObservationSpace):
            return super().__eq__(other)
        if self.leaders != other.leaders or not super().__eq__(other):
            return False
        return not differing_options(self.options, other.options)

    # Not hashable, like other spaces, since spaces can be changed.
    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        """Return shape, leaders and options, with only the changed blocks of the observation."""
        options = {name: value for name, value in self.options.items() if name != "observation"}
        blocks = self.options["observation"]
        options["observation"] = {block: n for block, n in blocks.items() if BLOCKS.get(block) != n}
        arguments = ", ".join(f"{name}={value!r}" for name, value in options.items())
        return f"ObservationSpace({self.shape}, leaders={self.leaders}, {arguments})"

    def policy_options(self) -> dict[str, Any]:
        """Return `options`, checked, since another version may have stored this space in a file.

        An option or a block that is missing from the file has its default. Raises ParameterError
        for unknown options and blocks.
        """
        refuse_unknown(self.options, POLICY_OPTIONS, "option that a policy depends on")
        refuse_unknown(self.options.get("observation", {}), BLOCKS, "block of the observation")
        return _completed(self.options)


def differing_options(
    options: Mapping[str, Any], others: Mapping[str, Any]
) -> dict[str, tuple[Any, Any]]:
    """Return the options in which two policies, or a policy and flocks, differ.

    Each name has a pair of values. Options that are missing count with their defaults.
    """
    first, second = _completed(options), _completed(others)
    names = dict.fromkeys((*first, *second))
    pairs = {name: (first.get(name), second.get(name)) for name in names}
    return {name: pair for name, pair in pairs.items() if pair[0] != pair[1]}


def _completed(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return options, with defaults for those that are missing."""
    full = {name: OPTIONS[name].default for name in POLICY_OPTIONS} | dict(options)
    full["observation"] = {**BLOCKS, **full["observation"]}
    period = full["decision_period_s"]
    # A period of one control step is the same as no period.
    if period is not None and math.isclose(period * full["control_hz"], 1.0):
        full["decision_period_s"] = None
    return full


def flock_feature_space() -> _Box:
    """Return the space of a flock's features."""
    low, high = _bounds(flock_feature_entries()).T.copy()
    return _Box(low, high, dtype=np.float32)


def state_space(n_boats: int) -> _Box:
    """Return the space of the global state."""
    # The entries of the boats come first, and then those of the whole flock.
    one_boat_and_flock, flock = _bounds(state_entries(1)), _bounds(state_entries(0))
    one_boat = one_boat_and_flock[: -len(flock)]
    low, high = np.concatenate([np.tile(one_boat, (n_boats, 1)), flock]).T.copy()
    return _Box(low, high, dtype=np.float32)


def leader_action_space(levels: int | None) -> gymnasium.Space[Any]:
    """Return the space of one leader's action: a rudder in [-1, 1], or the number of a level."""
    if levels is None:
        return gymnasium.spaces.Box(-1.0, 1.0, (1,), np.float32)
    return gymnasium.spaces.Discrete(levels)


def joint_action_space(levels: int | None, leaders: int) -> gymnasium.Space[Any]:
    """Return the space of all leaders' actions: rudders in [-1, 1], or numbers of levels."""
    if levels is None:
        return gymnasium.spaces.Box(-1.0, 1.0, (leaders,), np.float32)
    return gymnasium.spaces.MultiDiscrete([levels] * leaders)
