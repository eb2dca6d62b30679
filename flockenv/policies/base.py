"""What a policy is, and what those share that steer each leader by its own observation."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv._io.arguments import number, real_numbers
from flockenv.envs.observation import observation_entries
from flockenv.envs.options import OPTIONS
from flockenv.errors import ParameterError, shown


class LeaderPolicy(Protocol):
    """Anything with the ``predict`` of a stable-baselines3 policy."""

    def predict(self, observation: Any, state: Any = None, episode_start: Any = None) -> Any:
        """Return actions for observations.

        Parameters
        ----------
        observation
            Shape (..., m * observation size): m leaders' observations one after another in the
            last axis, as the environments give them. The policies of this package also take a
            dictionary of such arrays by agent, and then return one.
        state, episode_start
            The state that the last call returned, and shape (flocks,): whether an episode has just
            started. Both are for recurrent policies.

        Returns
        -------
        action : numpy.ndarray or dict
            Shape (..., m), in [-1, 1], and float32 from the policies of this package.
        state
            The next state of a recurrent policy; others return the one that was given.

        Raises
        ------
        ParameterError
            From the policies of this package, if the last axis is no multiple of the observation's
            size.
        """


CONTROL_HZ: float = OPTIONS["control_hz"].default
"""Control steps per second, unless the environment or the policy has others."""


def control_rate(policy: Any) -> float:
    """Return the control steps per second that a policy is made for: 10 if it does not say."""
    rate = getattr(policy, "control_hz", None)
    return CONTROL_HZ if rate is None else _positive(rate, "control_hz")


def decision_rate(policy: Any) -> float:
    """Return how often per second a policy decides: with each control step, if it has no period."""
    period: float | None = getattr(policy, "decision_period_s", None)
    return control_rate(policy) if period is None else 1.0 / _positive(period, "decision_period_s")


def _positive(value: Any, name: str) -> float:
    if not 0.0 < number(value, name) < math.inf:
        raise ParameterError(f"{name} = {shown(value)} of a policy is not accepted: above 0")
    return float(value)


def action_mode(policy: Any) -> str:
    """Return what a policy's actions stand for, as in the environments' option of that name."""
    return getattr(policy, "action_mode", None) or "rudder"


def check_action_mode(policy: Any, mode: str, where: str) -> None:
    """Refuse a policy whose actions are for another mode."""
    own = action_mode(policy)
    if own != mode:
        raise ParameterError(
            f"{shown(policy)} gives actions of action_mode {own!r}: not accepted {where}, which "
            f"takes action_mode {mode!r}"
        )


def check_pool(policy: Any, pool: Any) -> None:
    """Refuse a policy that was made for another pool than the flock's."""
    own = getattr(policy, "pool", None)
    if own is not None and own != pool:
        raise ParameterError(
            f"pool = {shown(pool)} is not accepted with {shown(policy)}: it was made for "
            f"pool = {own!r}"
        )


def observed(observation: ArrayLike) -> NDArray[np.float32]:
    """Return an observation as an array, of which nothing may be masked."""
    # An environment's own array needs no look at it, which would take longer than a law's step.
    if type(observation) is not np.ndarray or observation.dtype != np.float32:
        if np.ma.is_masked(observation):
            raise ParameterError("observation is masked: give plain numbers")
        observation = real_numbers(observation, "observation")
    return np.ascontiguousarray(observation, np.float32)


def leaders_observed(observation: NDArray[Any], size: int) -> int:
    """Return how many leaders' observations, each of a size, the last axis holds."""
    width = observation.shape[-1] if observation.ndim else 0
    if width == 0 or width % size != 0:
        raise ParameterError(
            f"observation has shape {observation.shape}, but its last axis must be a multiple of "
            f"{size}, the size of a leader's observation"
        )
    return width // size


class RowPolicy(ABC):
    """A policy that maps one leader's observation to its rudder, with the interface of SB3's.

    Parameters
    ----------
    observation, mirror_to_target
        Layout of the observations, as in the environments' options of those names.

    Attributes
    ----------
    action_mode, decision_period_s
        The environments' options of those names that its actions are for.
    """

    action_mode: str = "rudder"
    decision_period_s: float | None = None

    def __init__(
        self, *, observation: Mapping[str, Any] | None = None, mirror_to_target: bool = False
    ) -> None:
        if not isinstance(observation, Mapping | None):
            raise ParameterError(
                f"observation = {shown(observation)} is not accepted: blocks by name"
            )
        if not isinstance(mirror_to_target, bool | np.bool_):
            raise ParameterError(
                f"mirror_to_target = {shown(mirror_to_target)} is not accepted: True or False"
            )
        self.observation = dict(observation or {})
        self.mirror_to_target = bool(mirror_to_target)
        self._size = len(observation_entries(self.observation))

    @abstractmethod
    def _steer(self, rows: NDArray[np.float32]) -> NDArray[np.floating[Any]]:
        """Return the rudders of rows (leaders, size): as many numbers in [-1, 1]."""

    def predict(
        self,
        observation: ArrayLike | Mapping[Any, ArrayLike],
        state: Any = None,
        episode_start: Any = None,
        deterministic: bool = True,
    ) -> tuple[Any, Any]:
        """Return rudders for observations, as `LeaderPolicy`; there is one way to act."""
        if isinstance(observation, Mapping):
            return {agent: self._rudders(each) for agent, each in observation.items()}, state
        return self._rudders(observation), state

    def _rudders(self, observation: ArrayLike) -> NDArray[np.float32]:
        array = observed(observation)
        leaders = leaders_observed(array, self._size)
        rudders = np.asarray(self._steer(array.reshape(-1, self._size)), np.float32)
        return rudders.reshape(*array.shape[:-1], leaders)

    def __repr__(self) -> str:
        return f"{type(self).__name__}()"
