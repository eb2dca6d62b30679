"""How each algorithm of train_levels.py learns.

Each function takes a level, its flock-hours, a seed and the `Curve` of the training, and returns a
`Trained`. IPPO and MAPPO come from BenchMARL, which needs an environment of its own.
"""

import argparse
import tempfile
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
from stable_baselines3.common.callbacks import BaseCallback
from torch import nn

import flockenv
from baselines.evolution_strategy import first_state, next_generation
from flockenv.comparison.levels import LEVEL_IDS, LEVELS
from flockenv.policies import LeaningLaw, NetworkPolicy
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.sb3 import LeaderVecEnv
from flockenv.training.branches import BranchTraining
from studies.levels.level_curves import Curve

FLOCKS, GAMMA = 64, 0.99
NETWORK = {"log_std_init": -0.5, "net_arch": [32, 32]}
PAIRS, SIGMA, STEP = 16, 0.1, 0.03
Trained = tuple[NetworkPolicy | Callable[[dict[str, str]], LeaningLaw], float, range]
"""A policy, or what makes it of its provenance; its flock-hours; the seeds that it may have met."""


def options_of(level: str) -> dict[str, Any]:
    """Return the options of a level's environment."""
    return dict(gymnasium.spec(LEVEL_IDS[level]).kwargs)


def shared(layers: list[Any], venv: LeaderVecEnv, *, squashed: bool = False) -> NetworkPolicy:
    """Return the network of all leaders as a policy."""
    return NetworkPolicy.from_module(
        nn.Sequential(*layers), venv.observation_space, squashed=squashed
    )


def learned(model: Any, venv: LeaderVecEnv) -> NetworkPolicy:
    """Return the mean action of a model of stable-baselines3."""
    policy = model.policy
    if hasattr(policy, "actor"):
        return shared([*policy.actor.latent_pi, policy.actor.mu], venv, squashed=True)
    return shared([*policy.mlp_extractor.policy_net, policy.action_net], venv)


class Look(BaseCallback):
    """Looks at a model of stable-baselines3 before each of its rollouts."""

    def __init__(self, curve: Curve, venv: LeaderVecEnv) -> None:
        super().__init__()
        self.curve, self.venv = curve, venv

    def _on_rollout_start(self) -> None:
        done = flock_hours(self.num_timesteps, self.venv)
        self.curve.look(done, lambda: learned(self.model, self.venv))

    def _on_step(self) -> bool:
        return True


def flock_hours(timesteps: int, venv: LeaderVecEnv) -> float:
    """Return the simulated time of all flocks together, by the decisions of all leaders."""
    return timesteps / venv.num_envs * FLOCKS / venv.decisions_hz / 3600.0


def baselines3(algorithm: str, level: str, hours: float, seed: int, curve: Curve) -> Trained:
    """Learn by PPO, SAC or A2C of stable-baselines3, or by TRPO beside it."""
    from sb3_contrib import TRPO
    from stable_baselines3 import A2C, PPO, SAC
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
    elif algorithm == "sac":
        common["policy_kwargs"] = {"net_arch": NETWORK["net_arch"]}
        model = SAC("MlpPolicy", venv, **common)
    else:
        model = A2C("MlpPolicy", venv, n_steps=16, **common)
    seeds = POLICY_SEEDS["training"]
    venv.seed(seeds.seeds(1, seed)[0])
    steps = round(hours * 3600.0 * venv.decisions_hz) * venv.num_envs // FLOCKS
    model.learn(steps, callback=Look(curve, venv))
    done = flock_hours(model.num_timesteps, venv)
    return learned(model, venv), done, seeds.seeds(seeds.of_a_run, seed)


