"""Policies that look at nothing: what steering at all is worth."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flockenv.observation import observation_entries
from flockenv.policies.rows import rudders_for

__all__ = ["RandomRudders", "StraightAhead"]


class StraightAhead:
    """Leaders that never steer: rudder 0.

    Parameters
    ----------
    observation, mirror_to_target
        Layout of the observations, as in the environments' options of those names.
    """

    def __init__(
        self, *, observation: Mapping[str, Any] | None = None, mirror_to_target: bool = False
    ) -> None:
        self.observation = dict(observation or {})
        self.mirror_to_target = mirror_to_target
        self._size = len(observation_entries(self.observation))

    def predict(
        self,
        observation: ArrayLike | Mapping[Any, ArrayLike],
        state: Any = None,
        episode_start: Any = None,
        deterministic: bool = True,
    ) -> tuple[Any, Any]:
        """Return rudders of 0 for observations (..., m * size): shape (..., m), float32."""
        return rudders_for(observation, self._size, lambda rows: np.zeros(len(rows))), state

    def __repr__(self) -> str:
        return f"{type(self).__name__}()"


class RandomRudders(StraightAhead):
    """Leaders whose rudders are drawn anew for each control step, uniformly from [-1, 1].

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
        super().__init__(observation=observation, mirror_to_target=mirror_to_target)
        self._random = np.random.default_rng(seed)

    def predict(
        self,
        observation: ArrayLike | Mapping[Any, ArrayLike],
        state: Any = None,
        episode_start: Any = None,
        deterministic: bool = True,
    ) -> tuple[Any, Any]:
        """Return random rudders for observations (..., m * size): shape (..., m), float32."""

        def draw(rows: Any) -> Any:
            return self._random.uniform(-1.0, 1.0, len(rows))

        return rudders_for(observation, self._size, draw), state
