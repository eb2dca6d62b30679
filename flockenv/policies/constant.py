"""Policies that ignore their observations: controls to compare other policies with."""

from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from flockenv._io.arguments import as_int
from flockenv.errors import ParameterError
from flockenv.policies.base import Layout, RowPolicy


class StraightAhead(RowPolicy):
    """Leaders that never steer: rudder 0. Takes the options of `RowPolicy`."""

    def _steer(self, rows: NDArray[np.float32]) -> NDArray[np.float64]:
        return np.zeros(len(rows))


class RandomRudders(RowPolicy):
    """Leaders whose rudders are drawn for each control step, uniformly from [-1, 1].

    Parameters
    ----------
    seed
        Seed of the draws, which continue from call to call; at least 0.
    layout
        The options of `RowPolicy`.
    """

    def __init__(self, seed: int = 0, **layout: Unpack[Layout]) -> None:
        super().__init__(**layout)
        seed = as_int(seed, "seed")
        if seed < 0:
            raise ParameterError(f"seed = {seed} is not accepted: at least 0")
        self._random = np.random.default_rng(seed)

    def _steer(self, rows: NDArray[np.float32]) -> NDArray[np.float64]:
        return self._random.uniform(-1.0, 1.0, len(rows))
