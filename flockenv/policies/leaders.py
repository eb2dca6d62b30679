"""`Leaders`: the policies of a flock's leaders, one for all of them or several."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Self

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv.errors import ParameterError, short_repr
from flockenv.parameters import FlockParameters
from flockenv.policies.base import Policy, Pool
from flockenv.policies.names import EVERY_SUBSTEP, PAPERS_LAW
from flockenv.policies.registry import PolicyLike, policy

_MAX_COMMON_HZ = 1000


@dataclass(frozen=True)
class Assignment:
    """A policy and the leaders that it steers."""

    policy: Policy
    leaders: tuple[int, ...]


@dataclass(frozen=True)
class Leaders:
    """The policies of a flock's leaders, checked.

    Attributes
    ----------
    assignments
        Each policy with its leaders; together these are all leaders.
    is_per_leader
        Whether the policies were given leader by leader.
    """

    assignments: tuple[Assignment, ...]
    is_per_leader: bool = False

    @classmethod
    def from_policies(
        cls, given: PolicyLike | Mapping[str, PolicyLike], flock: FlockParameters
    ) -> Self:
        """Return the policies of a flock's leaders, from one policy or a dictionary by leader.

        Raises the errors of `policy`. Also raises ParameterError for policies without leaders to
        steer, policies for another number of leaders, and dictionaries that do not name the
        leaders.
        """
        k = flock.n_leaders
        if isinstance(given, Mapping) and (given or k > 0):
            leaders = cls(_assignments(given, flock), is_per_leader=True)
            for assignment in leaders.assignments:
                assignment.policy.check_action_mode("rudder", "leader by leader")
        else:
            # An empty dictionary is right for a flock without leaders.
            shared = EVERY_SUBSTEP if isinstance(given, Mapping) else given
            assignment = Assignment(policy(shared, flock.pool), tuple(range(k)))
            leaders = cls((assignment,))
        for assignment in leaders.assignments:
            if k == 0 and assignment.policy.control_hz is not None:
                raise ParameterError(
                    f"policy = {short_repr(given)} is not accepted: with n_leaders = 0 it steers "
                    "nobody"
                )
            if k > 0:
                assignment.policy.check_leaders(len(assignment.leaders))
        return leaders

    @property
    def title(self) -> str:
        """The name under which recordings hold the policies."""
        if not self.is_per_leader:
            return self.assignments[0].policy.name
        titles = []
        for assignment in self.assignments:
            names = ", ".join(f"leader_{leader}" for leader in assignment.leaders)
            titles.append(f"{names}: {assignment.policy.name}")
        return "; ".join(titles)

    @property
    def law(self) -> _core.Law | None:
        """The core's law that steers all leaders; None if another kind of policy does."""
        return None if self.is_per_leader else self.assignments[0].policy.law

    def check_pool(self, pool: Pool) -> None:
        """Refuse a pool that one of the policies was not made for."""
        for assignment in self.assignments:
            assignment.policy.check_pool(pool)

    def decisions(self, control_hz: float | None = None) -> "Decisions":
        """Return the `Decisions` of a new run; with None, each policy decides at its own rate."""
        return Decisions(self.assignments, control_hz)


def _assignments(given: Mapping[str, PolicyLike], flock: FlockParameters) -> tuple[Assignment, ...]:
    """Return each distinct policy of a dictionary by leader, with its leaders."""
    names = [f"leader_{leader}" for leader in range(flock.n_leaders)]
    if given.keys() != set(names):
        accepted = ", ".join(names) or "none, since n_leaders = 0"
        raise ParameterError(
            f"policy = {short_repr(dict(given))} is not accepted: a policy for each of {accepted}"
        )
    # Leaders with the same policy are steered together: a model of several leaders needs that.
    policies: dict[object, Policy] = {}
    leaders_of_policy: dict[object, list[int]] = {}
    for leader, policy_like in enumerate(given[name] for name in names):
        key = policy_like if isinstance(policy_like, str) else id(policy_like)
        if key not in policies:
            checked = policy(policy_like, flock.pool)
            # In a dictionary, the paper's law acts at every control step, not at every substep.
            is_every_substep = checked.control_hz is None
            policies[key] = policy(PAPERS_LAW) if is_every_substep else checked
        leaders_of_policy.setdefault(key, []).append(leader)
    return tuple(
        Assignment(policies[key], tuple(leaders)) for key, leaders in leaders_of_policy.items()
    )


