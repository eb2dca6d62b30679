"""`simulate`: a seeded run from a random start, recorded."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from flockenv import _core
from flockenv.errors import ParameterError, shown
from flockenv.flock import ContactSeries, Flock
from flockenv.order import OrderSeries
from flockenv.parameters import FlockParameters
from flockenv.policies.base import LeaderPolicy, check_action_mode, control_rate, decision_rate
from flockenv.policies.laws import LawPolicy, SteeringLaw
from flockenv.policies.model import ModelPolicy, as_policy
from flockenv.policies.registry import named_policy, policy_name
from flockenv.recording import PHASES, PRECISIONS, Recording

Schedule = Sequence[tuple[float, Mapping[str, Any]]]
"""Times in s from the start of a run, and the fields of the parameters that change then."""

Start = bytes | Mapping[str, Any] | Recording
"""A snapshot, a state, or a recording whose last sample it is."""

Steering = LeaderPolicy | str | None
"""A policy, its name or its file; None for the paper's law at every substep."""


def simulate(
    parameters: FlockParameters,
    seed: int,
    duration_s: float,
    sample_hz: float = 10.0,
    policy: Steering | Mapping[str, Steering] = None,
    *,
    control_hz: float | None = None,
    dtype: DTypeLike = np.float64,
    contacts: bool = False,
    progress: Callable[[float], object] | None = None,
    start: Start | None = None,
    noise_seed: int | None = None,
    schedule: Schedule = (),
    quantities: Mapping[str, Callable[[Recording], ArrayLike]] | None = None,
) -> Recording:
    """Run a flock and record it: a pure function of its arguments.

    Without a policy of its own the run is one call into the core, without the interpreter lock.

    Parameters
    ----------
    parameters
        Of the flock.
    seed
        Seed of all random streams, 0 to 2^64 - 1.
    duration_s
        Length of the run in s, from 0 s (one sample: the start) to 1e9 s. The run ends with the
        last sample.
    sample_hz
        Samples per second, taken at 0, 1/sample_hz, 2/sample_hz … Substeps end on samples: rates of
        which 1/dt_s is no multiple change the course of the run within its numerical error.
    policy
        How leaders steer: None for the paper's law, eq. (10), at every substep; the name of
        another policy, such as "learned" or "damped law", or the path of a policy's file; or an
        object whose ``predict`` maps observations (k, size) to rudders (k,), clipped
        to [-1, 1], such as a model of stable-baselines3. It observes the default layout, or that
        of its attributes ``observation`` and ``mirror_to_target``; a model observes what it was
        trained on. A dictionary has one of these for each of ``"leader_0"`` to
        ``"leader_{k-1}"``; the law then acts at every control step.
    control_hz
        Control steps per second of a policy; None: as many as a model was trained with, where its
        observation space says so, and otherwise 10. Needed where the policies of a dictionary
        decide at different rates.
    dtype
        float64, or float32 for half the size, which rounds the stored pose and velocity but not
        the run.
    contacts
        Whether contacts and their forces are recorded too: 28 bytes per contact.
    progress
        Called now and then with the flock-seconds simulated since; what it raises ends the run.
    start
        Where the run starts, and at which time. None: at random, at rest, at 0 s. A snapshot, as
        bytes of `Flock.snapshot`, of a flock with these parameters (the target aside) and this
        seed: under the law the run continues with the same bits. A dictionary with ``pose`` (n, 3)
        and, if need be, ``velocity`` (n, 3), ``time_s`` and ``allow_overlap``, as in
        `Flock.set_state`. A recording: its last sample.
    noise_seed
        Of a start from a snapshot: other noise from there on, as `Flock.restore` has it.
    schedule
        What changes on the way: pairs of a time in s from the start of the run and a dictionary of
        the parameters' fields that have other values from then on, after the sample at that time:
        ``[(60.0, {"bw_s": 0.6}), (120.0, {"bw_s": 0.9})]`` is a ramp. With another pool each boat
        keeps its angle about the center and its share of the way between the walls. The recording
        has the parameters of its start.
    quantities
        Quantities of your own, by name: functions that take the recording and return an array (t,),
        a number for each sample. They are kept in its attribute ``quantities``, in its file and in
        its tables.

    Returns
    -------
    Recording
        floor(duration_s · sample_hz) + 1 samples.

    Raises
    ------
    ParameterError
        For arguments out of range, unknown names of policies and pools that a policy is not made
        for, policies whose actions are no rudders, boats that do not fit the pool, a start that
        this flock cannot have, a noise_seed without a snapshot, a schedule that changes n_boats or
        n_leaders, quantities of another shape or with the name of one that there is, rudders that
        are NaN, and a recording of more than 16 GiB; nothing is returned then.
    OSError
        If a policy's file cannot be opened.
    TypeError
        For arguments of the wrong type.
    SolverError
        If the motion left its range of 1e9 (cm, cm/s, rad, rad/s).
    """
    if not isinstance(parameters, FlockParameters):
        raise TypeError(f"parameters must be FlockParameters, not {shown(parameters)}")
    seats = _seats(policy, parameters)
    changes = _changes(parameters, schedule)
    flock = _started(parameters, seed, start, noise_seed)
    precision = np.dtype(dtype)
    if precision not in PRECISIONS:
        raise ParameterError(f"dtype = {precision} is not accepted: float64 or float32")
    plan = {
        "sample_hz": sample_hz,
        "single_precision": bool(precision == np.float32),
        "contacts": contacts,
        "changes": changes,
        "control": _control(seats, parameters.n_leaders, control_hz),
        "progress": progress,
    }
    columns = _core.record(flock.core, duration_s, plan)
    series = columns.pop("contacts", None)
    run = Recording(
        **columns | {"phase": PHASES[columns["phase"]], "order": OrderSeries(**columns["order"])},
        contacts=None if series is None else ContactSeries.of_columns(series),
        parameters=parameters,
        seed=flock.seed,
        version=_core.__version__,
        policy="; ".join(seat.title for seat in seats) or policy_name(None),
    )
    return run if quantities is None else run.with_quantities(quantities)


