"""`Comparison`: the order of flocks by policy and number of leaders, on the same seeds."""

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Self

from flockenv._io.arguments import as_int, by_name, check_function, items
from flockenv._io.extras import require
from flockenv.comparison.episodes import (
    NO_LEADERS,
    Episodes,
    Progress,
    no_progress,
    seeds_of_episodes,
)
from flockenv.errors import ParameterError, short_repr
from flockenv.parameters import FlockParameters
from flockenv.policies.registry import PolicyLike
from flockenv.runs.seeds import check_evaluation_seeds

if TYPE_CHECKING:
    import pandas as pd

Finished = Callable[["pd.DataFrame"], object]
"""Function that takes the rows of a policy and a number of leaders when they are complete."""

_SET_BY = {
    **dict.fromkeys(
        {parameter.name for parameter in fields(FlockParameters)} - {"target"}, "the flock"
    ),
    **dict.fromkeys(("preset", "params"), "the flock"),
    **dict.fromkeys(("observation", "mirror_to_target"), "a policy"),
    "episode_s": "duration_s",
    **dict.fromkeys(("autoreset_mode", "render_mode", "render_size"), "the comparison"),
    **dict.fromkeys(("num_envs", "reward", "reward_horizon_s"), "the comparison"),
}
"""What sets each of the options that `environment` may not hold."""


def nothing_finished(rows: "pd.DataFrame") -> None:
    """Do nothing with finished rows."""


@dataclass(frozen=True)
class Entry:
    """A row of a comparison: a policy, a number of leaders and their episodes."""

    policy: str
    leaders: int
    episodes: Episodes


@dataclass(frozen=True)
class Comparison:
    """A comparison, checked by `parse` before anything runs."""

    entries: Sequence[Entry]

    @classmethod
    def parse(
        cls,
        parameters: FlockParameters,
        leaders: Iterable[int],
        policies: Mapping[str, PolicyLike | Mapping[str, PolicyLike]],
        seeds: Iterable[int],
        duration_s: float,
        environment: Mapping[str, object],
    ) -> Self:
        """Return the comparison that `compare_leaders` describes, or raise its errors."""
        options = _environment(environment)
        seeds = _evaluation_seeds(seeds)
        named_policies = _policies(policies)
        counts = _counts(leaders, parameters, named_policies)
        entries = []
        for name, policy in ({NO_LEADERS: None} | named_policies).items():
            for k in counts:
                # A policy needs leaders, and only `NO_LEADERS` has none.
                if (k == 0) != (name == NO_LEADERS):
                    continue
                flock, steering = parameters.replace(n_leaders=k), policy
                if isinstance(steering, Mapping) and k < max(counts):
                    # With k leaders, the policies of the first k steer.
                    steering = dict(itertools.islice(steering.items(), k))
                episodes = Episodes.parse(flock, steering, seeds, duration_s, options)
                entries.append(Entry(name, k, episodes))
        if not entries:
            raise ParameterError("nothing to compare: leaders and policies name no flocks")
        return cls(tuple(entries))

    def run(self, progress: Progress, finished: Finished) -> "pd.DataFrame":
        """Run all episodes; return what `compare_leaders` returns."""
        pandas = require("pandas", "plot")
        tables = []
        for entry in self.entries:
            columns = entry.episodes.measure(progress)
            names = {"policy": entry.policy, "leaders": entry.leaders, "seed": entry.episodes.seeds}
            tables.append(pandas.DataFrame(names | columns))
            finished(tables[-1])
        runs: pd.DataFrame = pandas.concat(tables, ignore_index=True)
        return runs


def _environment(options: Mapping[str, object]) -> dict[str, object]:
    """Return a copy of the options; refuse those that another argument sets."""
    checked = by_name(options, "environment")
    for name, value in checked.items():
        # A range of noises is accepted: the parameters of a flock hold a single noise.
        is_noise_range = name == "bw_s" and isinstance(value, tuple | list)
        if name in _SET_BY and not is_noise_range:
            raise ParameterError(
                f"{name} = {short_repr(value)} is not accepted in the environment of a comparison: "
                f"{_SET_BY[name]} sets it"
            )
    return checked


