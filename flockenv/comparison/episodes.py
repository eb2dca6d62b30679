"""Leader policies against each other: seeded episodes, order by number of leaders (figure 12)."""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv._io.arguments import by_name, check_function, items, whole
from flockenv._io.extras import require
from flockenv._io.interrupts import end_if_interrupted
from flockenv.envs.vector import LeadersVectorEnv
from flockenv.errors import ParameterError, shown
from flockenv.parameters import FlockParameters
from flockenv.policies.base import (
    LeaderPolicy,
    action_mode,
    check_action_mode,
    check_pool,
    control_rate,
)
from flockenv.policies.model import ModelPolicy, as_policy
from flockenv.policies.names import EVERY_SUBSTEP
from flockenv.policies.registry import named_policy
from flockenv.runs.executors import in_order
from flockenv.runs.seeds import check_evaluation_seeds
from flockenv.simulation import simulate

if TYPE_CHECKING:
    import pandas as pd

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

_SAID_BY = {
    **dict.fromkeys({each.name for each in fields(FlockParameters)} - {"target"}, "the flock"),
    **dict.fromkeys(("preset", "params"), "the flock"),
    **dict.fromkeys(("observation", "mirror_to_target"), "a policy"),
    "episode_s": "duration_s",
    **dict.fromkeys(("autoreset_mode", "render_mode", "render_size"), "the comparison"),
    **dict.fromkeys(("num_envs", "reward", "reward_horizon_s"), "the comparison"),
}
"""What says options of environments that a comparison does not take."""


