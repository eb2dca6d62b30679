"""How leaders deviate from a policy's mean actions while a signal is measured."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Exploration"]

Array = NDArray[np.float64]


class Exploration:
    """Normal noise of the actions, or of the weights that they depend on.

    Parameters
    ----------
    random
        Where draws come from.
    flocks, leaders
        Number of flocks, and leaders of each.
    deviation
        Standard deviation of the actions; with `inputs` that of actions for inputs whose mean
        square is 1.
    shared
        Whether all leaders of a flock have the same draws.
    hold
        Decisions that draws are held for.
    inputs
        What the perturbed weights multiply, a constant apart: from observations, shape (rows,
        numbers), to an array of shape (rows, inputs). None: the actions themselves deviate.
    """

    def __init__(
        self,
        random: np.random.Generator,
        flocks: int,
        leaders: int,
        *,
        deviation: float,
        shared: bool,
        hold: int,
        inputs: Callable[[Any], NDArray[Any]] | None = None,
    ) -> None:
        self._random, self._flocks, self._leaders = random, flocks, leaders
        self._deviation, self._shared, self._hold = deviation, shared, hold
        self._inputs = inputs
        self._decisions = 0
        self._drawn = np.zeros(0)

    def next(self, seen: NDArray[np.float32]) -> tuple[Array, Array]:
        """Return deviations of the next decision, and their standard deviations: shape (rows,)."""
        inputs = np.ones((len(seen), 1)) if self._inputs is None else self._with_constant(seen)
        if self._decisions % self._hold == 0:
            draws = self._flocks if self._shared else len(seen)
            self._drawn = self._random.standard_normal((draws, inputs.shape[1]))
        self._decisions += 1
        drawn = np.repeat(self._drawn, self._leaders, axis=0) if self._shared else self._drawn
        scale = self._deviation / np.sqrt(inputs.shape[1])
        return scale * (inputs * drawn).sum(axis=1), scale * np.linalg.norm(inputs, axis=1)

    def _with_constant(self, seen: NDArray[np.float32]) -> Array:
        assert self._inputs is not None
        inputs = self._inputs(seen)
        return np.concatenate([inputs, np.ones((len(inputs), 1))], axis=1, dtype=np.float64)
