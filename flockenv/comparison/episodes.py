"""Seeded episodes of flocks that policies lead, and their measured quantities (figure 12)."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv._io.arguments import as_int, by_name, check_function, items
from flockenv._io.interrupts import end_if_interrupted
from flockenv.envs.batch import LeaderBatch
from flockenv.envs.options import EnvOptions
from flockenv.errors import ParameterError, short_repr
from flockenv.flock import STEP_STATISTICS
from flockenv.parameters import FlockParameters
from flockenv.policies.base import CONTROL_HZ, Policy
from flockenv.policies.leaders import Leaders
from flockenv.policies.registry import PolicyLike

DecisionFunction = Callable[[NDArray[np.float32]], NDArray[np.float64] | None]
"""Function from the observations of all leaders to their actions; None: the paper's law steers."""

Progress = Callable[[float], object]
"""Function that takes the flock-seconds simulated since its last call."""

NO_LEADERS = "no leaders"
"""Name of runs without leaders in the column ``policy``."""

QUANTITIES = ("psi_o", "signed_order", "share_towards_target")
"""Compared columns: mean Ψ_o and mean signed order of the normal boats, and the fraction of the
time in which the signed order exceeds 0.5; all over the frames in the analysis window after the
first tenth."""

ORDERING_TIMES = dict(
    zip(("ordering_time_s", "ordering_time_wide_s"), _core.ORDERED_WITHIN, strict=True)
)
"""Ordering times (eq. 7) with the angle as printed and a wider one; infinite if a flock did not
order."""

_FLOCK_OPTIONS = ("target", "bw_s", "physics")
"""The only options for flocks in which no policy decides."""


def no_progress(flock_seconds: float) -> None:
    """Show no progress."""


@dataclass(frozen=True)
class Episodes:
    """Episodes of one flock under some leaders, one for each seed; checked by `parse`."""

    flock: EnvOptions
    leaders: Leaders
    n_leaders: int
    seeds: Sequence[int]
    #: Decisions per second of all policies; None: each has its own rate.
    control_hz: float | None = None

    @classmethod
    def parse(
        cls,
        parameters: FlockParameters,
        policy: PolicyLike | Mapping[str, PolicyLike],
        seeds: Iterable[int],
        duration_s: float,
        options: Mapping[str, object],
    ) -> Self:
        """Return the episodes that `run_episodes` describes, or raise its errors."""
        if not isinstance(parameters, FlockParameters):
            raise TypeError(f"parameters must be FlockParameters, not {short_repr(parameters)}")
        k, options = parameters.n_leaders, by_name(options, "options")
        leaders = Leaders.from_policies(policy, parameters)
        settings = {
            "target": parameters.target,
            **options,
            # `EnvOptions` needs at least one leader; `_batch` sets the real number.
            "params": parameters.replace(n_leaders=max(1, k)),
            "episode_s": duration_s,
            **_decision_options(leaders, options),
        }
        seeds, control_hz = seeds_of_episodes(seeds), options.get("control_hz")
        episodes = cls(EnvOptions.parse(settings), leaders, k, seeds, control_hz)
        episodes._batch(1)  # Only for its errors, before anything runs.
        return episodes

    def _batch(self, flocks: int) -> LeaderBatch:
        """Return a batch of this many flocks, each with `n_leaders` leaders."""
        return LeaderBatch(self.flock, [self.n_leaders] * flocks, "disabled")

    def measure(self, progress: Progress = no_progress) -> dict[str, NDArray[Any]]:
        """Run the episodes; return the columns that `run_episodes` returns."""
        count = len(self.seeds)
        batch = self._batch(count)
        batch.core.reset([{"seed": seed} for seed in self.seeds])
        decide, observations = self._decision_function(batch), batch.core.observe()
        ended = np.zeros(count, np.bool_)
        while not ended.all():
            observations, _, ended = batch.core.step(decide(observations))
            progress(count / batch.decisions_hz)
            end_if_interrupted()
        summaries = [batch.core.finished(flock) or {} for flock in range(count)]
        # A summary lacks the values that are unknown.
        return {
            name: np.array([summary.get(name, np.nan) for summary in summaries])
            for name in (*QUANTITIES, *ORDERING_TIMES, *STEP_STATISTICS)
        }

    def _decision_function(self, batch: LeaderBatch) -> DecisionFunction:
        """Return the function that decides in all flocks of a batch."""
        if self.leaders.is_per_leader:
            return self._decision_function_per_leader(batch)
        # The only assignment: one policy for all leaders.
        policy, state = self.leaders.assignments[0].policy.started(), None
        if policy.control_hz is None:
            return lambda observations: None
        leaders = batch.num_flocks * self.n_leaders

        def decide(observations: NDArray[np.float32]) -> NDArray[np.float64]:
            nonlocal state
            rows = observations.reshape(batch.num_flocks, -1)
            actions, state = policy.decide(rows, state, leaders)
            return actions

        return decide

    def _decision_function_per_leader(self, batch: LeaderBatch) -> DecisionFunction:
        """Return the decision function of leaders that differ in policies and observations."""
        core, decisions = batch.core, self.leaders.decisions(self.control_hz)

        def decide(_: NDArray[np.float32]) -> NDArray[np.float64]:
            observations = (core.observe_in(*layout) for layout in decisions.layouts)
            return decisions.rudders(core.target_signs().ravel(), *observations)

        return decide


