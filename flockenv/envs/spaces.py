"""What Gymnasium knows of an environment: action spaces, and the length of its episodes."""

import copy
from typing import Any

import gymnasium
import numpy as np
from gymnasium.envs.registration import EnvSpec


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


def spec_of_episodes(spec: EnvSpec | None, decisions: int) -> EnvSpec | None:
    """Return a registered environment's spec with the decisions of its episodes."""
    if spec is None or spec.max_episode_steps is not None:
        return spec
    # The registered one holds for all options.
    own = copy.deepcopy(spec)
    own.max_episode_steps = decisions
    return own
