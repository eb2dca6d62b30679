"""Where a search steers its candidates: scenarios, their environments, and the scores in them."""

import argparse
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from policy_forms import Form

import flockenv
from flockenv.cli.parameters import changed_fields
from flockenv.errors import refuse_unknown
from flockenv.runs.executors import cores, named

POOLS = ("wide", "narrow")
TARGETS = ("random", "alternate")
LIBERAL_STEPS = {"dt_s": 0.1, "relinearizations": 1}


def noise(text: str) -> float | tuple[float, float]:
    """Return noise in units of the critical one: a number, or a range such as 0.5..1.25.

    Raises
    ------
    ValueError
        For anything else.
    """
    numbers = [float(part) for part in text.split("..")]
    if len(numbers) > 2 or not np.isfinite(numbers).all() or numbers != sorted(numbers):
        raise ValueError(text)
    return numbers[0] if len(numbers) == 1 else (numbers[0], numbers[1])


def boats(text: str) -> int:
    """Return a number of boats, at least 1."""
    if not text.isdecimal() or int(text) < 1:
        raise ValueError(text)
    return int(text)


def _one_of(*words: str) -> Callable[[str], str]:
    def found(text: str) -> str:
        if text not in words:
            raise ValueError(text)
        return text

    return found


def _seconds(text: str) -> float:
    if not 0.0 < float(text) < np.inf:
        raise ValueError(text)
    return float(text)


#: How a scenario's entries are read, and what messages say that they are.
_READ: dict[str, tuple[Callable[[str], Any], str]] = {
    "pool": (_one_of(*POOLS), f"one of {', '.join(POOLS)}"),
    "boats": (boats, "a whole number of at least 1"),
    "leaders": (boats, "a whole number of at least 1"),
    "noise": (noise, "a number, or a range such as 0.5..1.25"),
    "target": (_one_of(*TARGETS), f"one of {', '.join(TARGETS)}"),
    "episode-s": (_seconds, "a positive time in s"),
}


@dataclass(frozen=True)
class Scenario:
    """Where a generation steers: each field is an option of the search."""

    pool: str
    boats: int
    leaders: int
    noise: float | tuple[float, float]
    target: str
    episode_s: float

    def __str__(self) -> str:
        bounds = self.noise if isinstance(self.noise, tuple) else (self.noise,)
        words = "..".join(f"{each:g}" for each in bounds)
        return (
            f"pool={self.pool},boats={self.boats},leaders={self.leaders},noise={words},"
            f"target={self.target},episode-s={self.episode_s:g}"
        )


def changes_of(text: str) -> dict[str, Any]:
    """Return the fields of a scenario that a text such as pool=narrow,leaders=1 sets.

    Raises
    ------
    ParameterError
        For unknown names, names that stand twice, and values that are not accepted.
    """
    found: dict[str, Any] = {}
    for part in text.split(","):
        name, separator, value = part.partition("=")
        if not separator:
            raise flockenv.ParameterError(f"--scenario {text}: {part!r} is no NAME=VALUE")
        refuse_unknown((name,), _READ, f"entry of --scenario {text}")
        read, accepted = _READ[name]
        field = name.replace("-", "_")
        if field in found:
            raise flockenv.ParameterError(f"--scenario {text} has {name} twice")
        try:
            found[field] = read(value)
        except ValueError as error:
            raise flockenv.ParameterError(
                f"--scenario {text}: {name} = {value!r} is not accepted: {accepted}"
            ) from error
    return found


def scenarios_of(options: argparse.Namespace) -> list[Scenario]:
    """Return the scenarios that generations get in turn.

    Each number of `--leaders` has every `--scenario` once; entries that a scenario does not have
    are those of the options.
    """
    names = {each.name for each in fields(Scenario)} - {"leaders"}
    base = {name: getattr(options, name) for name in names}
    changes = [changes_of(text) for text in options.scenario] or [{}]
    return [
        Scenario(**{**base, "leaders": leaders, **each})
        for leaders in options.leaders
        for each in changes
    ]


def flock_parameters(options: argparse.Namespace, scenario: Scenario) -> flockenv.FlockParameters:
    """Where a generation steers; --set takes what no other option rules."""
    critical = flockenv.FlockParameters.critical_bw_s("simulation", scenario.pool)
    largest = scenario.noise[1] if isinstance(scenario.noise, tuple) else scenario.noise
    ruled = {
        "pool": ("--pool", scenario.pool),
        "n_boats": ("--boats", scenario.boats),
        "n_leaders": ("--leaders", scenario.leaders),
        "bw_s": ("--noise", largest * critical),
        # Mirrored, both directions are this one.
        "target": ("the search itself", "cw"),
    }
    if options.liberal_steps:
        ruled |= {name: ("--liberal-steps", value) for name, value in LIBERAL_STEPS.items()}
    changes = changed_fields(options.set)
    for name in changes:
        if name in ruled:
            ruler = ruled[name][0]
            raise flockenv.ParameterError(f"--set {name} is not accepted: {ruler} rules it")
    values = {name: value for name, (_, value) in ruled.items()} | changes
    try:
        return flockenv.FlockParameters.preset("simulation").replace(**values)
    except TypeError as error:
        raise flockenv.ParameterError(f"--set: {error}") from error


