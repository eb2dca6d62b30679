"""Suite v1: frozen tasks on which policies of any origin are scored, and compared across versions.

A task never changes: its parameters, its options, its seeds and the signed orders of its two
references stand here and in ``suite_v1.csv``. Another task, or another number in one, is another
suite.
"""

import csv
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.extras import require
from flockenv.comparison.episodes import CONTROL_HZ, run_episodes
from flockenv.errors import ParameterError
from flockenv.parameters import FlockParameters
from flockenv.policies.base import LeaderPolicy, control_rate
from flockenv.policies.model import ModelPolicy, as_policy
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.statistics.intervals import interval, mean_replicates

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "BUDGETS_H",
    "EPISODES",
    "REFERENCES",
    "SUITES",
    "Score",
    "Task",
    "budget_class",
    "run_task",
    "score",
    "scores_table",
    "tasks_named",
]

EPISODES = 512
"""Episodes of each task."""

BUDGETS_H = (100, 1_000, 10_000)
"""Budgets of entries: flock-hours that training and search may have simulated."""

REFERENCES = ("steering law", "tuned damped law")
"""The policies that have score 0 and score 1."""

_MINUTES = 60.0


@dataclass(frozen=True, slots=True)
class Task:
    """One task of the suite.

    Attributes
    ----------
    name : str
        Its id.
    meaning : str
        What it asks of leaders.
    fields : dict
        Of the preset ``simulation``, the parameters that differ.
    options : dict
        Of the environment, the options that differ from its defaults.
    episode_s : float
        Length of an episode in s.
    """

    name: str
    meaning: str
    fields: Mapping[str, Any]
    options: Mapping[str, Any] = field(default_factory=dict)
    episode_s: float = 8 * _MINUTES

    @property
    def parameters(self) -> FlockParameters:
        """The parameters of its flock."""
        return FlockParameters.preset("simulation").replace(**{**_FROZEN, **self.fields})

    @property
    def pool(self) -> str:
        """The pool, which names the tuned and the learned policies that steer in it."""
        return str(self.fields["pool"])

    @property
    def seeds(self) -> range:
        """The seeds of its episodes."""
        return POLICY_SEEDS["evaluation"].seeds(EPISODES)

    @property
    def flock_hours(self) -> float:
        """What its episodes take, in hours of simulated time."""
        return EPISODES * self.episode_s / 3600.0


# Written out, so that no other default changes a task.
_FROZEN: Mapping[str, Any] = {"n_boats": 27, "dt_s": 0.02, "target": "cw"}

_500: Mapping[str, Any] = {"pool": "wide", "bw_s": 0.31, "n_leaders": 3}
_TABLE_1: Mapping[str, Any] = {"pool": "narrow", "bw_s": 0.45, "n_leaders": 3}

_V1 = (
    Task("circulate-wide-k1", "One leader, critical noise.", {**_500, "n_leaders": 1}),
    Task("circulate-wide-k3", "Three leaders, critical noise.", _500),
    Task("circulate-narrow-k1", "One leader, critical noise.", {**_TABLE_1, "n_leaders": 1}),
    Task("circulate-narrow-k3", "Three leaders, critical noise.", _TABLE_1),
    Task(
        "reverse-wide-k3",
        "The target alternates every 4 minutes (figure 7).",
        _500,
        {"target": "alternate"},
        16 * _MINUTES,
    ),
    Task(
        "camera-wide-k3",
        "The camera drops 2 % of the positions, and its picture is one frame late.",
        _500,
        {"dropout_rate": 0.02, "delay_frames": 1},
    ),
    Task(
        "range-wide-k3",
        "The noise of each episode is drawn from half to 1.25 times the critical one.",
        _500,
        {"bw_s": (0.155, 0.3875)},
    ),
    Task("crowd-wide-k3", "50 boats in the same pool.", {**_500, "n_boats": 50}),
    Task(
        "easy-narrow-k1",
        "One leader among nine boats, the flock of `flockenv/Circulate-easy-v0`.",
        {"pool": "narrow", "bw_s": 0.3, "n_boats": 9, "n_leaders": 1},
    ),
)

SUITES: Mapping[str, tuple[Task, ...]] = {"v1": _V1}
"""Tasks by suite."""


