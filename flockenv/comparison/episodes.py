"""Leader policies against each other: seeded episodes, order by number of leaders (figure 12)."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv._io.extras import require
from flockenv._io.interrupts import end_if_interrupted
from flockenv.comparison.each_leader import EachLeader
from flockenv.errors import ParameterError
from flockenv.parameters import FlockParameters
from flockenv.policies.base import (
    CONTROL_HZ,
    LeaderPolicy,
    action_mode,
    check_action_mode,
    control_rate,
)
from flockenv.policies.model import ModelPolicy, as_policy
from flockenv.policies.registry import EVERY_SUBSTEP, named_policy
from flockenv.runs.executors import in_order
from flockenv.runs.seeds import check_evaluation_seeds
from flockenv.simulation import simulate

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "CONTROL_HZ",
    "NO_LEADERS",
    "ORDERING_TIMES",
    "QUANTITIES",
    "Steering",
    "compare_leaders",
    "run_episodes",
    "steering",
]

Steering = LeaderPolicy | str | Mapping[str, Any] | Callable[[], Any]
"""A policy or a model; its name, or the path of its file; a dictionary of these with one for each
of ``"leader_0"``, ``"leader_1"`` and so on; or a function that returns one of them."""

NO_LEADERS = "no leaders"
"""Name under which runs without leaders are listed."""

QUANTITIES = ("psi_o", "signed_order", "share_towards_target")
"""What is compared: mean Ψ_o and mean signed order of the normal boats, and the part of the time in
which the signed order exceeds 0.5; all over the frames in the analysis window after the first
tenth."""

ORDERING_TIMES = dict(
    zip(("ordering_time_s", "ordering_time_wide_s"), _core.ORDERED_WITHIN, strict=True)
)
"""Ordering times (eq. 7) with the angle as printed and a wider one; infinite where a flock did
not order."""


def compare_leaders(
    parameters: FlockParameters,
    leaders: Sequence[int],
    policies: Mapping[str, Steering],
    seeds: Sequence[int],
    duration_s: float,
    progress: Callable[[float], None] = lambda flock_seconds: None,
    environment: Mapping[str, Any] | None = None,
) -> "pd.DataFrame":
    """Run seeded episodes for every policy and number of leaders.

    Flocks with leaders are stepped through the Gymnasium vector environment with the observation
    of their policy; flocks without run in `simulate`. Seed i gives the same initial placement and
    the same noise whatever the leaders do.

    Parameters
    ----------
    parameters
        Of the flock; its number of leaders is replaced.
    leaders
        Numbers of leaders; 0 is run once, whatever the policies.
    policies
        How leaders steer, by the name to list it under, such as
        ``{"mine": model, "paper's law": "paper's law"}``; see `Steering`. A function makes a policy
        for each number of leaders; all else is one object for all of them.
    seeds
        One episode each; of the range ``"evaluation"`` of `flockenv.runs.seeds.POLICY_SEEDS`.
    duration_s
        Length of an episode in s.
    progress
        Called with flock-seconds as they are simulated.
    environment
        Options of the environment that differ from its defaults, such as ``target="alternate"`` or
        ``dropout_rate=0.003``. What runs in `simulate` has none of them and is refused then.

    Returns
    -------
    pandas.DataFrame
        One row per episode: ``policy``, ``leaders``, ``seed``, the `QUANTITIES` and the
        `ORDERING_TIMES`; NaN where an episode has no frame in the analysis window.

    Raises
    ------
    ParameterError
        For parameters, options, names and durations out of range, for training seeds, for policies
        that steer another number of leaders, and for policies of another action mode than that
        of `environment`.
    """
    pandas = require("pandas", "plot")
    check_evaluation_seeds(seeds)
    _check_leaders(parameters, leaders)
    for name, policy in policies.items():
        found = steering(policy, parameters.pool)
        _check_policy(name, found, [k for k in leaders if k > 0], environment or {})
    if environment and 0 in leaders:
        raise _outside(NO_LEADERS, environment)
    options = {"target": parameters.target, **(environment or {})}
    parts = []
    if 0 in leaders:
        alone = parameters.replace(n_leaders=0)
        parts.append((NO_LEADERS, 0, _simulated(alone, seeds, duration_s, progress)))
    for name, policy in policies.items():
        for k in (k for k in leaders if k > 0):
            led, found = parameters.replace(n_leaders=k), steering(policy, parameters.pool)
            if isinstance(found, str):
                measured = _simulated(led, seeds, duration_s, progress)
            else:
                measured = run_episodes(led, found, seeds, duration_s, progress, options)
            parts.append((name, k, measured))
    tables = [
        pandas.DataFrame({"policy": name, "leaders": k, "seed": seeds, **measured})
        for name, k, measured in parts
    ]
    runs: pd.DataFrame = pandas.concat(tables, ignore_index=True)
    return runs


def steering(policy: Steering, pool: Any) -> Any:
    """Return what steers: a policy, or `EVERY_SUBSTEP`.

    Raises
    ------
    ParameterError
        For unknown names, files that are no policy, pools that a policy is not made for, and a
        dictionary whose policies observe or act in different ways.
    OSError
        If a file cannot be opened.
    """
    if isinstance(policy, type) or (callable(policy) and not hasattr(policy, "predict")):
        policy = policy()
    if isinstance(policy, str) and policy != EVERY_SUBSTEP:
        policy = named_policy(policy, pool)()
    if isinstance(policy, Mapping):
        return EachLeader({leader: steering(each, pool) for leader, each in policy.items()})
    return as_policy(policy)


def _check_policy(
    name: str, policy: Any, leaders: Sequence[int], environment: Mapping[str, Any]
) -> None:
    if isinstance(policy, str):
        if environment:
            raise _outside(name, environment)
        return
    if "action_mode" in environment:
        check_action_mode(policy, environment["action_mode"], "in this environment")
    if isinstance(policy, ModelPolicy | EachLeader):
        for k in leaders:
            policy.check_leaders(k)


def _outside(name: str, environment: Mapping[str, Any]) -> ParameterError:
    return ParameterError(
        f"{name!r} runs outside of the environment, which is not accepted with its options "
        f"{', '.join(environment)}"
    )


def _check_leaders(parameters: FlockParameters, leaders: Sequence[int]) -> None:
    most = max(leaders, default=0)
    if most >= parameters.n_boats:
        raise ParameterError(
            f"{most} leaders among n_boats = {parameters.n_boats} are not accepted: at least one "
            "normal boat, as order is theirs (on the command line fewer `--leaders`, or more boats)"
        )
    parameters.replace(n_leaders=most)


def run_episodes(
    parameters: FlockParameters,
    policy: LeaderPolicy,
    seeds: Sequence[int],
    duration_s: float,
    progress: Callable[[float], None] = lambda flock_seconds: None,
    options: Mapping[str, Any] = MappingProxyType({}),
) -> dict[str, NDArray[np.float64]]:
    """Run one episode a seed with leaders that follow a policy, whatever range the seeds are of.

    Parameters
    ----------
    parameters, policy, seeds, duration_s, progress
        As for `compare_leaders`, for one policy and number of leaders.
    options
        Further options of the environment. Without ``control_hz`` a policy steers as often as it is
        made for: 10 times per second, and a model as in its training.

    Returns
    -------
    dict
        The `QUANTITIES` and `ORDERING_TIMES` by name, one number per episode.
    """
    policy = as_policy(policy)
    control_hz = options.get("control_hz", control_rate(policy))
    layout = {
        "observation": getattr(policy, "observation", {}),
        "mirror_to_target": getattr(policy, "mirror_to_target", False),
        "control_hz": control_hz,
        **_decisions(policy, options),
    }
    env = _environment(parameters, len(seeds), duration_s, {**options, **layout})
    observations, _ = env.reset(seed=list(seeds))
    state, ended = None, np.zeros(len(seeds), np.bool_)
    infos: dict[str, Any] = {}
    while not ended.all():
        actions, state = policy.predict(observations, state)
        observations, _, _, ended, infos = env.step(actions)
        progress(len(seeds) / env.metadata["render_fps"])
        end_if_interrupted()
    summary = infos.get("episode_summary", {})
    names = (*QUANTITIES, *ORDERING_TIMES)
    return {name: _told(summary, name, len(seeds)) for name in names}


def _decisions(policy: LeaderPolicy, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options by which actions are read, those of the policy; others are refused."""
    if "action_mode" in options:
        check_action_mode(policy, options["action_mode"], "in this environment")
    own = getattr(policy, "decision_period_s", None)
    period = own if own is not None else options.get("decision_period_s")
    return {"action_mode": action_mode(policy), "decision_period_s": period}


