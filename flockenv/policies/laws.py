"""Policies that need no learning. Their formulas live in the Rust core."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv.policies.base import RowPolicy

__all__ = [
    "LAWS",
    "DampedLaw",
    "ObservedPolicy",
    "SignCorrectedLaw",
    "SteeringLaw",
    "stacked_rudders",
]


class ObservedPolicy(RowPolicy):
    """A closed-form law evaluated from observations, with the interface of an SB3 policy.

    Parameters
    ----------
    observation, mirror_to_target
        Layout of the observations, as in the environments' options of those names.

    Raises
    ------
    ParameterError
        If a block that the law reads is switched off.
    """

    _law: str

    def __init__(
        self,
        gains: Mapping[str, float],
        observation: Mapping[str, Any] | None,
        mirror_to_target: bool,
    ) -> None:
        super().__init__(observation, mirror_to_target)
        self.gains = dict(gains)
        self._core = _core.ObservedLaw(self._law, self.gains, self.observation, mirror_to_target)

    def observing(self, observation: Mapping[str, Any], mirror_to_target: bool) -> "ObservedPolicy":
        """Return the same law for another layout of the observations."""
        return _rebuilt(type(self), self.gains, dict(observation), mirror_to_target)

    def _steer(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        return self._core.rudders(rows)

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuilt, (type(self), self.gains, self.observation, self.mirror_to_target)

    def __repr__(self) -> str:
        gains = ", ".join(f"{name}={value:g}" for name, value in self.gains.items())
        return f"{type(self).__name__}({gains})"


def _rebuilt(
    kind: type[ObservedPolicy],
    gains: dict[str, float],
    observation: dict[str, Any],
    mirror_to_target: bool,
) -> ObservedPolicy:
    return kind(**gains, observation=observation, mirror_to_target=mirror_to_target)  # type: ignore[arg-type]


class SteeringLaw(ObservedPolicy):
    """The paper's law, eq. (10): s = clamp(6·wrap(β - α)/π, -1, 1).

    β is the tangential heading of the target direction at the leader's own position. The
    law is evaluated once per control step, from the observation; `Flock.advance` without rudders
    evaluates it at every substep, from the pose.

    Parameters
    ----------
    observation, mirror_to_target
        Layout of the observations; see `ObservedPolicy`.
    """

    _law = "steering"

    def __init__(
        self, *, observation: Mapping[str, Any] | None = None, mirror_to_target: bool = False
    ) -> None:
        super().__init__({}, observation, mirror_to_target)


class SignCorrectedLaw(ObservedPolicy):
    """s = sign(u·x˙)·clamp(gain·wrap(β - α), -1, 1): a rudder works in reverse when backing.

    Parameters
    ----------
    gain
        Rudder per rad of misalignment; 6/π in eq. (10).
    observation, mirror_to_target
        Layout of the observations; see `ObservedPolicy`.
    """

    _law = "sign_corrected"

    def __init__(
        self,
        gain: float = 6.0 / math.pi,
        *,
        observation: Mapping[str, Any] | None = None,
        mirror_to_target: bool = False,
    ) -> None:
        super().__init__({"gain": gain}, observation, mirror_to_target)


class DampedLaw(ObservedPolicy):
    """As `SignCorrectedLaw`, and when backing counters the turning that makes boats spin.

    Forward: s = clamp(gain·wrap(β - α), -1, 1). Backward:
    s = clamp(-backward_gain·wrap(β - α) + damping·α˙, -1, 1).

    Parameters
    ----------
    gain
        Rudder per rad of misalignment while moving forward.
    backward_gain
        Rudder per rad of misalignment while moving backward.
    damping
        Rudder per rad/s of angular velocity while moving backward.
    observation, mirror_to_target
        Layout of the observations; see `ObservedPolicy`.
    """

    _law = "damped"

    def __init__(
        self,
        gain: float = 6.0 / math.pi,
        backward_gain: float = 6.0 / math.pi,
        damping: float = 3.0,
        *,
        observation: Mapping[str, Any] | None = None,
        mirror_to_target: bool = False,
    ) -> None:
        gains = {"gain": gain, "backward_gain": backward_gain, "damping": damping}
        super().__init__(gains, observation, mirror_to_target)


def stacked_rudders(
    laws: Sequence[ObservedPolicy], rows: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return the rudders of several laws, each for observations of its own.

    Parameters
    ----------
    laws
        The laws.
    rows
        Shape (laws, leaders, observation size), float32.

    Returns
    -------
    numpy.ndarray
        Shape (laws, leaders), float32: what `predict` of each law returns.
    """
    rudders = np.empty(rows.shape[:2], np.float32)
    for place, (law, each) in enumerate(zip(laws, rows, strict=True)):
        rudders[place] = law._core.rudders(each)
    return rudders


LAWS: Mapping[str, Callable[..., ObservedPolicy]] = {
    "steering law": SteeringLaw,
    "sign-corrected law": SignCorrectedLaw,
    "damped law": DampedLaw,
}
"""The closed-form laws by name."""