def tasks_named(suite: str, names: list[str]) -> list[Task]:
    """Return tasks of a suite, all of them if none is named.

    Raises
    ------
    ParameterError
        For an unknown suite or task.
    """
    if suite not in SUITES:
        raise ParameterError(f"suite = {suite!r} is not accepted: {', '.join(SUITES)}")
    known = {task.name: task for task in SUITES[suite]}
    for name in names:
        if name not in known:
            raise ParameterError(f"task = {name!r} is not accepted: {', '.join(known)}")
    return [task for task in SUITES[suite] if not names or task.name in names]


def budget_class(flock_hours: float) -> int:
    """Return the smallest budget in flock-hours that an entry fits.

    Raises
    ------
    ParameterError
        For flock-hours that are negative, not finite, or above the largest budget.
    """
    for budget in BUDGETS_H:
        if 0.0 <= flock_hours <= budget:
            return budget
    raise ParameterError(
        f"flock_hours = {flock_hours!r} is not accepted: from 0 to {BUDGETS_H[-1]}"
    )


def run_task(
    task: Task,
    make: Callable[[], LeaderPolicy | str],
    progress: Callable[[float], None] = lambda flock_seconds: None,
) -> NDArray[np.float64]:
    """Run a policy in a task.

    Parameters
    ----------
    task
        One of `SUITES`.
    make
        Returns the policy. It observes its own layout, and steers at most 10 times per second.
    progress
        Called with flock-seconds as they are simulated.

    Returns
    -------
    float64 array, shape (EPISODES,)
        Mean signed order of each episode, by seed.

    Raises
    ------
    ParameterError
        For a policy outside of the environment, one that steers more often than the camera takes
        frames, and a model that steers another number of leaders at once.
    """
    policy = as_policy(make())
    if isinstance(policy, str):
        raise ParameterError(
            f"{policy!r} steers outside of the environment: a policy of the suite has predict"
        )
    rate = control_rate(policy)
    if rate > CONTROL_HZ:
        raise ParameterError(
            f"a policy that steers {rate:g} times per second is not accepted: the suite's leaders "
            f"have {CONTROL_HZ:g} frames per second"
        )
    if isinstance(policy, ModelPolicy):
        policy.check_leaders(task.parameters.n_leaders)
    found = run_episodes(
        task.parameters, policy, task.seeds, task.episode_s, progress, _options(task)
    )
    return found["signed_order"]


def _options(task: Task) -> dict[str, Any]:
    return {"target": task.parameters.target, **task.options}


@dataclass(frozen=True, slots=True)
class Score:
    """How a policy did in a task.

    Attributes
    ----------
    signed_order : float
        Mean over the episodes.
    score, low, high : float
        (signed order - that of the paper's law) / (that of the tuned damped law - that of the
        paper's law), with its interval at level `statistics.intervals.CONFIDENCE`: a percentile
        bootstrap of episodes, in which all three policies have the same seeds.
    """

    signed_order: float
    score: float
    low: float
    high: float


def score(task: Task, signed_order: NDArray[np.float64]) -> Score:
    """Return the score of a policy in a task.

    Parameters
    ----------
    task
        One of `SUITES`.
    signed_order
        Shape (EPISODES,), of `run_task`.
    """
    law, tuned = (_references()[task.name, name] for name in REFERENCES)
    # The same draws for both, since they have the same seed and length.
    gain, unit = mean_replicates(signed_order - law), mean_replicates(tuned - law)
    return Score(float(signed_order.mean()), *interval(gain / unit))


@cache
def _references() -> dict[tuple[str, str], NDArray[np.float64]]:
    """Return the signed orders of the references by task and policy, shape (EPISODES,)."""
    file = resources.files("flockenv.comparison").joinpath("suite_v1.csv")
    found: dict[tuple[str, str], list[float]] = {}
    for row in csv.DictReader(file.read_text(encoding="utf-8").splitlines()):
        for name in REFERENCES:
            found.setdefault((row["task"], name), []).append(float(row[name]))
    return {key: np.array(values) for key, values in found.items()}


def scores_table(policy: str, scores: Mapping[str, Score]) -> "pd.DataFrame":
    """Return scores as a table: one row per task, with ``policy`` and ``task`` before `Score`."""
    pandas = require("pandas", "plot")
    rows = [
        {
            "policy": policy,
            "task": task,
            "signed_order": each.signed_order,
            "score": each.score,
            "score_low": each.low,
            "score_high": each.high,
        }
        for task, each in scores.items()
    ]
    table: pd.DataFrame = pandas.DataFrame(rows)
    return table
