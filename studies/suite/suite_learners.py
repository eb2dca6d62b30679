"""How each of the seven algorithms of suite_grid.py learns.

Each function takes a `Training` and returns its policy. PPO and SAC come from stable-baselines3,
TRPO and recurrent PPO of sb3-contrib, IPPO and MAPPO of BenchMARL.
"""

import argparse
import tempfile
import time
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import torch
from torch import nn

import flockenv
from baselines.evolution_strategy import next_generation
from flockenv.policies import NetworkPolicy
from flockenv.runs.seeds import POLICY_SEEDS
from studies.flocks import lean
from studies.suite.multi_agent import MultiAgent

TASK: dict[str, Any] = {
    **lean("wide", 480.0),
    "target": "random",
    "mirror_to_target": True,
    "reward": {"signed_order": 1.0, "contact_alignment": 30.0},
    "reward_horizon_s": 40.0,
}
INPUTS: dict[str, tuple[dict[str, Any], list[int]]] = {
    "lean-linear": (TASK["observation"], []),
    "lean-network": (TASK["observation"], [32, 32]),
    "default-network": ({}, [32, 32]),
}


@dataclass(frozen=True)
class Training:
    """One training."""

    algorithm: str
    input: str
    #: Learning rate; of TRPO the divergence of a step, of evolution the spread of the candidates.
    setting: float
    seed: int
    flock_hours: float
    #: Flocks that are stepped together, and pairs of a generation of the evolution strategy.
    flocks: int = 128
    pairs: int = 16


def baselines3(given: Training) -> Any:
    """Learn by PPO of stable-baselines3, or by TRPO, recurrent PPO or SAC beside it."""
    from stable_baselines3 import SAC
    from stable_baselines3.common.utils import LinearSchedule

    from flockenv.training.ppo import TrainingSettings

    observation, hidden = INPUTS[given.input]
    arch: dict[str, Any] = {"net_arch": {"pi": hidden, "vf": [64, 64]}}
    rate = (
        {} if given.algorithm == "trpo" else {"learning_rate": LinearSchedule(given.setting, 0, 1)}
    )
    settings = TrainingSettings(
        seed=given.seed,
        flock_hours=given.flock_hours,
        num_flocks=given.flocks,
        environment={"observation": observation},
        ppo={**rate, "policy_kwargs": arch},
    )
    venv = settings.venv()
    model: Any = settings.model(venv)
    common = {"use_sde": True, "seed": given.seed, "device": "cpu", **rate, "gamma": model.gamma}
    if given.algorithm == "trpo":
        from baselines.train_with_trpo import trpo

        model = trpo(settings, venv, given.setting)
    elif given.algorithm == "recurrent-ppo":
        from sb3_contrib import RecurrentPPO

        names = ("n_steps", "batch_size", "n_epochs", "gae_lambda")
        cells = {"lstm_hidden_size": 32, "enable_critic_lstm": False}
        kwargs = {**arch, **cells, "squash_output": True, "log_std_init": -1.5}
        common |= {name: getattr(model, name) for name in names}
        model = RecurrentPPO("MlpLstmPolicy", venv, policy_kwargs=kwargs, **common)
    elif given.algorithm == "sac":
        # The critics' tanh and the mean without a bound: what a policy file takes.
        kwargs = {"activation_fn": nn.Tanh, "clip_mean": 0.0, "log_std_init": -2.4}
        common |= {"train_freq": model.n_steps, "gradient_steps": model.n_steps, "batch_size": 512}
        common |= {"ent_coef": "auto_0.005", "learning_starts": 0, "buffer_size": 500_000}
        kwargs["net_arch"] = {"pi": hidden, "qf": [64, 64]}
        model = SAC("MlpPolicy", venv, policy_kwargs=kwargs, **common)
    venv.seed(POLICY_SEEDS["training"].seeds(1, run=given.seed)[0])
    model.learn(settings.samples(venv))
    if given.algorithm == "recurrent-ppo":
        return model
    policy: Any = model.policy
    if given.algorithm == "sac":
        layers = [*policy.actor.latent_pi, policy.actor.mu]
    else:
        layers = [*policy.mlp_extractor.policy_net, policy.action_net]
    return NetworkPolicy.from_module(nn.Sequential(*layers), venv.observation_space, squashed=True)


def evolution(given: Training) -> NetworkPolicy:
    """Search by the evolution strategy; the last layer starts at zero, which is the tuned law."""
    observation, hidden = INPUTS[given.input]
    pairs, options = given.pairs, {**TASK, "observation": observation}
    env = flockenv.LeadersVectorEnv(2 * pairs, autoreset_mode="disabled", **options)
    sizes = [env.single_observation_space.shape[0] // env.num_leaders, *hidden, 1]
    layers = [(nn.Linear(*each), nn.Tanh()) for each in pairwise(sizes)]
    module = nn.Sequential(*sum(layers, ())[:-1])
    nn.init.zeros_(module[-1].weight), nn.init.zeros_(module[-1].bias)
    parameters = [*module.parameters()]
    ends = np.cumsum([each.numel() for each in parameters])[:-1]

    def steer(weights: np.ndarray, leaders: int) -> Any:
        parts = np.split(weights.astype(np.float32), ends, axis=1)
        own = [p.reshape(-1, *each.shape) for p, each in zip(parts, parameters, strict=True)]

        def leans(seen: np.ndarray) -> np.ndarray:
            rows = seen.reshape(len(seen), leaders, -1)
            for matrix, bias in zip(own[::2], own[1::2], strict=True):
                rows = np.tanh(rows @ matrix.swapaxes(1, 2) + bias[:, None])
            return rows[..., 0]

        return leans

    start = nn.utils.parameters_to_vector(parameters).detach().double().numpy()
    state = {name: np.zeros(len(start)) for name in ("moment_1", "moment_2")}
    state |= {"weights": start, "average": start, "generation": 0, "curve": np.zeros((0, 2))}
    spread = argparse.Namespace(pairs=pairs, seed=given.seed, moving_average=0.3)
    spread.sigma, spread.learning_rate = given.setting, given.setting / 3
    while state["generation"] * 2 * pairs * TASK["episode_s"] < 3600 * given.flock_hours:
        state = next_generation(state, env, spread, steer)
    nn.utils.vector_to_parameters(torch.tensor(state["average"], dtype=torch.float32), parameters)
    return NetworkPolicy.from_module(module, env.single_observation_space, squashed=True)


def benchmarl(given: Training) -> NetworkPolicy:
    """Learn by IPPO or MAPPO of BenchMARL."""
    from flockenv.benchmarl import network_policy

    observation, hidden = INPUTS[given.input]
    steps, hours = 240, given.flock_hours
    rollout = given.flocks * steps
    training = MultiAgent(
        given.algorithm,
        given.seed,
        frames=-(-round(3600 * hours) // rollout) * rollout,
        flocks=given.flocks,
        steps=steps,
        minibatch=rollout // 8,
        epochs=4,
        learning_rate=given.setting,
        gamma=0.995,
        lmbda=0.9875,
        hidden=hidden,
        critic=[64, 64],
    )
    with tempfile.TemporaryDirectory() as folder:
        experiment = training.experiment({**TASK, "observation": observation}, folder)
        experiment.run()
        return network_policy(experiment)


LEARNERS = {"evolution": evolution, "ippo": benchmarl, "mappo": benchmarl}


def learn(given: Training) -> tuple[Any, float]:
    """Return what a training learns, and its seconds of one core."""
    start = time.process_time()
    torch.manual_seed(given.seed)
    return LEARNERS.get(given.algorithm, baselines3)(given), time.process_time() - start
