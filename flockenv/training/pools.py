"""`PooledVecEnv`: flocks in several pools as one vector environment."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from flockenv.errors import ParameterError
from flockenv.sb3 import LeaderVecEnv, WithFlockFeatures
from flockenv.training.settings import TrainingSettings

# After flockenv.sb3, which says what to install where it is missing.
from stable_baselines3.common.vec_env import VecEnv  # isort: skip

__all__ = ["PooledVecEnv"]


class PooledVecEnv(VecEnv):
    """One `LeaderVecEnv` per pool behind one interface, with the slots of one pool after another.

    Parameters
    ----------
    settings
        Where and with how many flocks.
    """

    def __init__(self, settings: TrainingSettings) -> None:
        flocks = [
            LeaderVecEnv(
                settings.num_flocks,
                n_leaders=list(settings.n_leaders),
                **settings.environment(pool),
            )
            for pool in settings.pools
        ]
        of_flock = settings.critic == "flock"
        #: Number of each slot's flock, over all pools.
        self.flock_of_slot = np.concatenate(
            [place * settings.num_flocks + each.flock_of_slot for place, each in enumerate(flocks)]
        )
        #: Decisions per second.
        self.decisions_hz = flocks[0].decisions_hz
        self.parts = [WithFlockFeatures(part) if of_flock else part for part in flocks]
        #: Numbers of a row that are a leader's observation.
        (self.seen,) = flocks[0].observation_space.shape or ()
        first = self.parts[0]
        self._ends = np.cumsum([part.num_envs for part in self.parts])
        every = len(self.parts) * settings.num_flocks
        self._first_seeds = settings.flock_seeds(every)
        self._squash = settings.squash
        # Float32 has no number between the hyperbolic tangent of 9 and 1.
        actions = Box(-9.0, 9.0, (1,), np.float32) if self._squash else first.action_space
        super().__init__(int(self._ends[-1]), first.observation_space, actions)

    def reset(self) -> NDArray[np.float32]:
        """Start again with the run's training seeds."""
        for number, part in enumerate(self.parts):
            part.seed(self._first_seeds[number * part.num_flocks])
        return np.concatenate([part.reset() for part in self.parts])

    def step_async(self, actions: NDArray[Any]) -> None:
        """Take note of rudders, shape (slots, 1)."""
        if self._squash:
            actions = np.tanh(actions)
        for part, rows in zip(self.parts, np.split(actions, self._ends[:-1]), strict=True):
            part.step_async(rows)

    def step_wait(
        self,
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Take the control step in every pool."""
        steps = [part.step_wait() for part in self.parts]
        observations, rewards, dones, infos = zip(*steps, strict=True)
        return (
            np.concatenate(observations),
            np.concatenate(rewards),
            np.concatenate(dones),
            [info for each in infos for info in each],
        )

    def get_state(self) -> list[bytes]:
        """Return everything that the future depends on, one entry per pool."""
        return [part.get_state() for part in self.parts]

    def set_state(self, states: Sequence[bytes]) -> NDArray[np.float32]:
        """Continue from `get_state` of the same settings; return the observations."""
        if len(states) != len(self.parts):
            raise ParameterError(f"{len(states)} states for {len(self.parts)} pools")
        return np.concatenate(
            [part.set_state(state) for part, state in zip(self.parts, states, strict=True)]
        )

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Do nothing: seeds are those of the settings."""
        return [None] * self.num_envs

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of each slot."""
        if "parts" not in self.__dict__:
            raise AttributeError(attr_name)
        each = [value for part in self.parts for value in part.get_attr(attr_name)]
        return [each[slot] for slot in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refuse: attributes belong to the parts."""
        raise NotImplementedError("set attributes of PooledVecEnv.parts")

    def env_method(
        self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any
    ) -> list[Any]:
        """Call a method of each slot."""
        methods = self.get_attr(method_name, indices)
        return [method(*method_args, **method_kwargs) for method in methods]

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Any = None) -> list[bool]:
        """Return False for each slot: there are no wrappers around single slots."""
        return [False for _ in self._get_indices(indices)]

    def close(self) -> None:
        """Nothing is held open."""
