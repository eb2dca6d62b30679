"""How a search moves through vectors of numbers: an evolution strategy, and CMA-ES."""

import argparse
from collections.abc import Mapping
from typing import Any, Protocol, Self

import numpy as np

from flockenv._io.extras import require
from flockenv.errors import ParameterError

DECAY_1, DECAY_2 = 0.9, 0.99


class Method(Protocol):
    """A search's next candidates, by the scores of those before."""

    mean: np.ndarray

    def candidates(self) -> np.ndarray:
        """Return a generation of vectors, shape (candidates, size)."""

    def learn(self, candidates: np.ndarray, scores: np.ndarray) -> None:
        """Move by the scores of a generation; a larger score is a better candidate."""

    def arrays(self) -> dict[str, np.ndarray]:
        """Return all that the next generation depends on."""

    @classmethod
    def resumed(
        cls, first: np.ndarray, options: argparse.Namespace, arrays: Mapping[str, np.ndarray]
    ) -> Self:
        """Return a search where it was when these arrays were stored."""


def centered_ranks(values: np.ndarray) -> np.ndarray:
    """From -0.5 for the worst to 0.5 for the best."""
    ranks = np.empty(len(values))
    ranks[np.argsort(values, kind="stable")] = np.arange(len(values))
    return ranks / (len(values) - 1) - 0.5


class EvolutionStrategy:
    """Gaussian perturbations in antithetic pairs; Adam follows the gradient of the ranks."""

    def __init__(self, first: np.ndarray, options: argparse.Namespace) -> None:
        self.options = options
        self.number = 0
        self.mean = first
        self.moment_1, self.moment_2 = 0 * first, 0 * first

    @classmethod
    def resumed(
        cls, first: np.ndarray, options: argparse.Namespace, arrays: Mapping[str, np.ndarray]
    ) -> Self:
        found = cls(np.asarray(arrays["weights"]), options)
        found.number = int(arrays["generation"])
        found.moment_1, found.moment_2 = arrays["moment_1"], arrays["moment_2"]
        return found

    def _half(self) -> np.ndarray:
        # A generator of its own for each generation: nothing but the number has to be remembered.
        random = np.random.default_rng([self.options.seed, self.number])
        return random.standard_normal((self.options.pairs, len(self.mean)))

    def candidates(self) -> np.ndarray:
        half = self._half()
        return self.mean + self.options.sigma * np.concatenate([half, -half])

    def learn(self, candidates: np.ndarray, scores: np.ndarray) -> None:
        pairs, number = self.options.pairs, self.number
        ranks = centered_ranks(scores)
        gradient = (ranks[:pairs] - ranks[pairs:]) @ self._half()
        gradient /= 2 * pairs * self.options.sigma
        self.moment_1 = DECAY_1 * self.moment_1 + (1 - DECAY_1) * gradient
        self.moment_2 = DECAY_2 * self.moment_2 + (1 - DECAY_2) * gradient**2
        direction = (self.moment_1 / (1 - DECAY_1 ** (number + 1))) / (
            np.sqrt(self.moment_2 / (1 - DECAY_2 ** (number + 1))) + 1e-8
        )
        self.mean = self.mean + self.options.rate * direction
        self.number += 1

    def arrays(self) -> dict[str, np.ndarray]:
        return {"weights": self.mean, "moment_1": self.moment_1, "moment_2": self.moment_2}


class CovarianceAdaptation:
    """CMA-ES of the package cmaes (extra `fit`). A stored search is resumed from its scores.

    With `adapts_rates` its learning rates follow the signal-to-noise ratio (LRA-CMA-ES, Nomura,
    Akimoto and Ono, 2023). Without, the covariance is diagonal (sep-CMA-ES, Ros and Hansen, 2008),
    which suits vectors of several hundred numbers.
    """

    adapts_rates = True

    def __init__(self, first: np.ndarray, options: argparse.Namespace) -> None:
        cmaes = require("cmaes", "fit")
        given = {"sigma": options.sigma, "seed": options.seed, "population_size": 2 * options.pairs}
        if self.adapts_rates:
            self._optimizer = cmaes.CMA(first, **given, lr_adapt=True)
        else:
            self._optimizer = cmaes.SepCMA(first, **given)
        self.scores: list[np.ndarray] = []

    @property
    def mean(self) -> np.ndarray:
        return np.array(self._optimizer.mean)

    @classmethod
    def resumed(
        cls, first: np.ndarray, options: argparse.Namespace, arrays: Mapping[str, np.ndarray]
    ) -> Self:
        found = cls(first, options)
        for scores in arrays["scores"]:
            found.learn(found.candidates(), scores)
        if not np.allclose(found.mean, arrays["weights"], rtol=1e-6, atol=1e-9):
            raise ParameterError(
                "the stored scores do not lead to the stored mean: the search was stored with "
                "another version of cmaes or NumPy, or another number of threads"
            )
        return found

    def candidates(self) -> np.ndarray:
        return np.array([self._optimizer.ask() for _ in range(self._optimizer.population_size)])

    def learn(self, candidates: np.ndarray, scores: np.ndarray) -> None:
        # It minimizes.
        losses = (-np.asarray(scores)).tolist()
        self._optimizer.tell(list(zip(candidates, losses, strict=True)))
        self.scores.append(np.asarray(scores))

    def arrays(self) -> dict[str, np.ndarray]:
        scores = np.array(self.scores).reshape(-1, self._optimizer.population_size)
        return {"scores": scores, "weights": self.mean}


class DiagonalCovarianceAdaptation(CovarianceAdaptation):
    """CMA-ES with a diagonal covariance, whose learning rates are constant."""

    adapts_rates = False


METHODS: Mapping[str, Any] = {
    "evolution-strategy": EvolutionStrategy,
    "lra-cma-es": CovarianceAdaptation,
    "sep-cma-es": DiagonalCovarianceAdaptation,
}