def compare_leaders(
    parameters: FlockParameters,
    leaders: Sequence[int],
    policies: Mapping[str, Steering],
    seeds: Sequence[int],
    duration_s: float,
    progress: Callable[[float], None] = lambda flock_seconds: None,
    environment: Mapping[str, Any] | None = None,
    finished: Callable[["pd.DataFrame"], object] = lambda rows: None,
) -> "pd.DataFrame":
    """Run seeded episodes for every policy and number of leaders.

    Flocks with leaders are stepped in `LeadersVectorEnv` with the observation of their policy;
    flocks without run in `simulate`. Seed i gives the same initial placement and the same noise
    whatever the leaders do.

    Parameters
    ----------
    parameters
        Of the flock; its number of leaders is replaced.
    leaders
        Numbers of leaders; 0 is run once, whatever the policies, as the policy `NO_LEADERS`.
    policies
        How leaders steer, by the name in the table, such as ``{"mine": model, "paper's law":
        "paper's law"}``; see `Steering`. A function makes a policy for each number of leaders; all
        else is one object for all of them.
    seeds
        One episode each; of the range ``"evaluation"`` of `flockenv.runs.seeds.POLICY_SEEDS`.
    duration_s
        Length of an episode in s.
    progress
        Called with flock-seconds as they are simulated.
    environment
        Options of the environment that differ from its defaults, such as ``target="alternate"`` or
        ``dropout_rate=0.003``. If there are any, flocks without leaders, the paper's law at every
        substep and a policy for each leader are refused: they run in `simulate`, without options.
    finished
        Called with the rows of each policy and number of leaders, as soon as they are there.

    Returns
    -------
    pandas.DataFrame
        One row per episode: ``policy``, ``leaders``, ``seed``, the `QUANTITIES` and the
        `ORDERING_TIMES`; NaN if an episode has no frame in the analysis window.

    Raises
    ------
    ParameterError
        For parameters, options, names and durations out of range, for options that another
        argument or a policy says, for training seeds and seeds given twice, for policies that steer
        another number of leaders, and for policies of another action mode than that of
        `environment`.
    """
    pandas = require("pandas", "plot")
    check_function(progress, "progress")
    check_function(finished, "finished")
    leaders = [whole(k, "leaders") for k in items(leaders, "leaders")]
    seeds = items(seeds, "seeds")
    check_evaluation_seeds(seeds)
    policies = by_name(policies, "policies")
    environment = by_name(environment or {}, "environment")
    _check_environment(environment)
    flock: Any = parameters
    if not isinstance(flock, FlockParameters):
        raise TypeError(f"parameters must be FlockParameters, not {shown(flock)}")
    if len(set(seeds)) < len(seeds):
        raise ParameterError("seeds holds a seed more than once, which would count twice")
    leaders = list(dict.fromkeys(leaders))
    most = max(leaders, default=0)
    if most >= parameters.n_boats:
        raise ParameterError(
            f"{most} leaders among n_boats = {parameters.n_boats} are not accepted: the order is "
            "measured of normal boats (on the command line --n-leaders and --n-boats)"
        )
    if NO_LEADERS in policies:
        raise ParameterError(
            f"{NO_LEADERS!r} is no name for a policy: it names flocks without leaders"
        )
    if policies and leaders and most == 0:
        raise ParameterError(
            f"leaders = {shown(leaders)} are not accepted with policies: they have nobody to steer"
        )
    parameters.replace(n_leaders=most)
    steers: dict[str, Any] = {NO_LEADERS: None} if 0 in leaders else {}
    for name, policy in policies.items():
        steers[name] = steering(policy, parameters.pool)
    if not any((k == 0) == (name == NO_LEADERS) for name in steers for k in leaders):
        raise ParameterError("nothing to compare: leaders and policies name no flocks")
    for name, policy in steers.items():
        if environment and _is_outside(policy):
            raise ParameterError(
                f"{name!r} runs outside of the environment and cannot have its options "
                f"{', '.join(environment)}"
            )
        if "action_mode" in environment:
            check_action_mode(policy, environment["action_mode"], "in this environment")
        if isinstance(policy, Mapping) and most > 0:  # Refuses what it would refuse later.
            simulate(parameters.replace(n_leaders=most), 0, 0.0, policy=_first(policy, most))
        if isinstance(policy, ModelPolicy):
            for k in (k for k in leaders if k > 0):
                policy.check_leaders(k)
    options = {"target": parameters.target, **environment}
    tables = []
    for name, policy in steers.items():
        for k in (k for k in leaders if (k == 0) == (name == NO_LEADERS)):
            led = parameters.replace(n_leaders=k)
            if _is_outside(policy):
                measured = _simulated(led, policy, seeds, duration_s, progress)
            else:
                # A function makes a policy of its own for each number of leaders.
                fresh = steering(policies[name], parameters.pool)
                measured = run_episodes(led, fresh, seeds, duration_s, progress, options)
            rows = {"policy": name, "leaders": k, "seed": seeds, **measured}
            tables.append(pandas.DataFrame(rows))
            finished(tables[-1])
    runs: pd.DataFrame = pandas.concat(tables, ignore_index=True)
    return runs


def steering(policy: Steering, pool: Any) -> Any:
    """Return a policy, a dictionary with one per leader, or `EVERY_SUBSTEP`.

    Raises what `flockenv.policies.load` raises, also for unknown names.
    """
    if isinstance(policy, Mapping):
        return {leader: steering(each, pool) for leader, each in policy.items()}
    if isinstance(policy, type) or (callable(policy) and not hasattr(policy, "predict")):
        policy = policy()
    if isinstance(policy, str) and policy != EVERY_SUBSTEP:
        policy = named_policy(policy, pool)()
    found: Any = as_policy(policy)
    if not (found is None or isinstance(found, str) or hasattr(found, "predict")):
        raise ParameterError(
            f"policy = {shown(found)} is not accepted: a policy's name or file, an object with "
            "predict, or a function that returns one"
        )
    check_pool(found, pool)
    return found


