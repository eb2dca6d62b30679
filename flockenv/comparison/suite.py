"""Suite v2: six frozen tasks on which policies of any origin are scored against the tuned law.

Another task, or another number in one, is another suite. The seeds follow from the name of the
release, so that a later release scores all entries again, on flocks that none of them has met.
"""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import tomli_w
from numpy.typing import NDArray

from flockenv._core import __version__
from flockenv._io.atomic_write import atomic_write, write_text
from flockenv._io.extras import require
from flockenv.comparison.case import Case
from flockenv.comparison.report import ComparisonReport
from flockenv.errors import ParameterError, refuse_unknown, shown
from flockenv.parameters import FlockParameters
from flockenv.runs.seeds import release_seeds
from flockenv.statistics import (
    bootstrap_interval,
    interquartile_mean,
    mean_interval,
    probability_of_improvement,
)

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "BUDGETS_H",
    "EPISODES",
    "REFERENCE",
    "SUITE",
    "TASKS",
    "Aggregate",
    "aggregate",
    "budget_class",
    "scores_table",
    "tasks_named",
    "write_entry",
]

SUITE = "v2"
"""Name of the suite."""

EPISODES = 256
"""Episodes of each task."""

BUDGETS_H = (100, 1_000, 10_000)
"""Classes of entries: flock-hours that training and search may have simulated."""

REFERENCE = "tuned law"
"""The policy from which scores are differences."""

_SEEDS = release_seeds("v0.1.0", EPISODES)

# Written out, so that no other default changes a task.
_FLOCK = FlockParameters.preset("simulation").replace(
    n_boats=27, pool="wide", bw_s=0.31, dt_s=0.02, target="cw"
)


def _task(name: str, meaning: str, leaders: int, **options: Any) -> Case:
    """Return a task with leaders in the flock of the suite; options are those of `Case`."""
    parameters = _FLOCK.replace(n_leaders=leaders)
    return Case(
        name=name,
        meaning=meaning,
        parameters=parameters,
        leaders=(leaders,),
        seeds=_SEEDS,
        **options,
    )


TASKS: tuple[Case, ...] = (
    _task("one-leader", "One leader at the critical noise.", 1),
    _task("three-leaders", "Three leaders at the critical noise.", 3),
    _task(
        "reversal",
        "The target alternates every 4 minutes (figure 7).",
        3,
        environment={"target": "alternate"},
        episode_s=960.0,
    ),
    _task(
        "camera",
        "The camera drops 2 % of the positions, and its picture is one frame late.",
        3,
        environment={"dropout_rate": 0.02, "delay_frames": 1},
    ),
    _task(
        "noises",
        "The noise of each episode is drawn from half to 1.25 times the critical one.",
        3,
        environment={"bw_s": (0.155, 0.3875)},
    ),
    _task(
        "misinformed",
        "Leader 1 is told the wrong direction; the order counts towards that of leader 0.",
        2,
        targets=(("cw", "ccw"), ("ccw", "cw")),
    ),
)
"""The tasks."""


def tasks_named(suite: str, names: Sequence[str] = ()) -> list[Case]:
    """Return tasks of a suite, all of them if none is named.

    Raises
    ------
    ParameterError
        For an unknown suite or task.
    """
    if suite != SUITE:
        raise ParameterError(f"suite = {shown(suite)} is not accepted: there is {SUITE}")
    refuse_unknown(names, [task.name for task in TASKS], f"task of suite {SUITE}")
    return [task for task in TASKS if not names or task.name in names]


def budget_class(flock_hours: float | None) -> int:
    """Return the smallest class, in flock-hours, that an entry fits.

    Raises
    ------
    ParameterError
        Without flock-hours, and for those that are negative, not finite, or above the largest
        class.
    """
    if flock_hours is None:
        raise ParameterError(
            "flock_hours are missing: an entry says how many hours of simulated time its training "
            "and the search of its settings took together (on the command line --flock-hours)"
        )
    for budget in BUDGETS_H:
        if 0.0 <= flock_hours <= budget:
            return budget
    raise ParameterError(
        f"flock_hours = {shown(flock_hours)} is not accepted: from 0 to {BUDGETS_H[-1]}"
    )


