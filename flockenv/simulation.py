"""`simulate`: a seeded run from a random start, recorded."""

import hashlib
import json
import math
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from flockenv import _core
from flockenv._io.arguments import as_bool, as_int, check_function, items, number
from flockenv.errors import ParameterError, short_repr
from flockenv.flock import ContactSeries, Flock, StepStatistics
from flockenv.order import OrderSeries
from flockenv.parameters import OBSTACLES, FlockParameters
from flockenv.policies.leaders import Leaders
from flockenv.policies.registry import PolicyLike
from flockenv.recording import PHASES, PRECISIONS, Recording, checked_functions

Schedule = Iterable[tuple[float, Mapping[str, object]]]
"""Times in s from the start of a run, and the fields of the parameters that change then."""

Start = bytes | Mapping[str, object] | Recording
"""A snapshot, a state, or a recording, whose last sample is the start."""

Changes = list[tuple[float, str | tuple[str, ...] | FlockParameters]]
"""Times of a schedule in s, and the target or the parameters from then on."""

# The fields that decide whether boats fit the pool, which is checked before a run.
_FIT_FIELDS = ("pool", "boat_radius_cm", "boat_shape", *OBSTACLES)


def simulate(
    parameters: FlockParameters,
    seed: int,
    duration_s: float,
    sample_hz: float = 10.0,
    policy: PolicyLike | Mapping[str, PolicyLike] = None,
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

    Under a law the run is one call into the core, without the interpreter lock.

    Parameters
    ----------
    parameters
        Parameters of the flock.
    seed
        Seed of all random streams, 0 to 2^64 - 1.
    duration_s
        Length of the run in s, from 0 s (one sample: the start) to 1e9 s. The run ends with the
        last sample.
    sample_hz
        Samples per second, taken at 0, 1/sample_hz, 2/sample_hz … Substeps end on samples, so a
        rate that does not divide 1/dt_s changes the run within its numerical error.
    policy
        How leaders steer, as `flockenv.policies.policy` takes it: None for the paper's law, eq.
        (10), at every substep; the name of another policy, such as "learned" or "damped law", or
        the path of a policy's file; or an object whose ``predict`` maps observations (k, size) to
        rudders (k,), clipped to [-1, 1], such as a model of stable-baselines3. It observes the
        default layout, or what its attributes ``observation`` and ``mirror_to_target`` say; a model
        observes what it was trained on. A dictionary has one of these for each of ``"leader_0"`` to
        ``"leader_{k-1}"``; the law then acts at every control step.
    control_hz
        Decisions per second of every policy. None: a policy's own rate, such as that of a model's
        training, or 10 if it has none. Policies of a dictionary may then decide at different rates;
        the rudder of a slower policy is held.
    dtype
        float64, or float32 for half the size: it rounds the stored pose and velocity, not the run.
    contacts
        Whether contacts and their forces are recorded too: 28 bytes per contact.
    progress
        Called now and then with the flock-seconds simulated since the last call; its exceptions end
        the run.
    start
        Where the run starts, and at which time. None: a random placement, at rest, at 0 s. A
        snapshot (bytes of `Flock.snapshot`) of a flock with this seed and these parameters, apart
        from the target: under the paper's law the run continues bit for bit. A dictionary with
        ``pose`` (n, 3) and, optionally, ``velocity`` (n, 3), ``time_s`` and ``allow_overlap``, as
        in `Flock.set_state`. A recording: its last sample. Boats may be at most a hull's width
        outside the water.
    noise_seed
        Other noise after a start from a snapshot; see `Flock.restore`.
    schedule
        Changes during the run: pairs of a time in s from the start of the run, and a dictionary of
        the fields of the parameters that change then, after the sample at that time. ``[(60.0,
        {"bw_s": 0.6}), (120.0, {"bw_s": 0.9})]`` is a ramp. The first change must come before the
        last sample, and none after the end of the run. With another pool each boat keeps its angle
        about the center and its relative distance between the walls. The recording has the
        parameters of its start.
    quantities
        User-defined quantities, by name: functions that take the recording, with read-only arrays,
        and return an array (t,), a real number for each sample. Their values are kept in the
        recording's attribute ``quantities``, in its file and in its tables.

    Returns
    -------
    Recording
        floor(duration_s · sample_hz) + 1 samples.

    Raises
    ------
    ParameterError
        For arguments out of range, unknown names of policies, pools that a policy was not made for,
        policies whose actions are not rudders, policies without leaders to steer, boats that do not
        fit the pool, a start that this flock cannot have, a noise_seed without a snapshot, a
        schedule that changes n_boats or n_leaders, a schedule whose first change is not before the
        last sample, quantities of another shape or with a name that is taken, rudders that are NaN,
        and a recording of more than 16 GiB. An error during the run has an attribute ``recording``:
        the run until then.
    OSError
        If a policy's file cannot be opened.
    TypeError
        For arguments of the wrong type.
    SolverError
        If a pose or velocity exceeds 1e9 (cm, cm/s, rad, rad/s).
    """
    if not isinstance(parameters, FlockParameters):
        raise TypeError(f"parameters must be FlockParameters, not {short_repr(parameters)}")
    if progress is not None:
        check_function(progress, "progress")
    seed = as_int(seed, "seed")
    control_hz = None if control_hz is None else float(number(control_hz, "control_hz"))
    leaders = Leaders.from_policies(policy, parameters)
    start = _start_state(start)
    changes = _parse_schedule(parameters, schedule, seed)
    for pool in {change.pool for _, change in changes if isinstance(change, FlockParameters)}:
        leaders.check_pool(pool)
    functions = checked_functions({} if quantities is None else quantities)
    flock = _starting_flock(parameters, seed, start, noise_seed)
    plan = {
        "sample_hz": sample_hz,
        "single_precision": _is_single_precision(dtype),
        "contacts": as_bool(contacts, "contacts"),
        "changes": changes,
        "control": _steering(leaders, control_hz),
        "progress": progress,
    }

    origin = {"parameters": parameters, "seed": flock.seed, "policy": leaders.title}
    origin |= _origin(flock, start, noise_seed, control_hz)
    run = _run(flock, duration_s, plan, partial(_build_recording, origin, changes))
    return run.with_quantities(functions) if functions else run


def _origin(
    flock: Flock,
    start: bytes | Mapping[str, object] | None,
    noise_seed: int | None,
    control_hz: float | None,
) -> dict[str, object]:
    """Return the fields in which runs with the same parameters, seed and policy may differ."""
    return {
        "noise_seed": None if noise_seed is None else as_int(noise_seed, "noise_seed"),
        "control_hz": control_hz,
        "start_sha256": _start_digest(start, flock),
    }


def _run(
    flock: Flock,
    duration_s: float,
    plan: dict[str, Any],
    build_recording: Callable[[dict[str, Any]], Recording],
) -> Recording:
    """Run a flock in the core; an error gets the run until then as its attribute ``recording``."""
    try:
        columns = _core.record(flock._in_core, duration_s, plan)
    except BaseException as error:
        if (columns := vars(error).pop("columns", None)) is not None:
            vars(error)["recording"] = build_recording(columns)
        raise
    return build_recording(columns)


def _build_recording(
    origin: Mapping[str, Any], changes: Changes, columns: dict[str, Any]
) -> Recording:
    """Return a recording with the core's columns and this origin."""
    contacts = columns.pop("contacts", None)
    converted = {
        "phase": PHASES[columns["phase"]],
        "order": OrderSeries(**columns["order"]),
        "statistics": StepStatistics(**columns["statistics"]),
        "contacts": None if contacts is None else ContactSeries.from_columns(contacts),
        "version": _core.__version__,
        "schedule_sha256": _schedule_digest(origin["parameters"], changes, columns["time_s"]),
    }
    return Recording(**columns | converted, **origin)


def _steering(leaders: Leaders, control_hz: float | None) -> dict[str, object]:
    """Return how leaders are steered, and how often, in the form that the core takes."""
    if leaders.law is not None:
        # The core evaluates the law, and holds each lean until the next decision.
        law_hz = leaders.assignments[0].policy.control_hz
        if law_hz is None and control_hz is not None:
            raise ParameterError(
                f"control_hz = {short_repr(control_hz)} is not accepted: without a policy the "
                "paper's law steers at every substep"
            )
        rate_hz = law_hz if control_hz is None else control_hz
        return {"steer": leaders.law, "layouts": [], "control_hz": rate_hz}
    for assignment in leaders.assignments:
        assignment.policy.check_action_mode("rudder", "in a simulation")
    decisions = leaders.decisions(control_hz)
    return {
        "steer": decisions.rudders,
        "layouts": decisions.layouts,
        "control_hz": decisions.control_hz,
    }


def _parse_schedule(parameters: FlockParameters, schedule: Schedule, seed: int) -> Changes:
    """Return a schedule's changes in order of time, after checking them.

    An entry that changes the target alone becomes that target. Any other entry becomes the full
    parameters from then on.
    """
    entries = [(*_parse_entry(entry), entry) for entry in items(schedule, "schedule")]
    changes: Changes = []
    current, changed_names = parameters, dict[float, set[str]]()
    for time_s, fields, entry in sorted(entries, key=lambda parsed: parsed[0]):
        try:
            names_at_time = changed_names.setdefault(time_s, set())
            if twice := names_at_time & fields.keys():
                raise ParameterError(f"{twice.pop()} changes twice at this time")
            names_at_time.update(fields)
            before, current = current, current.replace(**fields)
            radii_cm = before.pool_radii_cm + current.pool_radii_cm
            if before.pool != current.pool and math.inf in radii_cm:
                raise ParameterError("open water and a pool do not change into each other")
            if any(getattr(before, name) != getattr(current, name) for name in _FIT_FIELDS):
                Flock(current, seed)  # Raises an error if the boats do not fit.
        except ParameterError as error:
            raise ParameterError(
                f"schedule = {short_repr(entry)} is not accepted: {error}"
            ) from error
        # Other parameters restart the random streams; a change of the target alone must not.
        is_target_alone = current == before.replace(target=current.target)
        changes.append((time_s, current.target if is_target_alone else current))
    return changes


def _parse_entry(entry: object) -> tuple[float, dict[str, object]]:
    """Return the time and the fields of an entry of a schedule."""
    reason = "pairs of a time in s, at least 0, and a dictionary of fields"
    match entry:
        # These are no times, but count as real numbers.
        case (bool(), _):
            pass
        case (np.timedelta64(), _):
            pass
        case (Real() as number, Mapping() as fields) if fields and (time_s := float(number)) >= 0.0:
            fixed = {"n_boats", "n_leaders"} & fields.keys()
            if not fixed and time_s <= 1e9:
                return time_s, {str(name): value for name, value in fields.items()}
            reason = f"{fixed.pop()} cannot change during a run" if fixed else reason
    raise ParameterError(f"schedule = {short_repr(entry)} is not accepted: {reason}")


def _is_single_precision(dtype: DTypeLike) -> bool:
    precision = np.dtype(dtype)
    if precision not in PRECISIONS:
        raise ParameterError(f"dtype = {precision} is not accepted: float64 or float32")
    return bool(precision == np.float32)


def _schedule_digest(
    parameters: FlockParameters, changes: Changes, times_s: NDArray[np.float64]
) -> str | None:
    """Return the SHA-256 of the changes of a run and their times; None if nothing changed.

    `parameters` are those at the start, `times_s` the times of the samples.
    """
    current, length_s = parameters, round(times_s[-1] - times_s[0], 9)
    # If several changes have the same time, only the parameters after the last one count.
    parameters_from: dict[float, FlockParameters] = {}
    for time_s, change in changes:
        # A change acts after the sample at its time. The run may have ended before that.
        if time_s < length_s:
            if isinstance(change, FlockParameters):
                current = change
            else:
                current = current.replace(target=change)
            parameters_from[time_s] = current
    before, effective = parameters, []
    for time_s, after in parameters_from.items():
        if after != before:
            effective.append((time_s, after.to_dict()))
        before = after
    if not effective:
        return None
    return hashlib.sha256(json.dumps(effective, sort_keys=True).encode()).hexdigest()


def _start_state(start: Start | None) -> bytes | Mapping[str, object] | None:
    """Return the last sample of a recording, and any other start unchanged."""
    if not isinstance(start, Recording):
        return start
    return start.state_at(start.duration_s if len(start) == 0 else float(start.time_s[-1]))


def _start_digest(start: bytes | Mapping[str, object] | None, flock: Flock) -> str | None:
    """Return the SHA-256 of a snapshot, or of pose, velocity and time; None for a random start."""
    if start is None:
        return None
    if isinstance(start, bytes):
        return hashlib.sha256(start).hexdigest()
    state = (flock.pose, flock.velocity, np.float64(flock.time_s))
    return hashlib.sha256(b"".join(array.tobytes() for array in state)).hexdigest()


def _starting_flock(
    parameters: FlockParameters,
    seed: int,
    start: bytes | Mapping[str, object] | None,
    noise_seed: int | None,
) -> Flock:
    """Return the flock at the start of a run."""
    if noise_seed is not None and not isinstance(start, bytes):
        raise ParameterError(
            f"noise_seed = {short_repr(noise_seed)} is not accepted: it needs a snapshot as start"
        )
    if start is None:
        return Flock(parameters, seed)
    if isinstance(start, Mapping):
        return Flock.from_state(parameters, seed, dict(start))
    if not isinstance(start, bytes):
        raise TypeError(
            "start must be a snapshot (bytes), a dictionary with pose and perhaps velocity and "
            f"time_s, or a recording, not {short_repr(start)}"
        )
    flock = Flock.from_snapshot(start, noise_seed)
    if flock.parameters.replace(target=parameters.target) != parameters:
        raise ParameterError("start is a snapshot of a flock with other parameters")
    if flock.seed != seed:
        raise ParameterError(
            f"seed = {short_repr(seed)} is not accepted: start is a snapshot of seed {flock.seed}"
        )
    flock.set_target(parameters.target)
    return flock
