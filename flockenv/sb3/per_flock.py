"""`PerFlock`: a `LeaderVecEnv` with one reward, end and info per flock, for evaluation."""

from typing import Any

import numpy as np
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper
from stable_baselines3.common.vec_env.base_vec_env import VecEnvObs, VecEnvStepReturn

from flockenv.sb3.leader_vec_env import LeaderVecEnv


class PerFlock(VecEnvWrapper):
    """A `LeaderVecEnv` with one reward, end and info per flock, for evaluation only.

    stable-baselines3's `evaluate_policy` counts the ends of slots as episodes, but the leaders of a
    flock share one episode with one order. Here `num_envs` is the number of flocks, a reward is the
    mean over a flock's leaders, and the info is the first leader's, which has the ``"episode"``.
    Observations and actions still have a row per leader, as in the model's training.

    Parameters
    ----------
    venv
        A `LeaderVecEnv`, also inside other wrappers.

    Raises
    ------
    TypeError
        If there is no `LeaderVecEnv` inside.
    """

    def __init__(self, venv: VecEnv) -> None:
        leaders = getattr(venv, "unwrapped", venv)
        if not isinstance(leaders, LeaderVecEnv):
            raise TypeError(f"a LeaderVecEnv is needed, not {type(leaders).__name__}")
        super().__init__(venv)
        self._leader_counts = np.bincount(leaders.flock_of_slot)
        #: The first slot of each flock.
        self._first_slots = np.cumsum(self._leader_counts) - self._leader_counts
        self.num_envs = leaders.num_flocks
        self.leaders = leaders

    def reset(self) -> VecEnvObs:
        """Start episodes in all flocks; return observations, a row per leader."""
        return self.venv.reset()

    def step_wait(self) -> VecEnvStepReturn:
        """Return observations, a row per leader, and rewards, ends and infos, one per flock."""
        observations, rewards, dones, infos = self.venv.step_wait()
        means = np.add.reduceat(rewards, self._first_slots) / self._leader_counts
        flock_infos = [infos[slot] for slot in self._first_slots]
        return observations, means, dones[self._first_slots], flock_infos

    def env_is_wrapped(self, wrapper_class: type[Any], indices: object = None) -> list[bool]:
        """Return a list of one entry per flock: True for `Monitor`, as infos have ``"episode"``."""
        wrapped = issubclass(wrapper_class, Monitor)
        return [wrapped or self.venv.env_is_wrapped(wrapper_class)[0]] * self.num_envs


def per_flock(env: VecEnv) -> VecEnv:
    """Return an environment in which episodes and rewards count per flock."""
    return env if any(isinstance(layer, PerFlock) for layer in layers_of(env)) else PerFlock(env)


def layers_of(env: VecEnv) -> list[VecEnv]:
    """Return a vector environment, and all that it wraps, from the outside in."""
    layers = [env]
    while isinstance(layers[-1], VecEnvWrapper):
        layers.append(layers[-1].venv)
    return layers
