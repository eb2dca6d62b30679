"""Suite v2: six frozen tasks on which policies of any origin are scored against the tuned law.

If a task or one of its numbers changes, it is another suite. The seeds follow from the name of a
release, so that a later release scores all policies again, on flocks that are new to all of them.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flockenv._io.arguments import items
from flockenv._io.extras import require
from flockenv.comparison.case import Case
from flockenv.comparison.report import ComparisonReport
from flockenv.envs.ids import ENVIRONMENTS
from flockenv.errors import ParameterError, refuse_unknown, short_repr
from flockenv.parameters import FlockParameters
from flockenv.policies.names import TUNED_LAW
from flockenv.runs.seeds import release_seeds
from flockenv.statistics import (
    bootstrap_interval,
    interquartile_mean,
    mean_interval,
    probability_of_improvement,
)

if TYPE_CHECKING:
    import pandas as pd

SUITE = "v2"
"""Name of the suite."""

EPISODES = 256
"""Episodes of each task."""

REFERENCE = TUNED_LAW
"""The policy from which scores are differences."""

_SEEDS = release_seeds("v0.1.0", EPISODES)


def _task(name: str, env_id: str) -> Case:
    """Return the task of an environment."""
    options = dict(ENVIRONMENTS[env_id].options)
    parameters = FlockParameters.from_dict(options.pop("params"))
    targets: tuple[object, ...] = ()
    if isinstance(options.get("target"), tuple):
        # In half of the episodes the leaders exchange their targets, so that neither is favored.
        leader_targets = options.pop("target")
        targets = (leader_targets, leader_targets[::-1])
    return Case(
        name=name,
        parameters=parameters,
        leaders=(parameters.n_leaders,),
        seeds=_SEEDS,
        episode_s=options.pop("episode_s"),
        environment=options,
        targets=targets,
    )


TASK_IDS: Mapping[str, str] = {
    "one-leader": "flockenv/OneLeader-v0",
    "three-leaders": "flockenv/ThreeLeaders-v0",
    "reversal": "flockenv/Reversal-v0",
    "camera": "flockenv/Camera-v0",
    "noises": "flockenv/Noises-v0",
    "misinformed": "flockenv/Misinformed-v0",
}
"""The environment of each task."""

TASKS: tuple[Case, ...] = tuple(_task(name, env_id) for name, env_id in TASK_IDS.items())
"""The tasks; docs/suite.md describes them."""


def tasks_named(suite: str, names: Iterable[str] = ()) -> list[Case]:
    """Return tasks of a suite, all of them if none is named; unknown names are refused."""
    chosen = items(names, "names")
    if suite != SUITE:
        raise ParameterError(
            f"suite = {short_repr(suite)} is not accepted: there are {SUITE} and v3"
        )
    refuse_unknown(chosen, [task.name for task in TASKS], f"task of suite {SUITE}")
    return [task for task in TASKS if not chosen or task.name in chosen]


def aggregate(differences: Sequence[NDArray[np.float64]]) -> dict[str, tuple[float, float, float]]:
    """Summarize differences from `REFERENCE`, one array of episodes per task.

    Returns
    -------
    dict
        Two statistics by name, each as value, lower end and upper end. The ``interquartile mean``
        is over the episodes of all tasks. The ``probability of improvement`` is how often an
        episode has a higher signed order than with `REFERENCE`; it is a mean over the tasks. The
        intervals are BCa bootstraps that draw episodes within each task (Agarwal et al. 2021 draw
        runs).
    """
    statistics = {
        "interquartile mean": interquartile_mean,
        "probability of improvement": probability_of_improvement,
    }
    return {
        name: bootstrap_interval(differences, statistic, paired=False)
        for name, statistic in statistics.items()
    }


def scores_table(result: ComparisonReport) -> "pd.DataFrame":
    """Return the scores of every policy but `REFERENCE`.

    Returns
    -------
    pandas.DataFrame
        One row for each policy and task. ``signed_order`` is the mean, ``score`` its difference
        from `REFERENCE`, and ``score_low`` and ``score_high`` are the ends of its interval. With
        two tasks or more each policy also has a row ``interquartile mean`` and a row ``probability
        of improvement``.
    """
    orders = result.runs.pivot_table(
        index=["case", "seed"], columns="policy", values="signed_order", sort=False
    )
    rows: list[tuple[object, ...]] = []
    for policy in (name for name in orders if name != REFERENCE):
        differences = []
        for case, task_orders in orders.groupby(level="case", sort=False):
            difference = (task_orders[policy] - task_orders[REFERENCE]).to_numpy()
            differences.append(difference)
            rows.append((policy, case, task_orders[policy].mean(), *mean_interval(difference)))
        if len(differences) > 1:
            for name, value_and_ends in aggregate(differences).items():
                rows.append((policy, name, np.nan, *value_and_ends))
    columns = ["policy", "task", "signed_order", "score", "score_low", "score_high"]
    table: pd.DataFrame = require("pandas", "plot").DataFrame(rows, columns=columns)
    return table
