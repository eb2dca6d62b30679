"""PPO of stable-baselines3 with the settings of a run, and what is seen of it."""

import math
import warnings
from collections.abc import Callable
from typing import Any

import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.policies import ActorCriticPolicy

from flockenv.errors import ParameterError
from flockenv.sb3 import FlockCriticPolicy, SharedNoisePolicy
from flockenv.training.actor import ACTIVATION_MODULES
from flockenv.training.pools import PooledVecEnv
from flockenv.training.settings import TrainingSettings

__all__ = ["Watch", "actor_of", "learner"]


class _SharedNoiseFlockCriticPolicy(FlockCriticPolicy, SharedNoisePolicy):
    """One noise for all leaders of a flock, and a critic that sees the whole flock."""


_POLICIES: dict[tuple[bool, bool], type[ActorCriticPolicy]] = {
    (False, False): ActorCriticPolicy,
    (True, False): FlockCriticPolicy,
    (False, True): SharedNoisePolicy,
    (True, True): _SharedNoiseFlockCriticPolicy,
}
"""By whether the critic sees the flock, and whether its leaders share a noise."""


def learner(settings: TrainingSettings) -> PPO:
    """Return the learner of a run, before its first sample.

    Raises
    ------
    ParameterError
        For a GPU that is not there.
    """
    if settings.device == "cuda" and not torch.cuda.is_available():
        raise ParameterError("device = 'cuda' is not accepted: torch finds no GPU")
    env, layers = PooledVecEnv(settings), list(settings.net_arch)
    policy: dict[str, Any] = {
        "net_arch": {"pi": layers, "vf": layers},
        "activation_fn": ACTIVATION_MODULES[settings.activation],
        "log_std_init": settings.log_std_init,
    }
    sees_flock, hold_steps = settings.critic == "flock", settings.held_decisions(env.decisions_hz)
    if sees_flock:
        policy["seen"] = env.seen
    if hold_steps:
        policy |= {"flock_of_slot": env.flock_of_slot.tolist(), "hold_steps": hold_steps}
    with warnings.catch_warnings():
        # Small networks are often faster on the CPU, which is the user's choice.
        warnings.filterwarnings("ignore", "You are trying to run PPO on the GPU")
        return PPO(
            _POLICIES[sees_flock, hold_steps > 0],
            env,
            learning_rate=settings.learning_rate,
            n_steps=settings.n_steps,
            batch_size=settings.batch_size,
            n_epochs=settings.n_epochs,
            gamma=settings.gamma,
            gae_lambda=settings.gae_lambda,
            clip_range=settings.clip_range,
            ent_coef=settings.ent_coef,
            vf_coef=settings.vf_coef,
            max_grad_norm=settings.max_grad_norm,
            target_kl=settings.target_kl or None,
            use_sde=settings.use_sde,
            sde_sample_freq=settings.sde_sample_freq,
            policy_kwargs=policy,
            seed=settings.seed,
            device=settings.device,
        )


def actor_of(model: PPO) -> ActorCriticPolicy:
    """Return the learner's policy, as what it is."""
    assert isinstance(model.policy, ActorCriticPolicy)
    return model.policy


class Watch(BaseCallback):
    """Means over a rollout of what the learner itself does not keep."""

    def __init__(self, release: Callable[[], None]) -> None:
        super().__init__()
        self.release = release
        self.rewards: list[float] = []
        self.orders: list[float] = []

    def _on_step(self) -> bool:
        self.release()
        self.rewards.append(float(self.locals["rewards"].mean()))
        if self.locals["dones"].any():
            summaries = [each.get("episode_summary") for each in self.locals["infos"]]
            self.orders += [each["signed_order"] for each in summaries if each]
        return True

    def means(self) -> dict[str, float]:
        """Return the mean reward, and the mean signed order of the episodes that ended."""
        orders = sum(self.orders) / len(self.orders) if self.orders else math.nan
        return {"reward": sum(self.rewards) / len(self.rewards), "signed_order": orders}