@dataclass
class _Seat:
    """A policy with the leaders that it steers, and its state if it is recurrent."""

    policy: LeaderPolicy
    leaders: list[int]
    is_alone: bool
    state: Any = None

    def __post_init__(self) -> None:
        self.is_mirrored = bool(getattr(self.policy, "mirror_to_target", False))
        self.observation = dict(getattr(self.policy, "observation", None) or {})

    @property
    def title(self) -> str:
        names = ", ".join(f"leader_{leader}" for leader in self.leaders)
        return ("" if self.is_alone else f"{names}: ") + policy_name(self.policy)

    def rudders(
        self, observation: NDArray[np.float32], signs: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return rudders of its leaders, of what all see and the signs of their targets."""
        actions, self.state = self.policy.predict(observation[self.leaders], self.state)
        rudders = np.clip(np.asarray(actions, np.float64).reshape(-1), -1.0, 1.0)
        # A mirrored policy steers as if every target were clockwise.
        return signs[self.leaders] * rudders if self.is_mirrored else rudders


def _seats(policy: Steering | Mapping[str, Steering], parameters: FlockParameters) -> list[_Seat]:
    """Return who steers whom; nobody for the paper's law at every substep."""
    k = parameters.n_leaders
    if not isinstance(policy, Mapping):
        only = _resolved(policy, parameters)
        seats = [] if only is None else [_Seat(only, [*range(k)], is_alone=True)]
    else:
        names = [f"leader_{leader}" for leader in range(k)]
        if policy.keys() != set(names):
            accepted = ", ".join(names) or "none, since n_leaders = 0"
            raise ParameterError(
                f"policy = {shown(dict(policy))} is not accepted: a policy for each of {accepted}"
            )
        # Leaders with one policy are steered at once, as a model of several leaders needs it.
        by_policy: dict[Any, _Seat] = {}
        for leader, given in enumerate(policy[name] for name in names):
            key = given if isinstance(given, str) else id(given)
            if key not in by_policy:
                own = _resolved(given, parameters) or SteeringLaw()
                by_policy[key] = _Seat(own, [], is_alone=False)
            by_policy[key].leaders.append(leader)
        seats = list(by_policy.values())
    for seat in seats:
        if isinstance(seat.policy, ModelPolicy) and seat.leaders:
            seat.policy.check_leaders(len(seat.leaders))
    return seats


def _resolved(policy: Steering, parameters: FlockParameters) -> LeaderPolicy | None:
    """Return a policy by its name or file; None for the paper's law at every substep."""
    if isinstance(policy, str):
        named = named_policy(policy, parameters.pool)()
        policy = None if isinstance(named, str) else named
    policy = as_policy(policy)
    if policy is not None and not hasattr(policy, "predict"):
        raise ParameterError(
            f"policy = {shown(policy)} is not accepted: None, a policy's name or file, or an "
            "object with predict"
        )
    return policy


def _control(
    seats: Sequence[_Seat], n_leaders: int, control_hz: float | None
) -> dict[str, Any] | None:
    if not seats:
        return None
    first = seats[0].policy
    if isinstance(first, LawPolicy) and seats[0].is_alone:
        # The core steers by a law alone, and holds its leans.
        rate = control_rate(first) if control_hz is None else control_hz
        return {"steer": first.law, "layouts": [], "control_hz": rate}
    for seat in seats:
        check_action_mode(seat.policy, "rudder", "in a simulation")
    rates = {decision_rate(seat.policy) for seat in seats}
    if control_hz is None and len(rates) > 1:
        given = ", ".join(f"{rate:g}" for rate in sorted(rates))
        raise ParameterError(f"the policies decide {given} times per second: give control_hz")

    def steer(
        signs: NDArray[np.float64], *observations: NDArray[np.float32]
    ) -> NDArray[np.float64]:
        rudders = np.zeros(n_leaders)
        for seat, observation in zip(seats, observations, strict=True):
            rudders[seat.leaders] = seat.rudders(observation, signs)
        return rudders

    return {
        "steer": steer,
        "layouts": [(seat.observation, seat.is_mirrored) for seat in seats],
        "control_hz": rates.pop() if control_hz is None else control_hz,
    }


def _changes(
    parameters: FlockParameters, schedule: Schedule
) -> list[tuple[float, str | tuple[str, ...] | FlockParameters]]:
    """Return the changes of a schedule: of the target alone, or of all parameters."""
    for entry in schedule:
        match entry:
            case (int() | float() as time_s, Mapping() as fields) if 0.0 <= time_s <= 1e9:
                if sized := {"n_boats", "n_leaders"} & fields.keys():
                    raise ParameterError(
                        f"schedule = {shown(entry)} is not accepted: {sized.pop()} does not change "
                        "on the way"
                    )
            case _:
                raise ParameterError(
                    f"schedule = {shown(entry)} is not accepted: pairs of a time in s, at least 0, "
                    "and a dictionary of fields"
                )
    changes: list[tuple[float, str | tuple[str, ...] | FlockParameters]] = []
    now = parameters
    for time_s, fields in sorted(schedule, key=lambda each: each[0]):
        now = now.replace(**fields)
        changes.append((float(time_s), now.target if fields.keys() == {"target"} else now))
    return changes


def _started(
    parameters: FlockParameters, seed: int, start: Start | None, noise_seed: int | None
) -> Flock:
    if noise_seed is not None and not isinstance(start, bytes):
        raise ParameterError(
            f"noise_seed = {shown(noise_seed)} is not accepted: it goes with a snapshot as start, "
            "which it continues with other noise"
        )
    if start is None:
        return Flock(parameters, seed)
    if isinstance(start, Recording):
        start = start.state_at(start.duration_s if len(start) == 0 else float(start.time_s[-1]))
    if isinstance(start, Mapping):
        return Flock.from_state(parameters, seed, dict(start))
    if not isinstance(start, bytes):
        raise TypeError(
            "start must be a snapshot (bytes), a dictionary with pose and perhaps velocity and "
            f"time_s, or a recording, not {shown(start)}"
        )
    flock = Flock.from_snapshot(start, noise_seed)
    if flock.parameters.replace(target=parameters.target) != parameters:
        raise ParameterError("start is a snapshot of a flock with other parameters")
    if flock.seed != seed:
        raise ParameterError(
            f"seed = {shown(seed)} is not accepted: start is a snapshot of {flock.seed}"
        )
    flock.set_target(parameters.target)
    return flock