@dataclass(frozen=True, slots=True)
class Aggregate:
    """What a policy reached over several tasks, each as value, lower and upper end.

    Attributes
    ----------
    interquartile_mean : tuple of float
        Of the differences of signed order from `REFERENCE`, over the episodes of all tasks.
    improvement : tuple of float
        Probability that an episode has a higher signed order than with `REFERENCE`, mean over the
        tasks.
    """

    interquartile_mean: tuple[float, float, float]
    improvement: tuple[float, float, float]


def aggregate(differences: Sequence[NDArray[np.float64]]) -> Aggregate:
    """Return what differences from `REFERENCE` say together, one array of episodes per task.

    The intervals are BCa bootstraps in which episodes are drawn within each task (Agarwal et al.
    2021 have runs in the place of episodes).
    """
    found = [
        bootstrap_interval(differences, statistic, paired=False)
        for statistic in (interquartile_mean, probability_of_improvement)
    ]
    return Aggregate(*found)


def scores_table(result: ComparisonReport) -> "pd.DataFrame":
    """Return the scores of every policy but `REFERENCE`.

    Returns
    -------
    pandas.DataFrame
        For each policy one row per task with ``policy``, ``task``, ``signed_order`` (its mean) and
        ``score``, ``score_low`` and ``score_high``, the difference from `REFERENCE`; and for two
        tasks or more a row ``interquartile mean`` and a row ``probability of improvement``.
    """
    orders = result.runs.pivot_table(
        index=["case", "seed"], columns="policy", values="signed_order", sort=False
    )
    rows: list[tuple[Any, ...]] = []
    for policy in (name for name in orders if name != REFERENCE):
        each = {case: own[policy] for case, own in orders.groupby(level="case", sort=False)}
        beyond = {
            case: (own[policy] - own[REFERENCE]).to_numpy()
            for case, own in orders.groupby(level="case", sort=False)
        }
        for case, found in beyond.items():
            rows.append((policy, case, each[case].mean(), *mean_interval(found)))
        if len(beyond) > 1:
            every = aggregate(list(beyond.values()))
            rows.append((policy, "interquartile mean", np.nan, *every.interquartile_mean))
            rows.append((policy, "probability of improvement", np.nan, *every.improvement))
    columns = ["policy", "task", "signed_order", "score", "score_low", "score_high"]
    table: pd.DataFrame = require("pandas", "plot").DataFrame(rows, columns=columns)
    return table


def write_entry(
    folder: Path, name: str, policy: Path, flock_hours: float, provenance: Mapping[str, str]
) -> None:
    """Write what makes a scored policy an entry: its file, and ``entry.toml``.

    ``entry.toml`` has the name, the flock-hours and their class, the version, the configuration
    that the policy's file holds, and the command that scores it again.

    Parameters
    ----------
    folder
        Where the scores are.
    name
        Of the entry.
    policy
        Its file.
    flock_hours
        What training and search simulated.
    provenance
        What the policy says of its making.

    Raises
    ------
    ParameterError
        As for `budget_class`.
    OSError
        If a file cannot be written.
    """
    budget, copy = budget_class(flock_hours), folder / policy.name
    command = ["flockenv", "compare", "--suite", SUITE, "--policy", policy.name, "--name", name]
    command += ["--flock-hours", f"{flock_hours:g}"]
    command += ["--trust"] if policy.suffix == ".zip" else []
    content = policy.read_bytes()
    with atomic_write(copy) as file:
        file.write(content)
    entry = {
        "name": name,
        "suite": SUITE,
        "flock_hours": float(flock_hours),
        "class_flock_hours": budget,
        "flockenv": __version__,
        "command": shlex.join(command),
        "configuration": dict(provenance),
    }
    write_text(folder / "entry.toml", tomli_w.dumps(entry))