def _decision_options(leaders: Leaders, options: Mapping[str, object]) -> dict[str, object]:
    """Return the environment's options that the policies need.

    Refuses options that contradict the policies.
    """
    if leaders.is_per_leader:
        if "decision_period_s" in options:
            raise ParameterError(
                "decision_period_s is not accepted with a policy for each leader: each has its own"
            )
        _check_action_mode(leaders, options)
        control_hz = options.get("control_hz")
        return {"control_hz": leaders.decisions().control_hz if control_hz is None else control_hz}
    policy: Policy = leaders.assignments[0].policy
    if policy.control_hz is None:
        if refused := [name for name in options if name not in _FLOCK_OPTIONS]:
            name = policy.name if leaders.assignments[0].leaders else NO_LEADERS
            raise ParameterError(
                f"{name!r} makes no decisions in the environment, which then takes no "
                f"{', '.join(refused)}"
            )
        return {"control_hz": CONTROL_HZ}
    _check_action_mode(leaders, options)
    period_s = policy.decision_period_s
    return {
        "observation": policy.observation,
        "mirror_to_target": policy.mirror_to_target,
        "control_hz": options.get("control_hz", policy.control_hz),
        "action_mode": policy.action_mode,
        "decision_period_s": (options.get("decision_period_s") if period_s is None else period_s),
    }


def _check_action_mode(leaders: Leaders, options: Mapping[str, object]) -> None:
    """Refuse an action mode for which one of the policies is not made."""
    mode = options.get("action_mode")
    if mode is None:
        return
    for assignment in leaders.assignments:
        assignment.policy.check_action_mode(str(mode), "in this environment")


def seeds_of_episodes(seeds: Iterable[int]) -> Sequence[int]:
    """Return the seeds, one for each episode; refuse anything but a sequence of whole numbers."""
    values = items(seeds, "seeds")
    return values if isinstance(values, range) else tuple(as_int(seed, "seed") for seed in values)


def run_episodes(
    parameters: FlockParameters,
    policy: PolicyLike | Mapping[str, PolicyLike],
    seeds: Iterable[int],
    duration_s: float,
    progress: Progress = no_progress,
    options: Mapping[str, object] = MappingProxyType({}),
) -> dict[str, NDArray[Any]]:
    """Run one episode per seed with leaders that follow a policy; training seeds are accepted.

    All flocks, including those without leaders, are stepped together in one batch of the core.

    Parameters
    ----------
    parameters
        Parameters of the flock.
    policy
        How its leaders steer, as in `flockenv.simulate`; None for flocks without leaders.
    seeds, duration_s, progress
        As for `compare_leaders`.
    options
        Further options of the environment. Without ``control_hz`` a policy decides at its own rate:
        a model as in its training, others 10 times per second. Flocks without decisions take only
        ``target``, ``bw_s`` and ``physics``.

    Returns
    -------
    dict
        The `QUANTITIES`, `ORDERING_TIMES` and `flockenv.flock.STEP_STATISTICS` by name, one number
        per episode.
    """
    check_function(progress, "progress")
    return Episodes.parse(parameters, policy, seeds, duration_s, options).measure(progress)
