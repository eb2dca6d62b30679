"""Leaders that change their direction again and again, as in figure 7."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv.errors import ParameterError
from flockenv.flock import Flock
from flockenv.parameters import FlockParameters
from flockenv.policies.base import LeaderPolicy
from flockenv.policies.laws import LawPolicy
from flockenv.recording import Recording
from flockenv.simulation import recorded

__all__ = ["PERIOD_S", "TARGETS", "second_halves", "simulate_alternating", "target_at"]

PERIOD_S = 240.0
"""Length of a stretch in one direction in s (Section 2.6)."""

TARGETS = ("ccw", "cw")
"""The directions, one after another (Section 2.6: CCW-CW-CCW-CW)."""


def target_at(time_s: float, period_s: float = PERIOD_S, targets: Sequence[str] = TARGETS) -> str:
    """Return the direction that holds from a time on."""
    return targets[int(time_s // period_s) % len(targets)]


def second_halves(
    time_s: NDArray[np.float64],
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Return which times are in the second half of their stretch, and the direction at each.

    The direction is +1 clockwise and -1 counter-clockwise, as a rotation's sign is.
    """
    signs = np.array([1.0 if target_at(time) == "cw" else -1.0 for time in time_s])
    return time_s % PERIOD_S >= PERIOD_S / 2, signs


def simulate_alternating(
    parameters: FlockParameters,
    seed: int,
    duration_s: float,
    sample_hz: float = 10.0,
    period_s: float = PERIOD_S,
    policy: LeaderPolicy | None = None,
) -> Recording:
    """Run a flock whose leaders follow a policy towards directions that alternate.

    A pure function of its arguments. None stands for the paper's law at every substep. The first
    direction is counter-clockwise, whatever the target of the parameters; directions change at
    samples. The recording and its replay show the parameters' target alone: `target_at` returns the
    one that held.

    Raises
    ------
    ParameterError
        For arguments out of range, periods that are no whole number of samples, and policies that
        see a mirrored flock, whose mirror a run cannot change.
    SolverError
        If the motion left its range.
    """
    # A law that steers in the core sees the target that holds.
    if getattr(policy, "mirror_to_target", False) and not isinstance(policy, LawPolicy):
        raise ParameterError(
            "a policy with mirror_to_target = True is not accepted: targets change"
        )
    samples = _core.whole_steps_in("period_s", period_s, sample_hz)
    stretches = int(duration_s / period_s) + 1 if math.isfinite(duration_s) else 0
    changes = [
        (stretch * samples / sample_hz, TARGETS[stretch % len(TARGETS)])
        for stretch in range(stretches)
    ]
    flock = Flock(parameters, seed)
    return recorded(flock, parameters, duration_s, sample_hz, changes=changes, policy=policy)