def _check_environment(environment: Mapping[str, Any]) -> None:
    """Refuse options that would contradict another argument, or that it would overrule."""
    for name, value in environment.items():
        # A range of noises is no parameter of one flock.
        if name in _SAID_BY and not (name == "bw_s" and isinstance(value, tuple | list)):
            raise ParameterError(
                f"{name} = {shown(value)} is not accepted in the environment of a comparison: "
                f"{_SAID_BY[name]} says it"
            )


def _is_outside(policy: Any) -> bool:
    """Return whether what steers runs in `simulate`, which knows no options of environments."""
    return policy is None or isinstance(policy, str | Mapping)


def run_episodes(
    parameters: FlockParameters,
    policy: LeaderPolicy,
    seeds: Sequence[int],
    duration_s: float,
    progress: Callable[[float], None] = lambda flock_seconds: None,
    options: Mapping[str, Any] = MappingProxyType({}),
) -> dict[str, NDArray[np.float64]]:
    """Run one episode per seed with leaders that follow a policy; training seeds are accepted.

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
    check_pool(policy, parameters.pool)
    if "action_mode" in options:
        check_action_mode(policy, options["action_mode"], "in this environment")
    control_hz = options.get("control_hz", control_rate(policy))
    own = getattr(policy, "decision_period_s", None)
    layout = {
        "observation": getattr(policy, "observation", {}),
        "mirror_to_target": getattr(policy, "mirror_to_target", False),
        "control_hz": control_hz,
        "action_mode": action_mode(policy),
        "decision_period_s": options.get("decision_period_s") if own is None else own,
    }
    env = LeadersVectorEnv(
        len(seeds),
        params=parameters,
        episode_s=duration_s,
        autoreset_mode="disabled",
        **{**options, **layout},
    )
    observations, _ = env.reset(seed=list(seeds))
    state: Any = None
    ended = np.zeros(len(seeds), np.bool_)
    infos: dict[str, Any] = {}
    while not ended.all():
        actions, state = policy.predict(observations, state)
        observations, _, _, ended, infos = env.step(actions)
        progress(len(seeds) / env.metadata["render_fps"])
        end_if_interrupted()
    summary = infos.get("episode_summary", {})
    # NaN for episodes whose summary does not have it.
    unknown = np.full(len(seeds), np.nan)
    return {
        name: np.where(summary[f"_{name}"], summary[name], np.nan) if name in summary else unknown
        for name in (*QUANTITIES, *ORDERING_TIMES)
    }


def _first(policies: Mapping[str, Any], leaders: int) -> dict[str, Any]:
    """Return the policies of a flock's leaders: with fewer leaders the first ones."""
    return dict(itertools.islice(policies.items(), leaders))


def _simulated(
    parameters: FlockParameters,
    policy: Any,
    seeds: Sequence[int],
    duration_s: float,
    progress: Callable[[float], None],
) -> dict[str, NDArray[np.float64]]:
    target = parameters.target if isinstance(parameters.target, str) else parameters.target[0]
    is_each = isinstance(policy, Mapping)
    if is_each:
        policy = _first(policy, parameters.n_leaders)

    def run(seed: int) -> list[float]:
        recording = simulate(
            parameters,
            seed,
            duration_s,
            policy=policy,
            dtype=np.float32,
            progress=lambda done: end_if_interrupted(),
        )
        order = recording.analyzed().order
        signed = order.signed_order(target)
        progress(duration_s)
        means = [np.nan] * len(QUANTITIES)
        if len(signed) > 0:
            towards = signed > _core.TOWARDS_TARGET
            means = [order.psi_o.mean(), signed.mean(), towards.mean()]
        times = ORDERING_TIMES.values()
        return means + [recording.order.ordering_time(recording.time_s, each) for each in times]

    # Policies in Python may draw from a generator of their own: one run after another.
    # The first episode of an environment has its seed, which pairs these runs with those there.
    rows = in_order(run, list(seeds), 1 if is_each else None)
    return dict(zip((*QUANTITIES, *ORDERING_TIMES), np.array(rows).T, strict=True))
