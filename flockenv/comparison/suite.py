"""Suite v2: six frozen tasks on which policies of any origin are scored against the tuned law.

Another task, or another number in one, is another suite. The seeds follow from the name of the
release, so that a later release scores all entries again, on flocks that none of them has met.
"""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.arguments import items
from flockenv._io.extras import require
from flockenv.comparison.case import Case
from flockenv.comparison.report import ComparisonReport
from flockenv.errors import ParameterError, refuse_unknown, shown
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

# Written out, so that no other default changes a task.
_FLOCK = FlockParameters.preset("simulation").replace(
    n_boats=27, pool="wide", bw_s=0.31, dt_s=0.02, target="cw"
)


def _task(name: str, leaders: int, **options: Any) -> Case:
    """Return a task with leaders in the flock of the suite; options are those of `Case`."""
    parameters = _FLOCK.replace(n_leaders=leaders)
    return Case(name=name, parameters=parameters, leaders=(leaders,), seeds=_SEEDS, **options)


TASKS: tuple[Case, ...] = (
    _task("one-leader", 1),
    _task("three-leaders", 3),
    # As in figure 7.
    _task("reversal", 3, environment={"target": "alternate"}, episode_s=960.0),
    _task("camera", 3, environment={"dropout_rate": 0.02, "delay_frames": 1}),
    # Half to 1.25 times the critical noise.
    _task("noises", 3, environment={"bw_s": (0.155, 0.3875)}),
    # Leader 1 gets the wrong direction.
    _task("misinformed", 2, targets=(("cw", "ccw"), ("ccw", "cw"))),
)
"""The tasks, of which docs/suite.md says what each asks of leaders."""


def tasks_named(suite: str, names: Iterable[str] = ()) -> list[Case]:
    """Return tasks of a suite, all of them if none is named; unknown names are refused."""
    chosen = items(names, "names")
    if suite != SUITE:
        raise ParameterError(f"suite = {shown(suite)} is not accepted: there is {SUITE}")
    refuse_unknown(chosen, [task.name for task in TASKS], f"task of suite {SUITE}")
    return [task for task in TASKS if not chosen or task.name in chosen]


def aggregate(differences: Sequence[NDArray[np.float64]]) -> dict[str, tuple[float, float, float]]:
    """Return what differences from `REFERENCE` say together, one array of episodes per task.

    Returns
    -------
    dict
        Value, lower and upper end: of the ``interquartile mean`` over the episodes of all tasks;
        and of the ``probability of improvement``, that an episode has a higher signed order than
        with `REFERENCE`, mean over the tasks. The intervals are BCa bootstraps in which episodes
        are drawn within each task (Agarwal et al. 2021 have runs in the place of episodes).
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
        For each policy one row per task with ``policy``, ``task``, ``signed_order`` (its mean) and
        ``score``, ``score_low`` and ``score_high``, the difference from `REFERENCE`; and for two
        tasks or more a row ``interquartile mean`` and a row ``probability of improvement``.
    """
    orders = result.runs.pivot_table(
        index=["case", "seed"], columns="policy", values="signed_order", sort=False
    )
    rows: list[tuple[Any, ...]] = []
    for policy in (name for name in orders if name != REFERENCE):
        beyond = []
        for case, own in orders.groupby(level="case", sort=False):
            beyond.append((own[policy] - own[REFERENCE]).to_numpy())
            rows.append((policy, case, own[policy].mean(), *mean_interval(beyond[-1])))
        if len(beyond) > 1:
            for name, found in aggregate(beyond).items():
                rows.append((policy, name, np.nan, *found))
    columns = ["policy", "task", "signed_order", "score", "score_low", "score_high"]
    table: pd.DataFrame = require("pandas", "plot").DataFrame(rows, columns=columns)
    return table
