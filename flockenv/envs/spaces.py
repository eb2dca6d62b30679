"""Action spaces: one rudder per leader, continuous or a choice of levels."""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv.errors import ParameterError

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
    oversized = _core.oversized_shape(actions, shape)
    if oversized is not None:
        raise ParameterError(f"{name}: shape {oversized} is not accepted, expected {shape}")
    try:
        array = np.asarray(actions)
    except ValueError as error:
        raise ParameterError(f"{name} must be a rectangular array: {error}") from error
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} must be real numbers, not of dtype {array.dtype}")
    if levels is not None and array.dtype.kind == "f":
        raise ParameterError(
            f"{name} must be integers, whole numbers from 0 to {levels - 1} that name levels of "
            f"the rudder, not of dtype {array.dtype}"
        )
    if array.shape != shape:
        raise ParameterError(f"{name}: shape {array.shape} is not accepted, expected {shape}")
    return array.astype(np.float64).reshape(-1)
