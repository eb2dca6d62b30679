"""Exploration that all leaders of a flock share and hold for a time."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3.common.distributions import DiagGaussianDistribution
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.vec_env import VecEnv

from flockenv import _core
from flockenv.errors import ParameterError
from flockenv.sb3.leader_vec_env import LeaderVecEnv

__all__ = ["SharedNoiseDistribution", "SharedNoisePolicy", "shared_noise"]


def shared_noise(venv: VecEnv, hold_s: float) -> dict[str, Any]:
    """Return the ``policy_kwargs`` of a `SharedNoisePolicy` for a vector environment.

    Parameters
    ----------
    venv
        A `LeaderVecEnv`, also inside other wrappers.
    hold_s
        Time in s that a noise is held, a whole number of the environment's decisions.

    Returns
    -------
    dict
        ``flock_of_slot`` and ``hold_steps``.

    Raises
    ------
    TypeError
        If `venv` is no `LeaderVecEnv`.
    ParameterError
        For a time that is no whole number of decisions.
    """
    leaders = venv.unwrapped
    if not isinstance(leaders, LeaderVecEnv):
        raise TypeError(f"a LeaderVecEnv is needed, not {type(leaders).__name__}")
    return {
        "flock_of_slot": leaders.flock_of_slot.tolist(),
        "hold_steps": _core.held_decisions(hold_s, leaders.decisions_hz),
    }


class SharedNoiseDistribution(DiagGaussianDistribution):
    """Gaussian actions whose deviations from the mean are one number per flock, held for a time.

    Each action is distributed as with independent noise, which is what its probability says.
    Samples of another number of slots than that of the training have independent noise.
    """

    def __init__(self, action_dim: int, flock_of_slot: Sequence[int], hold_steps: int) -> None:
        super().__init__(action_dim)
        self._flock_of_slot = torch.as_tensor(list(flock_of_slot))
        self._flocks = int(self._flock_of_slot.max()) + 1
        self._hold_steps = hold_steps
        self._steps_left = 0
        self._noise = torch.zeros(self._flocks, action_dim)

    def get_state(self) -> dict[str, NDArray[Any]]:
        """Return the noise, shape (flocks, actions), and for how many more decisions it is held."""
        return {
            "noise": self._noise.cpu().numpy().copy(),
            "steps_left": np.array(self._steps_left),
        }

    def set_state(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from `get_state`.

        Raises
        ------
        ParameterError
            For a number of decisions that no noise is held for.
        """
        steps_left = int(state["steps_left"])
        if not 0 <= steps_left < self._hold_steps:
            raise ParameterError(
                f"steps_left = {steps_left} is not accepted: 0 to {self._hold_steps - 1}"
            )
        self._noise = torch.from_numpy(state["noise"].copy())
        self._steps_left = steps_left

    def sample(self) -> torch.Tensor:
        """Return actions, shape (slots, actions)."""
        mean, deviation = self.distribution.mean, self.distribution.stddev
        if len(mean) != len(self._flock_of_slot):
            return super().sample()
        if self._steps_left == 0:
            self._noise = torch.randn(self._flocks, self.action_dim, device=mean.device)
            self._steps_left = self._hold_steps
        self._steps_left -= 1
        noise = self._noise.to(mean.device)
        return mean + deviation * noise[self._flock_of_slot.to(mean.device)]


class SharedNoisePolicy(ActorCriticPolicy):
    """An actor-critic policy that explores with one noise for all leaders of a flock, held.

    ``PPO(SharedNoisePolicy, venv, policy_kwargs=shared_noise(venv, hold_s=24.0))``

    The order of a flock answers a common deviation of its leaders that lasts, and hardly those that
    cancel each other. The noise is drawn from torch's generator, so that the seed of the algorithm
    fixes it.

    Parameters
    ----------
    observation_space, action_space, lr_schedule, options
        As of stable-baselines3's ``ActorCriticPolicy``.
    flock_of_slot
        Flock of each slot, as `LeaderVecEnv.flock_of_slot`.
    hold_steps
        Decisions that a noise is held for, at least 1.

    Raises
    ------
    ParameterError
        For discrete actions, for gSDE, and for a hold of less than one decision.
    """

    def __init__(
        self,
        observation_space: Any,
        action_space: Any,
        lr_schedule: Any,
        *,
        flock_of_slot: Sequence[int],
        hold_steps: int,
        **options: Any,
    ) -> None:
        if hold_steps < 1 or not flock_of_slot:
            raise ParameterError(
                f"hold_steps = {hold_steps!r} and {len(flock_of_slot)} slots are not accepted: at "
                "least 1 each"
            )
        super().__init__(observation_space, action_space, lr_schedule, **options)
        if type(self.action_dist) is not DiagGaussianDistribution:
            raise ParameterError(
                f"{type(self.action_dist).__name__} is not accepted with a shared noise: "
                "continuous actions without gSDE"
            )
        self._shared = {"flock_of_slot": list(flock_of_slot), "hold_steps": hold_steps}
        self.action_dist = SharedNoiseDistribution(
            self.action_dist.action_dim, flock_of_slot, hold_steps
        )

    def _get_constructor_parameters(self) -> dict[str, Any]:
        return {**super()._get_constructor_parameters(), **self._shared}