def benchmarl(algorithm: str, level: str, hours: float, seed: int, curve: Curve) -> Trained:
    """Learn by IPPO or MAPPO of BenchMARL; the critic of MAPPO sees the whole flock."""
    from benchmarl.experiment import Callback

    from flockenv.benchmarl import network_policy
    from studies.suite.multi_agent import MultiAgent

    class Watch(Callback):
        def on_train_end(self, training_td: object, group: str) -> None:
            done = self.experiment.total_frames / a_flock_hour
            curve.look(done, lambda: network_policy(self.experiment))

    options = options_of(level)
    a_flock_hour, seeds = 3600.0 * options["control_hz"], POLICY_SEEDS["training"]
    training = MultiAgent(
        algorithm,
        seed,
        frames=round(hours * a_flock_hour),
        flocks=FLOCKS,
        steps=128,
        minibatch=1024,
        epochs=6,
        learning_rate=1e-3,
        gamma=GAMMA,
        lmbda=0.95,
        hidden=NETWORK["net_arch"],
        critic=NETWORK["net_arch"],
    )
    with tempfile.TemporaryDirectory() as folder:
        experiment, watch = training.experiment(options, folder), Watch()
        # It pickles those that it is made with.
        watch.experiment = experiment
        experiment.callbacks.append(watch)
        experiment.run()
        done = experiment.total_frames / a_flock_hour
        return network_policy(experiment), done, seeds.seeds(seeds.of_a_run, seed)


def evolution(level: str, hours: float, seed: int, curve: Curve) -> Trained:
    """Search by the evolution strategy for rudders that are linear in the observation."""
    options = options_of(level)
    env = flockenv.LeadersVectorEnv(2 * PAIRS, autoreset_mode="disabled", **options)
    size = env.single_observation_space.shape[0] // env.num_leaders
    given = argparse.Namespace(pairs=PAIRS, seed=seed, moving_average=1.0)
    given.sigma, given.learning_rate = SIGMA, STEP
    state, a_generation = first_state(size + 1), 2 * PAIRS * options["episode_s"] / 3600.0
    layout = {name: options.get(name) for name in ("observation", "mirror_to_target")}

    def linear() -> NetworkPolicy:
        weights = state["weights"].astype(np.float32)
        return NetworkPolicy([weights[:-1, None]], [weights[-1:]], **layout)

    while (int(state["generation"]) + 1) * a_generation <= hours:
        state = next_generation(state, env, given)
        curve.look(int(state["generation"]) * a_generation, linear)
    seeds = POLICY_SEEDS["evolution strategy"]
    done = int(state["generation"]) * a_generation
    return linear(), done, seeds.seeds(seeds.of_a_run, seed)


def branches(level: str, hours: float, seed: int, curve: Curve) -> Trained:
    """Learn in paired branches, in the core."""
    training = BranchTraining(
        LEVELS[level].parameters, seed=seed, action_mode="rudder", flock_hours=hours
    )
    while not training.has_ended:
        training.advance()
        curve.look(training.progress.flock_hours, training.policy)
    seeds = POLICY_SEEDS["branches"]
    done = training.progress.flock_hours
    return training.policy, done, seeds.seeds(seeds.of_a_run, seed)


LEARNERS: dict[str, tuple[str, str, Callable[[str, float, int, Curve], Trained]]] = {
    "trpo": ("TRPO", "policy gradient", lambda *given: baselines3("trpo", *given)),
    "ppo": ("PPO", "policy gradient", lambda *given: baselines3("ppo", *given)),
    "a2c": ("A2C", "policy gradient", lambda *given: baselines3("a2c", *given)),
    "sac": ("SAC", "actor and critic from a buffer", lambda *given: baselines3("sac", *given)),
    "ippo": ("IPPO", "policy gradient", lambda *given: benchmarl("ippo", *given)),
    "mappo": ("MAPPO", "policy gradient", lambda *given: benchmarl("mappo", *given)),
    "evolution": ("linear evolution", "evolution", evolution),
    "branches": ("paired branches", "branches of a simulator", branches),
}
"""Of each algorithm its name, its class and its training."""
