"""`simulate`: a seeded run from a random start, recorded."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from flockenv import _core
from flockenv.errors import ParameterError, shown
from flockenv.parameters import FlockParameters
from flockenv.policies.base import LeaderPolicy, check_action_mode, decision_rate
from flockenv.policies.model import ModelPolicy, as_policy
from flockenv.policies.registry import named_policy, policy_name
from flockenv.recording import PHASES, PRECISIONS, Recording

__all__ = ["Change", "LeaderPolicy", "recorded", "simulate"]

Change = tuple[float, str | FlockParameters]
"""A time in s from the start of a run, and the target, or a list with one per leader, or the
parameters from then on."""


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
    threads: int = 1,
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
        Where the run starts, and at which time. None: at random, at rest, at 0 s. A snapshot, as
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
        for, policies whose actions are no rudders, boats that do not fit the pool, a start that
        this flock cannot have, rudders that are NaN, and a recording of more than 16 GiB; nothing
        is returned then.
    OSError
        If a policy's file cannot be opened.
    TypeError
        For arguments of the wrong type.
    SolverError
        If the motion left its range of 1e9 (cm, cm/s, rad, rad/s).
    """
    if isinstance(policy, str):
        named = named_policy(policy, parameters.pool)()
        policy = None if isinstance(named, str) else named
    policy = as_policy(policy)
    if policy is not None and not hasattr(policy, "predict"):
        raise ParameterError(
            f"policy = {shown(policy)} is not accepted: None, a policy's name or file, or an "
            "object with predict"
        )
    check_action_mode(policy, "rudder", "in a simulation")
    if isinstance(policy, ModelPolicy) and parameters.n_leaders > 0:
        policy.check_leaders(parameters.n_leaders)
    flock = _core.Flock(parameters, seed) if start is None else _started(parameters, seed, start)
    flock.threads = threads
    return recorded(
        flock,
        parameters,
        duration_s,
        sample_hz,
        policy=policy,
        control_hz=control_hz,
        dtype=dtype,
        contacts=contacts,
        progress=progress,
    )


def _started(
    parameters: FlockParameters, seed: int, start: bytes | Mapping[str, Any]
) -> _core.Flock:
    if not isinstance(start, bytes):
        if not isinstance(start, Mapping):
            raise TypeError(
                "start must be a snapshot (bytes) or a dictionary with pose and perhaps velocity "
                f"and time_s, not {shown(start)}"
            )
        return _core.Flock.from_state(parameters, seed, dict(start))
    flock = _core.Flock.from_snapshot(start)
    if flock.parameters.replace(target=parameters.target) != parameters:
        raise ParameterError("start is a snapshot of a flock with other parameters")
    if flock.seed != seed:
        raise ParameterError(
            f"seed = {shown(seed)} is not accepted: start is a snapshot of {flock.seed}"
        )
    flock.set_target(parameters.target)
    return flock


def recorded(
    flock: _core.Flock,
    parameters: FlockParameters,
    duration_s: float,
    sample_hz: float,
    *,
    changes: Sequence[Change] = (),
    policy: LeaderPolicy | None = None,
    control_hz: float | None = None,
    dtype: DTypeLike = np.float32,
    contacts: bool = False,
    progress: Callable[[float], object] | None = None,
) -> Recording:
    """Record a run from where a flock is; the flock itself stays there.

    Parameters
    ----------
    flock
        Where the run starts.
    parameters
        What the recording says of the run.
    changes
        What changes on the way: at each of these times, after the sample at that time, the target
        or all parameters. With another pool each boat keeps its angle about the center and its
        share of the way between the walls.
    policy
        None for the steering law at every substep.
    duration_s, sample_hz, control_hz, dtype, contacts, progress
        As for `simulate`, as are the errors.
    """
    single = bool(_precision(dtype) == np.float32)
    options = {"single_precision": single, "contacts": contacts}
    control = None if policy is None else _control(policy, flock.parameters, control_hz)
    columns = _core.record(flock, duration_s, sample_hz, options, list(changes), control, progress)
    columns["phase"] = PHASES[columns["phase"]]
    return Recording(
        **columns,
        parameters=parameters,
        seed=flock.seed,
        version=_core.__version__,
        policy=policy_name(policy),
    )


def _control(
    policy: LeaderPolicy, parameters: FlockParameters, control_hz: float | None
) -> dict[str, Any]:
    mirrored = bool(getattr(policy, "mirror_to_target", False))
    targets = parameters.target if isinstance(parameters.target, tuple) else (parameters.target,)
    signs = np.array([-1.0 if mirrored and target == "ccw" else 1.0 for target in targets])
    state = None

    def steer(observation: NDArray[np.float32]) -> NDArray[np.float64]:
        nonlocal state
        actions, state = policy.predict(observation, state)
        return signs * np.clip(np.asarray(actions, np.float64).reshape(-1), -1.0, 1.0)

    return {
        "steer": steer,
        "observation": dict(getattr(policy, "observation", None) or {}),
        "mirror_to_target": mirrored,
        "control_hz": decision_rate(policy) if control_hz is None else control_hz,
    }


def _precision(dtype: DTypeLike) -> np.dtype[Any]:
    precision: np.dtype[Any] = np.dtype(dtype)
    if precision not in PRECISIONS:
        raise ParameterError(f"dtype = {precision} is not accepted: float64 or float32")
    return precision
