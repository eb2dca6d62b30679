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

_FASTEST_HZ = 1000


@dataclass(frozen=True)
class Seat:
    """A policy and the leaders that it steers."""

    policy: Policy
    leaders: tuple[int, ...]


@dataclass(frozen=True)
class Leaders:
    """The policies of a flock's leaders, checked.

    Attributes
    ----------
    seats
        Each policy with its leaders; together these are all leaders.
    is_per_leader
        Whether a policy was given for each leader.
    """

    seats: tuple[Seat, ...]
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
            found = cls(_seats(given, flock), is_per_leader=True)
            for seat in found.seats:
                seat.policy.check_action_mode("rudder", "leader by leader")
        else:
            alone = EVERY_SUBSTEP if isinstance(given, Mapping) else given
            found = cls((Seat(policy(alone, flock.pool), (*range(k),)),))
        for seat in found.seats:
            if k == 0 and seat.policy.control_hz is not None:
                raise ParameterError(
                    f"policy = {short_repr(given)} is not accepted: with n_leaders = 0 it steers "
                    "nobody"
                )
            if k > 0:
                seat.policy.check_leaders(len(seat.leaders))
        return found

    @property
    def title(self) -> str:
        """The name under which recordings hold the policies."""
        if not self.is_per_leader:
            return self.seats[0].policy.name
        return "; ".join(
            f"{', '.join(f'leader_{leader}' for leader in seat.leaders)}: {seat.policy.name}"
            for seat in self.seats
        )

    @property
    def law(self) -> _core.Law | None:
        """The core's law, if it is the one policy for all leaders."""
        return None if self.is_per_leader else self.seats[0].policy.law

    def check_pool(self, pool: Pool) -> None:
        """Refuse a pool that one of the policies was not made for."""
        for seat in self.seats:
            seat.policy.check_pool(pool)

    def decisions(self, control_hz: float | None = None) -> "Decisions":
        """Return the decisions of a run, at this rate or at the rates of the policies."""
        return Decisions(self.seats, control_hz)


def _seats(given: Mapping[str, PolicyLike], flock: FlockParameters) -> tuple[Seat, ...]:
    names = [f"leader_{leader}" for leader in range(flock.n_leaders)]
    if given.keys() != set(names):
        accepted = ", ".join(names) or "none, since n_leaders = 0"
        raise ParameterError(
            f"policy = {short_repr(dict(given))} is not accepted: a policy for each of {accepted}"
        )
    # Leaders with the same policy are steered together: a model of several leaders needs that.
    found: dict[object, tuple[Policy, list[int]]] = {}
    for leader, one in enumerate(given[name] for name in names):
        key = one if isinstance(one, str) else id(one)
        if key not in found:
            own = policy(one, flock.pool)
            # Beside other policies, the law acts at every control step.
            found[key] = policy(PAPERS_LAW) if own.control_hz is None else own, []
        found[key][1].append(leader)
    return tuple(Seat(own, tuple(leaders)) for own, leaders in found.values())


class Decisions:
    """The decisions of policies in a run of one flock, or of several similar ones.

    Parameters
    ----------
    seats
        The policies and the leaders that each steers.
    control_hz
        How often per second all of them decide; None: each at its own rate.
    """

    def __init__(self, seats: Sequence[Seat], control_hz: float | None = None) -> None:
        self._seats = [_Deciding(seat.policy.started(), list(seat.leaders)) for seat in seats]
        #: How often per second to call `rudders`.
        self.control_hz = _common_rate(self._seats) if control_hz is None else control_hz
        #: The observation of each policy, and whether its view is mirrored.
        self.layouts = [
            (dict(seat.policy.observation), seat.policy.mirror_to_target) for seat in self._seats
        ]

    def rudders(
        self, signs: NDArray[np.float64], *observations: NDArray[np.float32]
    ) -> NDArray[np.float64]:
        """Return the rudders of all leaders, flock after flock.

        Parameters
        ----------
        signs
            Sign of each leader's target, shape (leaders,): 1 for clockwise.
        observations
            The leaders' observations, one array of shape (leaders, size) per layout.
        """
        leaders = sum(len(seat.leaders) for seat in self._seats)
        rudders = np.zeros((len(signs) // leaders, leaders))
        for seat, observed in zip(self._seats, observations, strict=True):
            rudders[:, seat.leaders] = seat.rudders(
                observed.reshape(len(rudders), leaders, -1), signs.reshape(rudders.shape)
            )
        return rudders.ravel()


@dataclass
class _Deciding:
    """A policy in a run, with its leaders, and its state if it is recurrent."""

    policy: Policy
    leaders: list[int]
    state: object = None
    #: Control steps between two decisions, and control steps left until the next one.
    period: int = 1
    wait: int = 0
    held: NDArray[np.float64] | None = None

    def rudders(
        self, observed: NDArray[np.float32], signs: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return rudders of its leaders, shape (flocks, leaders), from all observations."""
        if self.held is not None and self.wait > 0:
            self.wait -= 1
            return self.held
        self.wait = self.period - 1
        rows = observed[:, self.leaders].reshape(-1, observed.shape[-1])
        actions, self.state = self.policy.decide(rows, self.state, len(rows))
        rudders = np.clip(actions, -1.0, 1.0).reshape(-1, len(self.leaders))
        # A mirrored policy steers as if every target were clockwise.
        mirrored = signs[:, self.leaders] if self.policy.mirror_to_target else 1.0
        self.held = mirrored * rudders
        return self.held


def _common_rate(seats: Sequence[_Deciding]) -> float:
    """Return the common rate of all seats, and set how long each seat holds its decision."""
    rates = [seat.policy.decisions_hz for seat in seats]
    if len(set(rates)) == 1:
        return rates[0]
    exact = [Fraction(rate).limit_denominator(1000) for rate in rates]
    numerators, denominators = zip(*(rate.as_integer_ratio() for rate in exact), strict=True)
    common = Fraction(math.lcm(*numerators), math.gcd(*denominators))
    if common > _FASTEST_HZ:
        given = ", ".join(f"{rate:g}" for rate in sorted(rates))
        raise ParameterError(
            f"the policies decide {given} times per second, and have no common multiple up to "
            f"{_FASTEST_HZ}: give control_hz"
        )
    for seat, rate in zip(seats, exact, strict=True):
        seat.period = int(common / rate)
    return float(common)
