"""Policies that observe nothing, as controls for the worth of steering."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv.policies.base import RowPolicy

__all__ = ["RandomRudders", "StraightAhead"]


class StraightAhead(RowPolicy):
    """Leaders that never steer: rudder 0.

    Parameters
    ----------
    observation, mirror_to_target
        Layout of the observations, as in the environments' options of those names.
    """

    def __init__(
        self, *, observation: Mapping[str, Any] | None = None, mirror_to_target: bool = False
    ) -> None:
        super().__init__(observation, mirror_to_target)

    def _steer(self, rows: NDArray[np.float32]) -> NDArray[np.float64]:
        return np.zeros(len(rows))

    def __repr__(self) -> str:
        return f"{type(self).__name__}()"


class RandomRudders(RowPolicy):
    """Leaders whose rudders are drawn for each control step, uniformly from [-1, 1].

    Parameters
    ----------
    seed
        Seed of the draws. The object draws on from call to call.
    observation, mirror_to_target
        Layout of the observations, as in the environments' options of those names.
    """

    def __init__(
        self,
        seed: int = 0,
        *,
        observation: Mapping[str, Any] | None = None,
        mirror_to_target: bool = False,
    ) -> None:
        super().__init__(observation, mirror_to_target)
        self._random = np.random.default_rng(seed)

    def _steer(self, rows: NDArray[np.float32]) -> NDArray[np.float64]:
        return self._random.uniform(-1.0, 1.0, len(rows))

    def __repr__(self) -> str:
        return f"{type(self).__name__}()"