def environment(
    options: argparse.Namespace,
    flocks: int,
    scenario: Scenario,
    blocks: dict[str, Any] | None = None,
) -> flockenv.LeadersVectorEnv:
    """Return flocks of a scenario, whose leaders observe these blocks."""
    drawn: dict[str, Any] = {}
    if isinstance(scenario.noise, tuple):
        critical = flockenv.FlockParameters.critical_bw_s("simulation", scenario.pool)
        drawn["bw_s"] = tuple(critical * each for each in scenario.noise)
    return flockenv.LeadersVectorEnv(
        flocks,
        autoreset_mode="disabled",
        params=flock_parameters(options, scenario),
        target=scenario.target,
        mirror_to_target=True,
        control_hz=options.control_hz,
        episode_s=scenario.episode_s,
        reward={options.reward: 1.0},
        observation=blocks or {},
        **drawn,
    )


def steps_of(options: argparse.Namespace, scenario: Scenario) -> int:
    """Return the control steps of an episode."""
    return round(scenario.episode_s * options.control_hz)


class Turns:
    """The scenarios that generations get in turn, and what these take."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.options = options
        self.scenarios = scenarios_of(options)
        self.flocks = 2 * options.pairs * options.flocks

    def of(self, generation: int) -> Scenario:
        """Return the scenario of a generation."""
        return self.scenarios[generation % len(self.scenarios)]

    def samples(self, generations: int) -> int:
        """Return the control steps of leaders in the first generations."""
        turns = map(self.of, range(generations))
        return self.flocks * sum(each.leaders * steps_of(self.options, each) for each in turns)

    def flock_hours(self, generations: int) -> float:
        """Return the simulated time of all flocks in the first generations."""
        return self.flocks * sum(each.episode_s for each in map(self.of, range(generations))) / 3600

    @property
    def most(self) -> int | None:
        """The largest number of generations, if one is given or there is no other budget."""
        if self.options.generations is None and self.options.flock_hours is None:
            return 50
        number: int | None = self.options.generations
        return number

    def are_over(self, generation: int) -> bool:
        """Return whether generations or flock-hours are used up."""
        if self.most is not None and generation >= self.most:
            return True
        hours = self.options.flock_hours
        return hours is not None and self.flock_hours(generation) >= hours


def unscored_steps(options: argparse.Namespace, scenario: Scenario) -> int:
    """Return the control steps before rewards count: until the first switch of the target."""
    return steps_of(options, scenario) // 4 if scenario.target == "alternate" else 0


def mean_rewards(
    env: flockenv.LeadersVectorEnv,
    seeds: list[int],
    steer: Callable[[np.ndarray], np.ndarray],
    unscored: int = 0,
) -> tuple[np.ndarray, np.ndarray]:
    """Mean reward after the first control steps, and mean signed order, of one episode a flock."""
    observations, _ = env.reset(seed=seeds)
    total, steps, ended = np.zeros(env.num_envs), 0, np.zeros(env.num_envs, bool)
    while not ended.all():
        observations, rewards, _, ended, infos = env.step(steer(observations))
        steps += 1
        if steps > unscored:
            total += rewards
    return total / (steps - unscored), infos["episode_summary"]["signed_order"]


def scores(
    env: flockenv.LeadersVectorEnv,
    shape: Form,
    candidates: np.ndarray,
    seeds: list[int],
    unscored: int = 0,
) -> np.ndarray:
    """Mean reward of each candidate; all of them steer the episodes of the same seeds."""
    count, rudders = len(candidates), shape.steering(candidates)

    def steer(observations: np.ndarray) -> np.ndarray:
        rows = observations.reshape(count, len(seeds) * env.num_leaders, -1)
        return rudders(rows).reshape(env.num_envs, env.num_leaders)

    rewards, _ = mean_rewards(env, seeds * count, steer, unscored)
    return rewards.reshape(count, len(seeds)).mean(axis=1)


@dataclass(frozen=True)
class Part:
    """Some candidates of a generation: all that a worker needs to score them."""

    options: argparse.Namespace
    scenario: Scenario
    shape: Form
    candidates: np.ndarray
    seeds: list[int]


def part_scores(part: Part) -> np.ndarray:
    """Return the scores of some candidates, in any thread or process."""
    flocks = len(part.candidates) * len(part.seeds)
    env = environment(part.options, flocks, part.scenario, part.shape.blocks)
    unscored = unscored_steps(part.options, part.scenario)
    return scores(env, part.shape, part.candidates, part.seeds, unscored)


def scores_on_engine(whole: Part) -> np.ndarray:
    """Return the scores of all candidates, computed in parts where `--engine` says."""
    workers = whole.options.workers or cores()
    shares = np.array_split(whole.candidates, min(len(whole.candidates), workers))
    parts = [replace(whole, candidates=share) for share in shares]
    found = dict(named(whole.options.engine)(part_scores, parts, workers))
    return np.concatenate([found[place] for place in range(len(parts))])
