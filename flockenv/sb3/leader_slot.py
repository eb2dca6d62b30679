"""`LeaderSlot`: the stand-in for one environment in a `LeaderVecEnv`."""

from dataclasses import dataclass
from typing import Any, Protocol

import gymnasium
import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import NDArray

from flockenv.envs.batch import LeaderBatch
from flockenv.envs.spaces import ObservationSpace
from flockenv.parameters import FlockParameters


class _Flocks(Protocol):
    """The members of a `LeaderVecEnv` that its slots use."""

    _batch: LeaderBatch

    @property
    def spec(self) -> EnvSpec | None: ...


@dataclass(frozen=True, eq=False)
class LeaderSlot:
    """The stand-in for one environment in a `LeaderVecEnv`: one leader of one flock.

    ``get_attr`` and ``env_method`` of the vector environment read these objects, which never
    change. ``set_attr`` accepts only ``bw_s`` and ``target``, for the next episodes.
    """

    _env: _Flocks
    flock_index: int
    leader_index: int
    observation_space: ObservationSpace
    action_space: gymnasium.Space[Any]
    render_mode: str | None

    @property
    def bw_s(self) -> float | tuple[float, float]:
        """Backward duration in s of the flock's next episodes, or its range."""
        upcoming: float | tuple[float, float] = self._upcoming()["bw_s"]
        return upcoming

    @property
    def target(self) -> str | tuple[str, ...]:
        """Target of the flock's next episodes."""
        upcoming: str | tuple[str, ...] = self._upcoming()["target"]
        return upcoming

    def _upcoming(self) -> dict[str, Any]:
        """Return ``bw_s`` and ``target`` of the flock's next episodes."""
        return self._env._batch.core.upcoming(self.flock_index)

    @property
    def spec(self) -> EnvSpec | None:
        """The registered environment that has the same options; None if there is none."""
        return self._env.spec

    @property
    def parameters(self) -> FlockParameters:
        """Parameters of the slot's flock; an episode may have its own target and bw_s."""
        return self._env._batch.parameters(self.flock_index)

    def set_next_episodes(self, **options: object) -> None:
        """Set ``bw_s`` or ``target`` of the flock's next episodes, as `LeaderVecEnv.set_attr`."""
        self._env._batch.set_upcoming([self.flock_index], options)

    def episode(self) -> dict[str, Any]:
        """Return target, backward duration, seed and step of the slot's flock."""
        return self._env._batch.core.episode(self.flock_index)

    def state(self) -> NDArray[np.float32]:
        """Return the global state of the slot's flock, shape (state size,)."""
        state: NDArray[np.float32] = self._env._batch.core.states()[self.flock_index]
        return state
