"""Gaussian processes over the targets, what they propose to try next, and their Pareto front.

One process per target is conditioned on all trials of a pool. It averages over trials, so that the
luck of one trial's seeds, which its white part holds, does not pass for a good fit.
"""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.extras import require
from flockenv.calibration.targets import SEARCHED_TARGETS, misfits

__all__ = ["Kernels", "Surrogate", "candidates", "front_ranks", "learn", "propose"]

_LEARNED_FROM = 200
"""Trials that kernels are learned from; processes are conditioned on all trials."""

_FEWEST = 20
_CANDIDATES = 1500
_SPREADS = (0.05, 0.15)
"""Standard deviations of steps away from the front, as parts of the ranges of constants."""

Places = NDArray[np.float64]


Values = Mapping[str, NDArray[np.float64]]
Kernels = Mapping[str, Any]


def learn(places: Places, values: Values) -> Kernels:
    """Learn the kernel of each target from the first trials, which fill the space.

    Parameters
    ----------
    places
        Shape (trials, constants): each constant between its bounds, from 0 to 1.
    values
        By target, shape (trials,).

    Returns
    -------
    mapping
        By target, kernels of scikit-learn: a constant times a Gaussian with a length scale per
        constant, plus white noise. Targets that fewer than 20 trials define have none.

    Raises
    ------
    MissingExtraError
        Without the extra ``fit``.
    """
    gaussian = require("sklearn.gaussian_process", "fit")
    kernels = gaussian.kernels
    width = places.shape[1]
    # A single run of each cell has luck of its own, at least a twentieth of all variance.
    prior = kernels.ConstantKernel(1.0, (0.05, 20.0)) * kernels.RBF(
        np.ones(width), (0.25, 20.0)
    ) + kernels.WhiteKernel(0.3, (0.05, 2.0))
    learned = {}
    for key, measured in values.items():
        known = np.flatnonzero(np.isfinite(measured))[:_LEARNED_FROM]
        if len(known) < _FEWEST:
            continue
        process = gaussian.GaussianProcessRegressor(prior, normalize_y=True)
        with warnings.catch_warnings():
            # A length scale at its bound is a constant that does not matter.
            warnings.simplefilter("ignore", require("sklearn.exceptions", "fit").ConvergenceWarning)
            process.fit(places[known], _cut(measured[known]))
        learned[key] = process.kernel_
    return learned


def _cut(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.clip(values, *np.quantile(values, [0.01, 0.99]))


@dataclass(frozen=True, slots=True)
class Surrogate:
    """Processes of the targets of one pool.

    Attributes
    ----------
    processes : mapping
        By target: a fitted process of scikit-learn, and the ends of its values.
    """

    processes: Mapping[str, tuple[Any, float, float]]

    @classmethod
    def of(cls, kernels: Kernels, places: Places, values: Values) -> "Surrogate":
        """Condition a process per kernel on trials, as for `learn`; undefined values are left out.

        Values beyond the first and the last percent are cut off there.
        """
        gaussian = require("sklearn.gaussian_process", "fit")
        processes = {}
        for key, kernel in kernels.items():
            known = np.isfinite(values[key])
            cut = _cut(values[key][known])
            process = gaussian.GaussianProcessRegressor(kernel, optimizer=None, normalize_y=True)
            process.fit(places[known], cut)
            processes[key] = (process, float(cut.min()), float(cut.max()))
        return cls(processes)

    def predict(self, places: Places) -> tuple[Values, Values]:
        """Return means of the targets and their standard deviations, without a run's own luck.

        Targets without a process are undefined.
        """
        means: dict[str, NDArray[np.float64]] = {}
        deviations: dict[str, NDArray[np.float64]] = {}
        for target in SEARCHED_TARGETS:
            means[target.key] = deviations[target.key] = np.full(len(places), np.nan)
            if target.key in self.processes:
                process, low, high = self.processes[target.key]
                mean, total = process.predict(places, return_std=True)
                white = process.kernel_.k2.noise_level * process._y_train_std**2
                means[target.key] = np.clip(mean, low, high)
                deviations[target.key] = np.sqrt(np.maximum(total**2 - white, 0.0))
        return means, deviations


def front_ranks(costs: NDArray[np.float64], enough: int) -> NDArray[np.int64]:
    """Return the rank of each row: 0 on the Pareto front, 1 on the front without that one, and on.

    Parameters
    ----------
    costs
        Shape (rows, groups); less is better.
    enough
        Once so many rows are ranked, the others share the next rank.
    """
    ranks = np.full(len(costs), -1, np.int64)
    rank = 0
    left = np.arange(len(costs))
    while len(left) and len(costs) - len(left) < enough:
        own = costs[left]
        no_worse = (own[:, None, :] <= own[None, :, :]).all(axis=2)
        better = (own[:, None, :] < own[None, :, :]).any(axis=2)
        dominated = (no_worse & better).any(axis=0)
        ranks[left[~dominated]] = rank
        left = left[dominated]
        rank += 1
    ranks[left] = rank
    return ranks


def candidates(
    surrogate: Surrogate, places: Places, rng: np.random.Generator, count: int
) -> Places:
    """Draw places about the front of all trials as the surrogate has it, and a quarter anywhere."""
    means, _ = surrogate.predict(places)
    costs = misfits(means, SEARCHED_TARGETS)
    best = np.flatnonzero(front_ranks(costs, max(len(places) // 20, 1)) == 0)
    best = np.union1d(best, np.argsort(costs.sum(axis=1), kind="stable")[: max(len(best), 10)])
    anywhere = rng.random((count // 4, places.shape[1]))
    about = places[rng.choice(best, count - len(anywhere))]
    spread = rng.choice(_SPREADS, (len(about), 1))
    return np.vstack([np.clip(about + spread * rng.standard_normal(about.shape), 0, 1), anywhere])


def propose(
    surrogate: Surrogate,
    places: Places,
    count: int,
    rng: np.random.Generator,
    boat: Callable[[Places], dict[str, float] | None],
) -> list[tuple[Places, dict[str, float]]]:
    """Propose places to try next: the front of one draw of the targets at many candidates.

    The draw (Thompson sampling) spreads the batch over what may yet turn out best.

    Parameters
    ----------
    surrogate, places
        Of the trials so far, and where they are.
    count
        How many to propose.
    rng
        Of the draws.
    boat
        Measures a boat alone at a place; None refuses the place.

    Returns
    -------
    list of (places, boat)
        In the order of their ranks.
    """
    accepted: list[tuple[Places, dict[str, float]]] = []
    while len(accepted) < count:
        drawn = candidates(surrogate, places, rng, _CANDIDATES)
        means, deviations = surrogate.predict(drawn)
        sample = {
            key: mean + deviations[key] * rng.standard_normal(len(mean))
            for key, mean in means.items()
        }
        costs = misfits(sample, SEARCHED_TARGETS)
        ranks = front_ranks(costs, 4 * count)
        for place in np.lexsort((costs.sum(axis=1), ranks)):
            measured = boat(drawn[place])
            if measured is not None:
                accepted.append((drawn[place], measured))
            if len(accepted) == count:
                break
    return accepted
