"""Policies that give rudders, in environments whose actions are levels."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv.policies.base import action_mode

__all__ = ["WithLevels"]


class WithLevels:
    """A policy for environments with `rudder_levels`: of another one's rudders the nearest levels.

    Parameters
    ----------
    policy
        A policy that gives rudders, such as `SteeringLaw`.
    rudder_levels
        The environments' option of that name, 2 to 1001.

    Raises
    ------
    ParameterError
        For a number of levels out of range.
    """

    def __init__(self, policy: Any, rudder_levels: int) -> None:
        self.policy = policy
        self.rudder_levels = rudder_levels
        self.action_mode = action_mode(policy)
        self.decision_period_s = getattr(policy, "decision_period_s", None)
        self._nearest(np.zeros(0))

    def predict(
        self,
        observation: ArrayLike | Mapping[Any, ArrayLike],
        state: Any = None,
        episode_start: Any = None,
        deterministic: bool = True,
    ) -> tuple[Any, Any]:
        """Return the levels, int64, that are nearest to the policy's rudders.

        Raises
        ------
        ParameterError
            For rudders beyond [-1, 1] and NaN.
        """
        rudders, state = self.policy.predict(observation, state, episode_start, deterministic)
        if isinstance(rudders, Mapping):
            return {agent: self._nearest(each)[..., 0] for agent, each in rudders.items()}, state
        return self._nearest(rudders), state

    def _nearest(self, rudders: ArrayLike) -> NDArray[np.int64]:
        array = np.asarray(rudders, np.float64)
        levels = _core.rudders_of_levels(array.ravel(), self.rudder_levels, are_rudders=True)
        return levels.astype(np.int64).reshape(array.shape)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.policy!r}, {self.rudder_levels})"
