"""How each algorithm of train_levels.py learns.

Each function takes a level, its flock-hours and a seed, and returns a `Trained`.
"""

import argparse
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
from torch import nn

import flockenv
from baselines.evolution_strategy import first_state, next_generation
from flockenv.comparison.levels import LEVEL_IDS, LEVELS
from flockenv.policies import LeaningLaw, NetworkPolicy
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.sb3 import LeaderVecEnv
from flockenv.training.branches import BranchTraining

FLOCKS, GAMMA = 64, 0.99
NETWORK = {"log_std_init": -0.5, "net_arch": [32, 32]}
PAIRS, SIGMA, STEP = 16, 0.1, 0.03
Trained = tuple[NetworkPolicy | Callable[[dict[str, str]], LeaningLaw], float, range]
"""A policy, or what makes it of its provenance; its flock-hours; the seeds that it may have met."""


def options_of(level: str) -> dict[str, Any]:
    """Return the options of a level's environment."""
    return dict(gymnasium.spec(LEVEL_IDS[level]).kwargs)


def baselines3(algorithm: str, level: str, hours: float, seed: int) -> Trained:
    """Learn by PPO, TRPO or A2C of stable-baselines3."""
    from sb3_contrib import TRPO
    from stable_baselines3 import A2C, PPO
    from stable_baselines3.common.utils import LinearSchedule

    venv = LeaderVecEnv(FLOCKS, **options_of(level))
    common = {"gamma": GAMMA, "policy_kwargs": NETWORK, "seed": seed, "device": "cpu"}
    model: Any
    if algorithm == "ppo":
        rate = LinearSchedule(1e-3, 0.0, 1.0)
        own = {"n_steps": 128, "batch_size": 4096, "n_epochs": 6}
        model = PPO("MlpPolicy", venv, rate, **own, **common)
    elif algorithm == "trpo":
        own = {"n_steps": 128, "batch_size": 4096, "target_kl": 0.01}
        model = TRPO("MlpPolicy", venv, **own, **common)
    else:
        model = A2C("MlpPolicy", venv, n_steps=16, **common)
    seeds = POLICY_SEEDS["training"]
    venv.seed(seeds.seeds(1, seed)[0])
    model.learn(round(hours * 3600.0 * venv.decisions_hz) * venv.num_envs // FLOCKS)
    layers = [*model.policy.mlp_extractor.policy_net, model.policy.action_net]
    policy = NetworkPolicy.from_module(nn.Sequential(*layers), venv.observation_space)
    done = model.num_timesteps / venv.num_envs * FLOCKS / venv.decisions_hz / 3600.0
    return policy, done, seeds.seeds(seeds.of_a_run, seed)


def evolution(level: str, hours: float, seed: int) -> Trained:
    """Search by the evolution strategy for rudders that are linear in the observation."""
    options = options_of(level)
    env = flockenv.LeadersVectorEnv(2 * PAIRS, autoreset_mode="disabled", **options)
    size = env.single_observation_space.shape[0] // env.num_leaders
    given = argparse.Namespace(pairs=PAIRS, seed=seed, moving_average=1.0)
    given.sigma, given.learning_rate = SIGMA, STEP
    state, a_generation = first_state(size + 1), 2 * PAIRS * options["episode_s"] / 3600.0
    while (int(state["generation"]) + 1) * a_generation <= hours:
        state = next_generation(state, env, given)
    weights = state["weights"].astype(np.float32)
    layout = {name: options.get(name) for name in ("observation", "mirror_to_target")}
    policy = NetworkPolicy([weights[:-1, None]], [weights[-1:]], **layout)
    seeds = POLICY_SEEDS["evolution strategy"]
    return policy, int(state["generation"]) * a_generation, seeds.seeds(seeds.of_a_run, seed)


def branches(level: str, hours: float, seed: int) -> Trained:
    """Learn in paired branches, in the core."""
    training = BranchTraining(
        LEVELS[level].parameters, seed=seed, action_mode="rudder", flock_hours=hours
    )
    while not training.has_ended:
        training.advance()
    seeds = POLICY_SEEDS["branches"]
    done = training.progress.flock_hours
    return training.policy, done, seeds.seeds(seeds.of_a_run, seed)


LEARNERS: dict[str, tuple[str, str, Callable[[str, float, int], Trained]]] = {
    "trpo": ("TRPO", "policy gradient", lambda *given: baselines3("trpo", *given)),
    "ppo": ("PPO", "policy gradient", lambda *given: baselines3("ppo", *given)),
    "a2c": ("A2C", "policy gradient", lambda *given: baselines3("a2c", *given)),
    "evolution": ("linear evolution", "evolution", evolution),
    "branches": ("paired branches", "branches of a simulator", branches),
}
"""Of each algorithm its name, its class and its training."""
