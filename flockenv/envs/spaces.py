"""Action spaces: one rudder per leader, continuous or a choice of levels."""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core

__all__ = ["flat_actions", "joint_action_space", "leader_action_space"]


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


def flat_actions(
    actions: ArrayLike, shape: tuple[int, ...], levels: int | None, name: str = "actions"
) -> NDArray[np.float64]:
    """Return actions of the given shape for the core: one number per leader, in order.

    `levels` is the environments' option `rudder_levels`; messages call the actions by `name`.

    Raises
    ------
    ParameterError
        For another shape, and for numbers with a fraction part in their type where levels are due:
        a rudder of 1.0 is not level 1.
    TypeError
        For anything that is not made of real numbers.
    """
    return _core.flat_actions(actions, shape, levels, name)
