"""A policy of its own for each leader, as one policy."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv.envs.observation import observation_entries
from flockenv.errors import ParameterError, shown
from flockenv.policies.base import action_mode, control_rate, leaders_observed

__all__ = ["EachLeader"]


class EachLeader:
    """A policy of its own for each leader, as one policy with the attributes of all of them.

    Parameters
    ----------
    policies
        A policy for each of ``"leader_0"``, ``"leader_1"`` and so on, in this order. Flocks with
        fewer leaders have the first ones.

    Raises
    ------
    ParameterError
        For other names, and for policies that observe or act in different ways.
    """

    def __init__(self, policies: Mapping[str, Any]) -> None:
        wanted = [f"leader_{place}" for place in range(max(1, len(policies)))]
        if list(policies) != wanted:
            raise ParameterError(
                f"policies for {', '.join(map(shown, policies)) or 'no leader'} are not accepted: "
                f"one for each of {', '.join(wanted)}, in this order"
            )
        self._policies = list(policies.values())
        ways = {leader: _way(each) for leader, each in policies.items()}
        for name, first in ways["leader_0"].items():
            for leader, way in ways.items():
                if way[name] != first:
                    raise ParameterError(
                        f"{name} = {shown(way[name])} of {leader} is not accepted beside "
                        f"{shown(first)} of leader_0: policies of one flock observe and act in the "
                        "same way"
                    )
            setattr(self, name, first)

    def check_leaders(self, k: int) -> None:
        """Refuse a flock with more leaders than there are policies."""
        if k > len(self._policies):
            raise ParameterError(
                f"{k} leaders are not accepted by policies for {len(self._policies)} of them"
            )

    def predict(
        self, observation: ArrayLike, state: Any = None, episode_start: Any = None
    ) -> tuple[NDArray[np.float32], Any]:
        """Return every leader's action by its own policy, and the states of all of them."""
        array = np.asarray(observation, np.float32)
        size = len(observation_entries(getattr(self, "observation", {})))
        k = leaders_observed(array, size)
        rows = array.reshape(*array.shape[:-1], k, size)
        states = [None] * k if state is None else list(state)
        actions = []
        for place, policy in enumerate(self._policies[:k]):
            own = np.ascontiguousarray(rows[..., place, :])
            action, states[place] = policy.predict(own, states[place], episode_start)
            actions.append(np.asarray(action, np.float32).reshape(*array.shape[:-1], 1))
        return np.concatenate(actions, axis=-1), states

    def __repr__(self) -> str:
        return str({f"leader_{place}": each for place, each in enumerate(self._policies)})


def _way(policy: Any) -> dict[str, Any]:
    if not hasattr(policy, "predict"):
        raise ParameterError(f"{shown(policy)} is not accepted for one leader: it has no predict")
    return {
        "observation": dict(getattr(policy, "observation", None) or {}),
        "mirror_to_target": bool(getattr(policy, "mirror_to_target", False)),
        "control_hz": control_rate(policy),
        "action_mode": action_mode(policy),
        "decision_period_s": getattr(policy, "decision_period_s", None),
    }