def _evaluation_seeds(seeds: Iterable[int]) -> Sequence[int]:
    """Return the seeds; refuse training seeds and repeated ones."""
    checked = seeds_of_episodes(seeds)
    check_evaluation_seeds(checked)
    if len(set(checked)) < len(checked):
        raise ParameterError("seeds holds a seed more than once, which would count twice")
    return checked


def _policies(
    policies: Mapping[str, PolicyLike | Mapping[str, PolicyLike]],
) -> dict[str, PolicyLike | Mapping[str, PolicyLike]]:
    """Return a copy of the policies; refuse one that has the name of flocks without leaders."""
    checked = by_name(policies, "policies")
    if NO_LEADERS in checked:
        raise ParameterError(
            f"{NO_LEADERS!r} is not a name for a policy: it names flocks without leaders"
        )
    return checked


def _counts(
    leaders: Iterable[int], flock: FlockParameters, policies: Mapping[str, object]
) -> list[int]:
    """Return the numbers of leaders, each once; refuse numbers that the flock cannot have."""
    if not isinstance(flock, FlockParameters):
        raise TypeError(f"parameters must be FlockParameters, not {short_repr(flock)}")
    counts = list(dict.fromkeys(as_int(k, "leaders") for k in items(leaders, "leaders")))
    most = max(counts, default=0)
    if most >= flock.n_boats:
        raise ParameterError(
            f"{most} leaders among n_boats = {flock.n_boats} are not accepted: the order is "
            "measured of normal boats (on the command line --n-leaders and --n-boats)"
        )
    if policies and counts and most == 0:
        raise ParameterError(
            f"leaders = {short_repr(leaders)} are not accepted with policies, which would have "
            "nobody to steer"
        )
    return counts


def compare_leaders(
    parameters: FlockParameters,
    leaders: Iterable[int],
    policies: Mapping[str, PolicyLike | Mapping[str, PolicyLike]],
    seeds: Iterable[int],
    duration_s: float,
    progress: Progress = no_progress,
    environment: Mapping[str, object] | None = None,
    finished: Finished = nothing_finished,
) -> "pd.DataFrame":
    """Run seeded episodes for every policy and number of leaders.

    All flocks are stepped in the core's batch of environments, each with the observation of its
    policy. Seed i gives the same initial placement and the same noise whatever the leaders do.

    Parameters
    ----------
    parameters
        Parameters of the flock; its number of leaders is replaced.
    leaders
        Numbers of leaders; 0 is run once, whatever the policies, as the policy `NO_LEADERS`.
    policies
        How leaders steer, by the name in the table, such as ``{"mine": model, "paper's law":
        "paper's law"}``. A value is anything that `flockenv.policies.policy` takes, or a dictionary
        with one policy for each of ``"leader_0"``, ``"leader_1"`` and so on. A function is called
        for each number of leaders; anything else is one object for all of them.
    seeds
        One episode each; from the range ``"evaluation"`` of `flockenv.runs.seeds.POLICY_SEEDS`.
    duration_s
        Length of an episode in s.
    progress
        Called with flock-seconds as they are simulated.
    environment
        Options of the environment that differ from its defaults, such as ``target="alternate"`` or
        ``dropout_rate=0.003``. Flocks without leaders, and those under the paper's law at every
        substep, take only ``target``, ``bw_s`` and ``physics``; other options are refused.
    finished
        Called with the rows of each policy and number of leaders, as soon as they are complete.

    Returns
    -------
    pandas.DataFrame
        One row per episode: ``policy``, ``leaders``, ``seed``, the `QUANTITIES` and the
        `ORDERING_TIMES`; NaN if an episode has no frame in the analysis window.

    Raises
    ------
    ParameterError
        For parameters, options, names and durations that are not accepted, for options that another
        argument or a policy sets, for training seeds, for repeated seeds, and for policies made for
        another number of leaders or another action mode.
    """
    require("pandas", "plot")
    check_function(progress, "progress")
    check_function(finished, "finished")
    comparison = Comparison.parse(
        parameters, leaders, policies, seeds, duration_s, environment or {}
    )
    return comparison.run(progress, finished)
