"""Action spaces: one rudder per leader, continuous or a choice of levels."""

from typing import Any

import gymnasium
import numpy as np


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
