"""The type of policies, and the base of those that steer each leader by its own observation."""

import copy
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Protocol, Self, TypedDict, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv._io.arguments import as_bool, by_name, listed, number, real_numbers
from flockenv.envs.observation import observation_entries
from flockenv.envs.options import OPTIONS
from flockenv.errors import ParameterError, refuse_unknown, short_repr


class Layout(TypedDict, total=False):
    """Options of the environments that say what leaders observe."""

    observation: Mapping[str, object] | None
    mirror_to_target: bool


Pool = str | tuple[float, float]
"""A pool's name, or its outer and inner radius in cm."""


@runtime_checkable
class LeaderPolicy(Protocol):
    """Anything with the ``predict`` of a stable-baselines3 policy."""

    def predict(self, observation: Any, state: Any = None, episode_start: Any = None) -> Any:
        """Return actions for observations.

        Parameters
        ----------
        observation
            Shape (..., m * observation size): m leaders' observations one after another in the
            last axis, as the environments give them. The policies of this package also take a
            dictionary of such arrays by agent, and then return a dictionary.
        state, episode_start
            The state that the last call returned, and shape (flocks,): whether an episode has just
            started. Both matter to recurrent policies only.

        Returns
        -------
        action : numpy.ndarray or dict
            Shape (..., m), in [-1, 1], and float32 from the policies of this package.
        state
            The next state of a recurrent policy; other policies return `state` unchanged.

        Raises
        ------
        ParameterError
            From the policies of this package, if the last axis is not a multiple of the
            observation's size.
        """


CONTROL_HZ: float = OPTIONS["control_hz"].default
"""Default control steps per second of environments and policies."""

_LONGEST_NAME = 200


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Policy:
    """A checked policy; `flockenv.policies.policy` makes one from all that it accepts.

    Attributes
    ----------
    source
        The object that acts, which has ``predict``.
    name
        The name in recordings: ``repr(source)``, and then the source's ``digest`` if it has one.
        The class's name replaces a repr that is Python's default, empty, longer than 200 characters
        or not printable.
    control_hz
        Control steps per second that it is made for. None: the paper's law at every substep.
    pool
        The pool that it was made for; None: any.
    observation, mirror_to_target, action_mode, decision_period_s
        The values of these environment options that it is made for.
    leaders
        Number of leaders that the source steers at once. 1: it steers each leader by itself, and so
        any number of them.
    law
        The core's law, if the policy is exactly that law: the core then steers without Python.
    """

    source: LeaderPolicy
    name: str
    control_hz: float | None = CONTROL_HZ
    pool: Pool | None = None
    observation: Mapping[str, object] = field(default_factory=dict)
    mirror_to_target: bool = False
    action_mode: str = "rudder"
    decision_period_s: float | None = None
    leaders: int = 1
    law: _core.Law | None = None

    @classmethod
    def from_source(
        cls, source: LeaderPolicy, *, leaders: int = 1, law: _core.Law | None = None
    ) -> Self:
        """Return a policy that acts by an object's ``predict``, with the options in its attributes.

        Raises TypeError or ParameterError for an attribute whose value its option does not accept.
        """
        action_mode = getattr(source, "action_mode", None) or "rudder"
        refuse_unknown((action_mode,), _core.ACTION_MODES, "action_mode of a policy")
        observation = getattr(source, "observation", None) or {}
        mirror_to_target = getattr(source, "mirror_to_target", False)
        control_hz = _positive_attribute(source, "control_hz")
        return cls(
            source=source,
            name=_recorded_name(source),
            control_hz=CONTROL_HZ if control_hz is None else control_hz,
            pool=getattr(source, "pool", None),
            observation=by_name(observation, "a policy's observation"),
            mirror_to_target=as_bool(mirror_to_target, "a policy's mirror_to_target"),
            action_mode=action_mode,
            decision_period_s=_positive_attribute(source, "decision_period_s"),
            leaders=leaders,
            law=law,
        )

    @property
    def decisions_hz(self) -> float:
        """Decisions per second: one per control step if no period is set."""
        if self.decision_period_s is not None:
            return 1.0 / self.decision_period_s
        return CONTROL_HZ if self.control_hz is None else self.control_hz

    def started(self) -> Self:
        """Return a copy for one run, so that its random draws do not depend on earlier runs.

        A model and a user's own object are not copied.
        """
        if not isinstance(self.source, RowPolicy):
            return self
        return replace(self, source=copy.deepcopy(self.source))

    def check_pool(self, pool: Pool) -> None:
        """Refuse any pool but the one that the policy was made for."""
        if self.pool is not None and self.pool != pool:
            raise ParameterError(
                f"pool = {short_repr(pool)} is not accepted with {short_repr(self)}: it was made "
                f"for pool = {self.pool!r}"
            )

    def check_action_mode(self, mode: str, where: str) -> None:
        """Refuse any action mode but the one that the policy's actions are for."""
        if self.action_mode != mode:
            raise ParameterError(
                f"{short_repr(self)} gives actions of action_mode {self.action_mode!r}: not "
                f"accepted {where}, which takes action_mode {mode!r}"
            )

    def check_leaders(self, n_leaders: int) -> None:
        """Refuse a number of leaders that the policy cannot steer at once."""
        if self.leaders not in (1, n_leaders):
            raise ParameterError(
                f"n_leaders = {n_leaders} is not accepted with {self!r}: it steers {self.leaders} "
                "leaders at once; one that is trained on LeaderVecEnv steers any number"
            )

    def predict(
        self, observation: object, state: object = None, episode_start: object = None
    ) -> Any:
        """Return the source's actions for observations, as `LeaderPolicy`."""
        if episode_start is None:
            return self.source.predict(observation, state)
        return self.source.predict(observation, state, episode_start)

    def decide(
        self, observation: NDArray[np.float32], state: object, leaders: int
    ) -> tuple[NDArray[np.float64], object]:
        """Return the actions of a number of leaders, shape (leaders,), and the policy's next state.

        Raises ParameterError if the source returns anything but one real number per leader, and a
        state.
        """
        returned = self.source.predict(observation, state)
        if not isinstance(returned, tuple) or len(returned) != 2:
            raise ParameterError(
                f"what a policy returns is not accepted: actions and a state, not "
                f"{short_repr(returned)}"
            )
        actions, state = real_numbers(returned[0], "what a policy returns"), returned[1]
        if np.ma.is_masked(actions):
            raise ParameterError("what a policy returns is not accepted: numbers, none masked")
        if actions.size != leaders:
            raise ParameterError(
                f"what a policy returns has shape {actions.shape}, expected a rudder for each of "
                f"{leaders} leaders"
            )
        return np.asarray(actions, np.float64).reshape(-1), state

    def __repr__(self) -> str:
        return self.name if self.control_hz is None else repr(self.source)


