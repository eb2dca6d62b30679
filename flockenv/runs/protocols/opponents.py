"""Runs whose clockwise leaders follow a policy, and whose other leaders the paper's law."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv.errors import ParameterError
from flockenv.parameters import FlockParameters
from flockenv.policies.base import LeaderPolicy
from flockenv.policies.laws import SteeringLaw
from flockenv.recording import Recording
from flockenv.simulation import simulate

__all__ = ["simulate_against_the_law"]


class _Opponents:
    """A policy for some of the leaders, and the paper's law, which reads the same, for the rest."""

    def __init__(self, policy: Any, is_led: Sequence[bool]) -> None:
        self.observation = dict(getattr(policy, "observation", None) or {})
        self.mirror_to_target = bool(getattr(policy, "mirror_to_target", False))
        self._policy = policy
        self._law = SteeringLaw(
            observation=self.observation, mirror_to_target=self.mirror_to_target
        )
        self._is_led = np.array(is_led)[:, None]

    def predict(
        self,
        observation: NDArray[np.float32],
        state: Any = None,
        episode_start: NDArray[np.bool_] | None = None,
        deterministic: bool = True,
    ) -> tuple[NDArray[np.float32], Any]:
        ours, state = self._policy.predict(observation, state, episode_start, deterministic)
        theirs, _ = self._law.predict(observation)
        shape = (len(self._is_led), 1)
        return np.where(self._is_led, ours.reshape(shape), theirs.reshape(shape)), state


def simulate_against_the_law(
    parameters: FlockParameters,
    seed: int,
    duration_s: float,
    sample_hz: float,
    policy: LeaderPolicy,
) -> Recording:
    """Run a flock whose clockwise leaders follow a policy, the others the paper's law.

    A pure function of its arguments; both decide at the policy's rate.

    Raises
    ------
    ParameterError
        For arguments out of range, and parameters whose leaders head for one direction.
    """
    if parameters.n_leaders == 0 or parameters.common_target is not None:
        raise ParameterError(
            f"target = {parameters.target!r} is not accepted: leaders of both directions"
        )
    opponents: Any = _Opponents(policy, [target == "cw" for target in parameters.target])
    return simulate(parameters, seed, duration_s, sample_hz, opponents, dtype=np.float32)
