"""A centralized critic: actors observe what their leader observes, the critic the whole flock.

    python baselines/centralized_critic.py --samples 200000

The example uses PPO of stable-baselines3 with one policy shared by all leaders. `state()` is
appended to each leader's observation. The actor's network gets the observation alone, and the
critic's network gets both. Only the actor is needed afterwards: `predict` never reads the state.
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
import torch
from gymnasium.spaces import Box
from run_number import run_number
from script_end import one_line_end
from stable_baselines3 import PPO
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.vec_env import VecEnvWrapper

from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.sb3 import LeaderVecEnv


class WithState(VecEnvWrapper):
    """Appends the flock's global state to each leader's observation."""

    venv: LeaderVecEnv

    def __init__(self, venv: LeaderVecEnv) -> None:
        own, state = venv.observation_space, venv.state_space
        space = Box(np.append(own.low, state.low), np.append(own.high, state.high))
        super().__init__(venv, observation_space=space)

    def reset(self) -> np.ndarray:
        return self._joined(self.venv.reset())

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        observations, rewards, dones, infos = self.venv.step_wait()
        for slot in np.flatnonzero(dones):
            last = infos[slot]["terminal_observation"], infos[slot]["terminal_state"]
            infos[slot]["terminal_observation"] = np.concatenate(last)
        return self._joined(observations), rewards, dones, infos

    def _joined(self, observations: np.ndarray) -> np.ndarray:
        return np.concatenate([observations, self.venv.state()], axis=1)


class TwoViews(torch.nn.Module):
    """The actor's network on the first `seen` numbers, the critic's on all of them."""

    def __init__(self, seen: int, whole: int, width: int = 128) -> None:
        super().__init__()
        self.seen = seen
        self.latent_dim_pi = self.latent_dim_vf = width
        self.actor, self.critic = (
            torch.nn.Sequential(
                torch.nn.Linear(size, width),
                torch.nn.Tanh(),
                torch.nn.Linear(width, width),
                torch.nn.Tanh(),
            )
            for size in (seen, whole)
        )

    def forward(self, features: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        return self.forward_actor(features), self.forward_critic(features)

    def forward_actor(self, features: torch.Tensor) -> torch.Tensor:
        return self.actor(features[..., : self.seen])

    def forward_critic(self, features: torch.Tensor) -> torch.Tensor:
        return self.critic(features)


class CentralisedCriticPolicy(ActorCriticPolicy):
    """An SB3 policy whose critic sees more than its actor."""

    def __init__(self, *args: Any, seen: int, **kwargs: Any) -> None:
        self.seen = seen
        super().__init__(*args, **kwargs)

    def _build_mlp_extractor(self) -> None:
        self.mlp_extractor = TwoViews(self.seen, self.features_dim)


def train(samples: int, flocks: int, seed: int, **options: Any) -> PPO:
    """Return a trained policy."""
    env = LeaderVecEnv(flocks, **options)
    seen = env.observation_space.shape[0]
    model = PPO(
        CentralisedCriticPolicy,
        WithState(env),
        n_steps=256,
        batch_size=256,
        gamma=0.995,
        policy_kwargs={"seen": seen},
        device="cpu",
        verbose=1,
    )
    # PPO's own `seed` would seed the environment with seeds of evaluations.
    model.set_random_seed(seed)
    model.get_env().seed(POLICY_SEEDS["centralized critic"].seeds(1, seed)[0])
    return model.learn(samples)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=200_000)
    parser.add_argument("--flocks", type=int, default=16)
    parser.add_argument("--seed", type=run_number, default=0)
    parser.add_argument("--out", type=Path, default=Path("results/centralized_critic"))
    options = parser.parse_args(arguments)
    episode = {"target": "random", "episode_s": 120.0}
    with one_line_end(lambda: "nothing was saved"):
        model = train(options.samples, options.flocks, options.seed, **episode)
        options.out.parent.mkdir(parents=True, exist_ok=True)
        model.save(options.out)
    print(f"saved {options.out}.zip")


if __name__ == "__main__":
    main()
