"""`simulate`: a seeded run from a random start, recorded."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import DTypeLike

from flockenv import _core
from flockenv.errors import ParameterError
from flockenv.flock import ContactSeries, OrderSeries
from flockenv.parameters import FlockParameters
from flockenv.policies.base import LeaderPolicy, control_rate
from flockenv.policies.model import ModelPolicy, as_policy
from flockenv.policies.registry import EVERY_SUBSTEP, named_policy, policy_name
from flockenv.recording import PHASES, PRECISIONS, Recording

__all__ = ["LeaderPolicy", "columns_of", "sample", "simulate"]

_TICKS_A_SECOND = 1e9


def simulate(
    parameters: FlockParameters,
    seed: int,
    duration_s: float,
    sample_hz: float = 10.0,
    policy: LeaderPolicy | str | None = None,
    *,
    control_hz: float | None = None,
    dtype: DTypeLike = np.float64,
    contacts: bool = False,
    progress: Callable[[float], object] | None = None,
    start: bytes | Mapping[str, Any] | None = None,
) -> Recording:
    """Run a flock and record it: a pure function of its arguments.

    Without a policy of its own the run is one call into the core, without the interpreter lock.

    Parameters
    ----------
    parameters
        The scene.
    seed
        Seed of all random streams, 0 to 2^64 - 1.
    duration_s
        Length of the run in s, from 0 s (one sample: the start) to 1e9 s. The run ends with the
        last sample.
    sample_hz
        Samples per second, taken at 0, 1/sample_hz, 2/sample_hz … Substeps end on samples: rates of
        which 1/dt_s is no multiple change the course of the run within its numerical error.
    policy
        How leaders steer: None or "law" for the steering law, eq. (10), at every substep; the name
        of another policy, such as "learned" or "damped law", or the path of a policy's ``.npz``
        file; or an object whose ``predict`` maps observations (k, size) to rudders (k,), clipped
        to [-1, 1], such as a model of stable-baselines3. It observes the default layout, or that
        of its attributes ``observation`` and ``mirror_to_target``; a model observes what it was
        trained on.
    control_hz
        Control steps per second of a policy; None: as many as a model was trained with, where its
        observation space says so, and otherwise 10.
    dtype
        float64, or float32 for half the size, which rounds the stored pose and velocity but not
        the run.
    contacts
        Whether contacts and their forces are recorded too: 28 bytes per contact.
    progress
        Called now and then with the flock-seconds simulated since; what it raises ends the run.
    start
        Where the run begins, and at which time. None: at random, at rest, at 0 s. A snapshot, as
        bytes of `Flock.snapshot`, of a flock with these parameters (the target aside) and this
        seed: under the law the run continues with the same bits. A dictionary with ``pose`` (n, 3)
        and, if need be, ``velocity`` (n, 3), ``time_s`` and ``allow_overlap``, as in
        `Flock.set_state`.

    Returns
    -------
    Recording
        floor(duration_s · sample_hz) + 1 samples.

    Raises
    ------
    ParameterError
        For arguments out of range, unknown names of policies and pools that a policy is not made
        for, boats that do not fit the pool, a start that this flock cannot have, rudders that are
        NaN, and a recording of more than 16 GiB; nothing is returned then.
    OSError
        If a policy's file cannot be opened.
    TypeError
        For arguments of the wrong type.
    SolverError
        If the motion left its range of 1e9 (cm, cm/s, rad, rad/s).
    """
    precision = _precision(dtype)
    begun = None if start is None else _started(parameters, seed, start)
    if isinstance(policy, str):
        policy = named_policy(policy, parameters.pool)()
    policy = as_policy(policy)
    if policy is None or policy == EVERY_SUBSTEP:
        kept = {"single_precision": bool(precision == np.float32), "contacts": contacts}
        columns = _core.record(parameters, seed, duration_s, sample_hz, kept, progress, begun)
        columns["phase"] = PHASES[columns["phase"]]
    elif hasattr(policy, "predict"):
        if isinstance(policy, ModelPolicy) and parameters.n_leaders > 0:
            policy.check_leaders(parameters.n_leaders)
        control_hz = control_rate(policy) if control_hz is None else control_hz
        _check_rates(duration_s, sample_hz, control_hz)
        steps = _reported(_events(duration_s, sample_hz, control_hz), progress)
        flock = begun or _core.Flock(parameters, seed)
        columns = _steered(flock, steps, policy, precision, contacts)
    else:
        raise ParameterError(
            f"policy = {policy!r} is not accepted: None, a policy's name or file, or an object "
            "with predict"
        )
    return Recording(
        **columns,
        parameters=parameters,
        seed=int(seed),
        version=_core.__version__,
        policy=policy_name(policy),
    )


def _started(
    parameters: FlockParameters, seed: int, start: bytes | Mapping[str, Any]
) -> _core.Flock:
    if not isinstance(start, bytes):
        if not isinstance(start, Mapping):
            raise TypeError(f"start must be a snapshot or a dictionary, not {start!r}")
        return _core.Flock.from_state(parameters, seed, dict(start))
    flock = _core.Flock.from_snapshot(start)
    if flock.parameters.replace(target=parameters.target) != parameters:
        raise ParameterError("start is a snapshot of a flock with other parameters")
    if flock.seed != seed:
        raise ParameterError(
            f"seed = {seed!r} is not accepted: start is a snapshot of {flock.seed}"
        )
    flock.set_target(parameters.target)
    return flock


def _check_rates(duration_s: float, sample_hz: float, control_hz: float) -> None:
    for name, rate in (("sample_hz", sample_hz), ("control_hz", control_hz)):
        if not 0.0 < rate <= 1e6:
            raise ParameterError(
                f"{name} = {rate!r} is not accepted: a positive rate of at most 1e6"
            )
    if not 0.0 <= duration_s * max(sample_hz, control_hz) <= 1e8:
        raise ParameterError(
            f"duration_s = {duration_s!r} is not accepted: from 0 s to 1e8 samples or control steps"
        )


def _steered(
    flock: _core.Flock,
    steps: Iterable[tuple[int, bool, bool]],
    policy: LeaderPolicy,
    precision: np.dtype[Any],
    contacts: bool,
) -> dict[str, Any]:
    parameters = flock.parameters
    mirrored = getattr(policy, "mirror_to_target", False)
    sign = -1.0 if mirrored and parameters.target == "ccw" else 1.0
    layout = getattr(policy, "observation", None)
    rudder, state = np.zeros(parameters.n_leaders), None
    samples, touching = [], []
    now = 0
    for tick, is_sample, is_control in steps:
        flock.advance((tick - now) / _TICKS_A_SECOND, rudder)
        now = tick
        if is_sample:
            samples.append(sample(flock, precision))
            if contacts:
                touching.append(flock.contacts())
        if is_control and parameters.n_leaders > 0:
            seen = _core.observe(flock, dict(layout or {}), mirrored, rudder)
            actions, state = policy.predict(seen, state)
            rudder = sign * np.clip(np.asarray(actions, np.float64).reshape(-1), -1.0, 1.0)
    series = ContactSeries.of(touching) if contacts else None
    return {**columns_of(samples), "contacts": series}


def _events(
    duration_s: float, sample_hz: float, control_hz: float
) -> Iterator[tuple[int, bool, bool]]:
    """Yield times, in ticks, at which something is sampled or steered, in order."""
    last = math.floor(duration_s * sample_hz * (1 + 1e-12)) / sample_hz

    def ticks(rate: float) -> set[int]:
        count = math.floor(last * rate * (1 + 1e-12)) + 1
        return {round(place / rate * _TICKS_A_SECOND) for place in range(count)}

    sampled, steered = ticks(sample_hz), ticks(control_hz)
    for tick in sorted(sampled | steered):
        yield tick, tick in sampled, tick in steered


def _reported(
    steps: Iterable[tuple[int, bool, bool]], progress: Callable[[float], object] | None
) -> Iterator[tuple[int, bool, bool]]:
    """Pass steps on, and report every 10 s of them."""
    reported = 0
    for step in steps:
        if progress is not None and step[0] - reported >= 10 * _TICKS_A_SECOND:
            progress((step[0] - reported) / _TICKS_A_SECOND)
            reported = step[0]
        yield step


def sample(flock: _core.Flock, precision: np.dtype[Any]) -> dict[str, Any]:
    """Return one sample of a `Recording` by field, its order parameters as a list under "order"."""
    has_normal_boats = flock.parameters.n_leaders < flock.parameters.n_boats
    order = flock.order_parameters() if has_normal_boats else None
    names = OrderSeries.__dataclass_fields__
    return {
        "time_s": flock.time_s,
        "phase": flock.phase,
        "in_analysis_window": flock.in_analysis_window,
        "pose": flock.pose.astype(precision),
        "velocity": flock.velocity.astype(precision),
        "order": [getattr(order, name) if order else math.nan for name in names],
    }


def columns_of(samples: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return samples as the arrays of a `Recording`, by field."""
    columns = {name: np.array([each[name] for each in samples]) for name in samples[0]}
    columns["phase"] = columns["phase"].astype(PHASES.dtype)
    orders = columns.pop("order").T
    return {**columns, "order": OrderSeries(*orders)}


def _precision(dtype: DTypeLike) -> np.dtype[Any]:
    precision: np.dtype[Any] = np.dtype(dtype)
    if precision not in PRECISIONS:
        raise ParameterError(f"dtype = {precision} is not accepted: float64 or float32")
    return precision