class Decisions:
    """The decisions of policies in a run of one flock, or of several similar ones.

    Parameters
    ----------
    assignments
        The policies, each with the leaders that it steers.
    control_hz
        Decisions per second of all policies; None: each has its own rate.
    """

    def __init__(self, assignments: Sequence[Assignment], control_hz: float | None = None) -> None:
        self._policies = [
            _SteeringPolicy(assignment.policy.started(), list(assignment.leaders))
            for assignment in assignments
        ]
        #: Calls of `rudders` per second.
        self.control_hz = _set_common_rate(self._policies) if control_hz is None else control_hz
        #: The observation of each policy, and whether its view is mirrored.
        self.layouts = [
            (dict(steering.policy.observation), steering.policy.mirror_to_target)
            for steering in self._policies
        ]

    def rudders(
        self, signs: NDArray[np.float64], *observations: NDArray[np.float32]
    ) -> NDArray[np.float64]:
        """Return the rudders of all leaders, flock after flock.

        Parameters
        ----------
        signs
            Sign of each leader's target, shape (flocks * leaders,): 1 for clockwise.
        observations
            All leaders' observations, one array of shape (flocks * leaders, size) per layout.
        """
        leaders = sum(len(steering.leaders) for steering in self._policies)
        rudders = np.zeros((len(signs) // leaders, leaders))
        for steering, rows in zip(self._policies, observations, strict=True):
            rudders[:, steering.leaders] = steering.next_rudders(
                rows.reshape(len(rudders), leaders, -1), signs.reshape(rudders.shape)
            )
        return rudders.ravel()


@dataclass
class _SteeringPolicy:
    """A policy in a run, with its leaders, its state, and the rudders that it holds."""

    policy: Policy
    leaders: list[int]
    #: State of a recurrent policy.
    state: object = None
    #: Control steps from one decision to the next.
    period: int = 1
    #: Control steps for which the held rudders remain.
    steps_left: int = 0
    held_rudders: NDArray[np.float64] | None = None

    def next_rudders(
        self, observations: NDArray[np.float32], signs: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the next control step's rudders of this policy's leaders, (flocks, leaders).

        Parameters
        ----------
        observations
            Observations of all leaders, shape (flocks, leaders, size).
        signs
            Signs of all leaders' targets, shape (flocks, leaders): 1 for clockwise.
        """
        if self.held_rudders is not None and self.steps_left > 0:
            self.steps_left -= 1
            return self.held_rudders
        self.steps_left = self.period - 1
        rows = observations[:, self.leaders].reshape(-1, observations.shape[-1])
        actions, self.state = self.policy.decide(rows, self.state, len(rows))
        rudders = np.clip(actions, -1.0, 1.0).reshape(-1, len(self.leaders))
        # A mirrored policy steers as if every target were clockwise.
        rudder_signs = signs[:, self.leaders] if self.policy.mirror_to_target else 1.0
        self.held_rudders = rudder_signs * rudders
        return self.held_rudders


def _set_common_rate(policies: Sequence[_SteeringPolicy]) -> float:
    """Return the least common multiple of all decision rates, and set each policy's period."""
    rates = [steering.policy.decisions_hz for steering in policies]
    if len(set(rates)) == 1:
        return rates[0]
    fractions = [Fraction(rate).limit_denominator(1000) for rate in rates]
    numerators, denominators = zip(*(rate.as_integer_ratio() for rate in fractions), strict=True)
    common_hz = Fraction(math.lcm(*numerators), math.gcd(*denominators))
    if common_hz > _MAX_COMMON_HZ:
        rates_text = ", ".join(f"{rate:g}" for rate in sorted(rates))
        raise ParameterError(
            f"the policies decide {rates_text} times per second, and have no common multiple up to "
            f"{_MAX_COMMON_HZ}: give control_hz"
        )
    for steering, rate in zip(policies, fractions, strict=True):
        steering.period = int(common_hz / rate)
    return float(common_hz)