def _positive_attribute(source: LeaderPolicy, name: str) -> float | None:
    """Return an object's attribute, which must be a number above 0; None if it is missing."""
    value = getattr(source, name, None)
    if value is not None and not 0.0 < number(value, name) < math.inf:
        raise ParameterError(f"{name} = {short_repr(value)} of a policy is not accepted: above 0")
    return None if value is None else float(value)


def _recorded_name(source: LeaderPolicy) -> str:
    """Return the `Policy.name` of a source."""
    cls = type(source)
    text = repr(source) if cls.__repr__ is not object.__repr__ else ""
    is_accepted = 0 < len(text) <= _LONGEST_NAME and text.isprintable()
    name = text if is_accepted else cls.__qualname__
    return f"{name} {getattr(source, 'digest', '')}".strip()


def observation_array(observation: ArrayLike) -> NDArray[np.float32]:
    """Return an observation as a contiguous float32 array; refuse anything but real numbers."""
    # Arrays of environments are not checked: that would take longer than a step of a law.
    if type(observation) is not np.ndarray or observation.dtype != np.float32:
        if np.ma.is_masked(observation):
            raise ParameterError("observation is masked: give plain numbers")
        observation = real_numbers(observation, "observation")
    return np.ascontiguousarray(observation, np.float32)


def leaders_in_last_axis(observation: NDArray[Any], size: int) -> int:
    """Return how many leaders' observations, each of `size` numbers, the last axis holds."""
    width = observation.shape[-1] if observation.ndim else 0
    if width == 0 or width % size != 0:
        raise ParameterError(
            f"observation has shape {observation.shape}, but its last axis must be a multiple of "
            f"{size}, the size of a leader's observation"
        )
    return width // size


class RowPolicy(ABC):
    """A policy that maps one leader's observation to its rudder, with `predict` as SB3 has it.

    Parameters
    ----------
    observation, mirror_to_target
        Layout of the observations, as in the environments' options of those names.

    Attributes
    ----------
    action_mode, decision_period_s
        The values of these environment options that the policy's actions are made for.
    """

    action_mode: str = "rudder"
    decision_period_s: float | None = None

    def __init__(
        self, *, observation: Mapping[str, object] | None = None, mirror_to_target: bool = False
    ) -> None:
        if not isinstance(observation, Mapping | None):
            raise ParameterError(
                f"observation = {short_repr(observation)} is not accepted: blocks by name"
            )
        if not isinstance(mirror_to_target, bool | np.bool_):
            raise ParameterError(
                f"mirror_to_target = {short_repr(mirror_to_target)} is not accepted: True or False"
            )
        # Plain numbers instead of NumPy's, which no file of a policy could hold.
        self.observation = {name: listed(block) for name, block in (observation or {}).items()}
        self.mirror_to_target = bool(mirror_to_target)
        self._observation_size = len(observation_entries(self.observation))

    @abstractmethod
    def _steer(self, rows: NDArray[np.float32]) -> NDArray[np.floating[Any]]:
        """Return a rudder in [-1, 1] for each row of observations (leaders, size)."""

    def predict(
        self,
        observation: ArrayLike | Mapping[object, ArrayLike],
        state: object = None,
        episode_start: object = None,
        deterministic: bool = True,
    ) -> tuple[object, object]:
        """Return rudders for observations, as `LeaderPolicy`; `deterministic` has no effect."""
        if isinstance(observation, Mapping):
            return {agent: self._rudders(rows) for agent, rows in observation.items()}, state
        return self._rudders(observation), state

    def _rudders(self, observation: ArrayLike) -> NDArray[np.float32]:
        array = observation_array(observation)
        leaders = leaders_in_last_axis(array, self._observation_size)
        rudders = np.asarray(self._steer(array.reshape(-1, self._observation_size)), np.float32)
        return rudders.reshape(*array.shape[:-1], leaders)

    def __repr__(self) -> str:
        return f"{type(self).__name__}()"
