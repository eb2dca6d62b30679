"""Train learners from nothing in the levels of suite v3, and enter them.

    python -m studies.levels.train_levels                       # order-easy, 30 flock-hours
    python -m studies.levels.train_levels --levels order-noisy --flock-hours 100

Design, fixed before the runs:

- Levels. Those of `flockenv.comparison.levels`: leaders choose rudders, and no law is in their
  action, start or reward, which is the signed order. All see the level's default observation, but
  paired branches, which see the 29 lean features.
- Algorithms, each with one setting. PPO has that of docs/train.md. TRPO and A2C have its network,
  discount, flocks and first exploration; TRPO a divergence of 0.01 per step, A2C rollouts of 16
  decisions, and both the other defaults of their libraries. Linear evolution is that of
  baselines/evolution_strategy.py: 16 antithetic pairs of an episode, weights that start at 0, a
  spread of 0.1 and steps of 0.03. Paired branches are `flockenv train --algorithm branches --set
  action_mode=rudder`. The settings of PPO and of paired branches were chosen in order-easy before,
  in flock-hours that nobody recorded; the others are first guesses.
- Trainings. Seeds 0 to 9, seed by seed, each for all algorithms, with 30 flock-hours; then 100 and
  300. If the time ends early, all that were trained count.
- Judgment. 512 common flocks of the level, by the policy's mean action (`score_levels.py`). The
  score is (order - no steering) / (damped law - no steering).
- Answer. Two algorithms differ if the 95 % interval of the difference of their mean scores, over
  seeds and flocks, leaves out 0. Beside it stand the probability that a training of the one is
  better than one of the other, and p by permutation of the trainings, as it is and by Holm.

Recurrent PPO, SAC, TQC, IPPO and MAPPO have no setting here yet. A policy that is there is not made
again, so that an interrupted command goes on. ENTRIES/ALGORITHM-HOURS has the policies, and the
file beside it is the entry for `flockenv compare --suite v3`.
"""

import argparse
import time
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import tomli_w
import torch
from torch import nn

import flockenv
from baselines.evolution_strategy import first_state, next_generation
from flockenv.comparison.levels import LEVEL_IDS, LEVELS, SUITE
from flockenv.policies import LeaningLaw, NetworkPolicy, load
from flockenv.policies.provenance import provenance_of
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.runs.store import RESULTS_VERSION
from flockenv.sb3 import LeaderVecEnv
from flockenv.training.branches import BranchTraining
from studies.study import StudyError, run, write

ENTRIES = Path("studies/levels/entries")
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


def made(folder: Path, level: str) -> dict[int, Path]:
    """Return the policies of a level that are there, by seed."""
    found = (path for path in folder.glob(f"{level}-*.*") if path.suffix in (".json", ".npz"))
    return dict(sorted((int(path.stem.rpartition("-")[2]), path) for path in found))


def make(algorithm: str, level: str, hours: float, seed: int, folder: Path) -> None:
    """Train a policy, unless it is there."""
    if seed in made(folder, level):
        return
    start = time.process_time()
    torch.manual_seed(seed)
    policy, done, seeds = LEARNERS[algorithm][2](level, hours, seed)
    cpu_s = time.process_time() - start
    command = (
        f"python -m studies.levels.train_levels --levels {level} --algorithms {algorithm} "
        f"--flock-hours {hours:g} --seeds {seed}"
    )
    samples = round(done * 3600.0 * 2.5) * LEVELS[level].parameters.n_leaders
    origin = provenance_of(command, seed=seed, samples=samples, cpu_s=cpu_s, flock_hours=done)
    origin |= {"results_version": str(RESULTS_VERSION)}
    origin |= {"training_seeds": f"{seeds[0]}-{seeds[-1]}"}
    folder.mkdir(parents=True, exist_ok=True)
    if callable(policy):
        policy(origin).save(folder / f"{level}-{seed}.json")
    else:
        policy.provenance = origin
        policy.save(folder / f"{level}-{seed}.npz")
    print(f"{algorithm}, {level}, seed {seed}: {done:.1f} flock-hours, {cpu_s:.0f} s", flush=True)


def enter(algorithm: str, folder: Path) -> None:
    """Write the entry of an algorithm's policies beside their folder."""
    name, kind, _ = LEARNERS[algorithm]
    levels = {level: list(made(folder, level).values()) for level in LEVELS}
    origins = [_origin(path) for paths in levels.values() for path in paths]
    versions = {origin["results_version"] for origin in origins}
    if versions != {str(RESULTS_VERSION)}:
        raise StudyError(f"{folder} has policies of results versions {sorted(versions)}")
    seeds = [int(end) for origin in origins for end in origin["training_seeds"].split("-")]
    entry = {
        "suite": SUITE,
        "results_version": RESULTS_VERSION,
        "name": name,
        "class": kind,
        "link": "studies/levels/train_levels.py",
        "flock_hours": max(float(origin["flock_hours"]) for origin in origins),
        "training_seeds": [min(seeds), max(seeds)],
        "levels": {
            level: [f"{folder.name}/{path.name}" for path in paths]
            for level, paths in levels.items()
            if paths
        },
    }
    write(folder.with_name(f"{folder.name}.toml"), tomli_w.dumps(entry).encode())


def _origin(path: Path) -> dict[str, str]:
    found: Any = load(path)
    return dict(found.provenance)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--levels", nargs="+", choices=[*LEVELS], default=["order-easy"])
    parser.add_argument("--algorithms", nargs="+", choices=[*LEARNERS], default=[*LEARNERS])
    parser.add_argument("--flock-hours", type=float, default=30.0)
    parser.add_argument("--seeds", nargs="+", type=int, default=[*range(10)])
    parser.add_argument("--entries", type=Path, default=ENTRIES)
    options = parser.parse_args(arguments)
    torch.set_num_threads(1)
    for seed in options.seeds:
        for level, algorithm in product(options.levels, options.algorithms):
            folder = options.entries / f"{algorithm}-{options.flock_hours:g}"
            make(algorithm, level, options.flock_hours, seed, folder)
            enter(algorithm, folder)


if __name__ == "__main__":
    run(main)
