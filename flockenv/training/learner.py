"""PPO of stable-baselines3 with the settings of a run, and what is seen of it."""

import math
import warnings
from collections.abc import Callable
from typing import Any

import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.policies import ActorCriticPolicy
from torch.optim.swa_utils import AveragedModel, get_ema_avg_fn

from flockenv.errors import ParameterError
from flockenv.sb3 import FlockCriticPolicy, SharedNoisePolicy
from flockenv.sb3.encoders import ACTIVATION_MODULES, EXTRACTORS
from flockenv.training.actor import actor_module, encoder_options
from flockenv.training.pools import PooledVecEnv
from flockenv.training.settings import TrainingSettings

__all__ = ["Learner", "Watch", "actor_of", "learner"]


class _SharedNoiseFlockCriticPolicy(FlockCriticPolicy, SharedNoisePolicy):
    """One noise for all leaders of a flock, and a critic that sees the whole flock."""


_POLICIES: dict[tuple[bool, bool], type[ActorCriticPolicy]] = {
    (False, False): ActorCriticPolicy,
    (True, False): FlockCriticPolicy,
    (False, True): SharedNoisePolicy,
    (True, True): _SharedNoiseFlockCriticPolicy,
}
"""By whether actor and critic see different things, and whether a flock's leaders share a noise."""


class Learner(PPO):
    """PPO with the moving average of its actor's weights, None where that is the last weights."""

    averaged: AveragedModel | None = None

    def update_average(self) -> None:
        """Take the present weights into the average."""
        if self.averaged is not None:
            self.averaged.update_parameters(actor_module(actor_of(self)))

    def mean_actor(self) -> torch.nn.Module:
        """Return the actor that is validated and stored."""
        return actor_of(self) if self.averaged is None else self.averaged


def learner(settings: TrainingSettings) -> Learner:
    """Return the learner of a run, before its first sample.

    Raises
    ------
    ParameterError
        For a GPU that is not there.
    """
    if settings.device == "cuda" and not torch.cuda.is_available():
        raise ParameterError("device = 'cuda' is not accepted: torch finds no GPU")
    env, layers = PooledVecEnv(settings), list(settings.net_arch)
    critic = layers if settings.critic_arch is None else list(settings.critic_arch)
    policy: dict[str, Any] = {
        "net_arch": {"pi": layers, "vf": critic},
        "activation_fn": ACTIVATION_MODULES[settings.activation],
        "log_std_init": settings.log_std_init,
    }
    encoded, hold_steps = settings.encoder != "none", settings.held_decisions(env.decisions_hz)
    two_views = settings.critic == "flock" or encoded
    if two_views:
        policy["seen"] = env.seen
    if encoded:
        policy["features_extractor_class"] = EXTRACTORS[settings.encoder]
        policy["features_extractor_kwargs"] = encoder_options(settings)
    if hold_steps:
        policy |= {"flock_of_slot": env.flock_of_slot.tolist(), "hold_steps": hold_steps}
    with warnings.catch_warnings():
        # Small networks are often faster on the CPU, which is the user's choice.
        warnings.filterwarnings("ignore", "You are trying to run PPO on the GPU")
        model = Learner(
            _POLICIES[two_views, hold_steps > 0],
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
    actor = actor_of(model)
    actor.log_std.requires_grad_(settings.learn_log_std)
    if settings.average < 1.0:
        ema = get_ema_avg_fn(1.0 - settings.average)  # type: ignore[no-untyped-call]
        model.averaged = AveragedModel(actor_module(actor), avg_fn=ema)
    return model


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