def _told(summary: Mapping[str, Any], name: str, episodes: int) -> NDArray[np.float64]:
    """Return a number of each episode's summary, NaN for episodes that do not have it."""
    if name not in summary:
        return np.full(episodes, np.nan)
    return np.where(summary[f"_{name}"], summary[name], np.nan)


def _environment(
    parameters: FlockParameters, num_envs: int, duration_s: float, options: Mapping[str, Any]
) -> Any:
    return gymnasium.make_vec(
        "flockenv/Leaders-v0",
        num_envs=num_envs,
        vectorization_mode="vector_entry_point",
        params=parameters,
        episode_s=duration_s,
        autoreset_mode="disabled",
        **options,
    )


def _simulated(
    parameters: FlockParameters,
    seeds: Sequence[int],
    duration_s: float,
    progress: Callable[[float], None],
) -> dict[str, NDArray[np.float64]]:
    target = parameters.target if isinstance(parameters.target, str) else parameters.target[0]
    # The environment derives a flock's seed from its own, which pairs the runs.
    some = parameters.replace(n_leaders=max(1, parameters.n_leaders))
    env = _environment(some, len(seeds), duration_s, {})
    _, infos = env.reset(seed=list(seeds))
    flock_seeds = [int(seed) for seed in infos["flock_seed"]]

    def run(seed: int) -> list[float]:
        recording = simulate(
            parameters,
            seed,
            duration_s,
            CONTROL_HZ,
            dtype=np.float32,
            progress=lambda done: end_if_interrupted(),
        )
        order = recording.analyzed().order
        signed = order.signed_order(target)
        progress(duration_s)
        ordering = [
            recording.order.ordering_time(recording.time_s, within)
            for within in ORDERING_TIMES.values()
        ]
        if len(signed) == 0:
            return [np.nan] * len(QUANTITIES) + ordering
        return [
            order.psi_o.mean(),
            signed.mean(),
            (signed > _core.TOWARDS_TARGET).mean(),
            *ordering,
        ]

    means = np.array(in_order(run, flock_seeds))
    return dict(zip((*QUANTITIES, *ORDERING_TIMES), means.T, strict=True))
