"""What trials say together: the Pareto front between groups of targets, and targets in pairs."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flockenv._io.extras import require
from flockenv.calibration.search import Fit, Trial, table
from flockenv.calibration.surrogate import Surrogate, candidates, front_ranks
from flockenv.calibration.targets import GROUPS, MISFITS, SEARCHED_TARGETS, misfits

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Landscape", "finalists", "front_table", "landscape", "pair_table"]

_CLOUD = 2000
_NEAR = 10
"""Near the front is the tenth of the trials with the least total misfit by the surrogate."""


@dataclass(frozen=True, slots=True)
class Landscape:
    """What the surrogate of a pool has at its trials, and at many places about their front.

    Attributes
    ----------
    pool : str
        Of the trials.
    places : float64 array, shape (places, constants)
        The trials, then the other places.
    trials : int
        How many of the places are trials.
    means, deviations : mapping of float64 arrays, shape (places,)
        Of the targets.
    costs : float64 array, shape (places, groups)
        Misfits of the means.
    """

    pool: str
    places: NDArray[np.float64]
    trials: int
    means: dict[str, NDArray[np.float64]]
    deviations: dict[str, NDArray[np.float64]]
    costs: NDArray[np.float64]

    @property
    def probabilities(self) -> NDArray[np.float64]:
        """Of each target to be in its range, shape (targets, places); 0 where none is known."""
        normal = require("scipy.stats", "fit").norm
        rows = []
        for target in SEARCHED_TARGETS:
            mean, deviation = self.means[target.key], np.maximum(self.deviations[target.key], 1e-9)
            ends = [normal.cdf((end - mean) / deviation) for end in (target.low, target.high)]
            rows.append(np.nan_to_num(ends[1] - ends[0]))
        return np.array(rows)

    @property
    def met(self) -> NDArray[np.bool_]:
        """Whether the mean of each target is in its range, shape (targets, places)."""
        return np.array(
            [(self.means[t.key] >= t.low) & (self.means[t.key] <= t.high) for t in SEARCHED_TARGETS]
        )


def landscape(fit: Fit, trials: Sequence[Trial], pool: str) -> Landscape:
    """Return the surrogate's view of a pool after all trials."""
    own = [trial for trial in trials if trial.pool == pool]
    at, values = table(own)
    surrogate = Surrogate.of(fit.kernels(own), at, values)
    rng = np.random.default_rng([fit.seed, len(trials)])
    places = np.vstack([at, candidates(surrogate, at, rng, _CLOUD)])
    means, deviations = surrogate.predict(places)
    costs = misfits(means, SEARCHED_TARGETS)
    return Landscape(pool, places, len(own), dict(means), dict(deviations), costs)


def finalists(fit: Fit, view: Landscape) -> list[tuple[str, tuple[float, ...]]]:
    """Choose places to run again, with the reason: each with a boat of Table 1.

    Two of the most targets that the surrogate expects in range, two of the least total misfit, and
    the least misfit of each of `GROUPS` along the front.
    """
    expected = -view.probabilities.sum(axis=0)
    total = view.costs.sum(axis=1)
    front = front_ranks(view.costs, 1) == 0
    wanted = [(2, "most targets", expected), (2, "least total", total)]
    for group, name in enumerate(GROUPS):
        wanted.append((1, f"least {name}", np.where(front, view.costs[:, group], np.inf)))
    chosen: list[tuple[str, tuple[float, ...]]] = []
    for count, reason, costs in wanted:
        found = 0
        for place in np.lexsort((total, costs)):
            at = tuple(round(float(each), 4) for each in view.places[place])
            if at in [places for _, places in chosen] or fit.boat(at) is None:
                continue
            chosen.append((reason, at))
            found += 1
            if found == count:
                break
    return chosen


def front_table(fit: Fit, views: Sequence[Landscape]) -> "pd.DataFrame":
    """Return the trials on the Pareto front of their pool, by the surrogate.

    Columns: ``pool``, the constants, the misfit of each group, the number of targets whose mean is
    in range, and each target's mean with its standard deviation (``<key>_sd``).
    """
    pandas = require("pandas", "fit")
    rows = []
    for view in views:
        costs = view.costs[: view.trials]
        for place in np.flatnonzero(front_ranks(costs, 1) == 0):
            row = {"pool": view.pool, **fit.constants_at(view.places[place])}
            row |= dict(zip(MISFITS, costs[place], strict=True))
            row["met"] = int(view.met[:, place].sum())
            for target in SEARCHED_TARGETS:
                row[target.key] = view.means[target.key][place]
                row[f"{target.key}_sd"] = view.deviations[target.key][place]
            rows.append(row)
    frame: pd.DataFrame = pandas.DataFrame(rows)
    return frame


def pair_table(views: Sequence[Landscape]) -> "pd.DataFrame":
    """Return how each pair of targets goes together in each pool, by the surrogate.

    Columns: ``pool``, ``first``, ``second``; ``correlation``, Spearman's, of their penalties over
    the trials near the front (negative: the nearer one, the farther the other; NaN where one does
    not vary); ``both``, the share of those trials whose means have both in range; ``best``, the
    largest product of the two probabilities to be in range, of all places.
    """
    pandas, stats = require("pandas", "fit"), require("scipy.stats", "fit")
    rows = []
    for view in views:
        total = view.costs[: view.trials].sum(axis=1)
        near = np.argsort(total, kind="stable")[: max(view.trials // _NEAR, 3)]
        penalties = [target.penalty(view.means[target.key][near]) for target in SEARCHED_TARGETS]
        met, chances = view.met[:, near], view.probabilities
        for a, b in itertools.combinations(range(len(SEARCHED_TARGETS)), 2):
            varies = np.ptp(penalties[a]) > 0.0 and np.ptp(penalties[b]) > 0.0
            rows.append(
                {
                    "pool": view.pool,
                    "first": SEARCHED_TARGETS[a].key,
                    "second": SEARCHED_TARGETS[b].key,
                    "correlation": (
                        float(stats.spearmanr(penalties[a], penalties[b]).statistic)
                        if varies
                        else float("nan")
                    ),
                    "both": float((met[a] & met[b]).mean()),
                    "best": float((chances[a] * chances[b]).max()),
                    "trials": len(near),
                }
            )
    frame: pd.DataFrame = pandas.DataFrame(rows)
    return frame
