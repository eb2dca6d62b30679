"""Samples per second of each learner's interface beside the batch: `make throughput`.

Every row is measured in a process of its own, in turn, in several rounds, each with the Python of
the library that it measures. A row is compared with the batch of its own round. The numbers go to
docs/throughput, whose page shows them.
"""

import argparse
import csv
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import tomli_w
from throughput import POOLS, ROOT, SCENE, provenance

FLOCKS = 64
OUT = ROOT / "docs" / "throughput"
FLOCK = {"pool": "wide", "bw_s": POOLS["wide"], **SCENE}
LEADERS = FLOCK["n_leaders"]


def rate(step: Callable[[], object], samples: int, seconds: float) -> float:
    """Return samples per second of a step that takes `samples`, after 20 steps of warm-up."""
    for _ in range(20):
        step()
    steps, start = 0, time.perf_counter()
    while time.perf_counter() - start < seconds:
        step()
        steps += 1
    return steps * samples / (time.perf_counter() - start)


def rudders() -> np.ndarray:
    """Return random rudders, shape (flocks, leaders)."""
    return np.random.default_rng(0).uniform(-1, 1, (FLOCKS, LEADERS)).astype(np.float32)


def batch(seconds: float) -> float:
    from flockenv.envs.batch import LeaderBatch
    from flockenv.envs.options import EnvOptions

    flocks = LeaderBatch(EnvOptions.parse(FLOCK), [LEADERS] * FLOCKS, "same_step")
    flocks.reset(range(FLOCKS), None, int)
    flat = rudders().astype(np.float64).reshape(-1)
    return rate(lambda: flocks.core.step(flat), flat.size, seconds)


def vector(seconds: float) -> float:
    import flockenv

    env = flockenv.LeadersVectorEnv(FLOCKS, autoreset_mode="same_step", **FLOCK)
    env.reset(seed=0)
    actions = rudders()
    return rate(lambda: env.step(actions), actions.size, seconds)


def sb3(seconds: float) -> float:
    from flockenv.sb3 import LeaderVecEnv

    env = LeaderVecEnv(FLOCKS, **FLOCK)
    env.seed(0)
    env.reset()
    actions = rudders().reshape(-1, 1)
    return rate(lambda: env.step(actions), actions.size, seconds)


def torchrl_steps(env, action, seconds: float) -> float:
    """Return samples per second of TorchRL's own loop, which resets episodes that have ended."""
    import torch

    env.set_seed(0)
    data = env.reset()

    def step() -> None:
        nonlocal data
        _, data = env.step_and_maybe_reset(data.update(action))

    with torch.no_grad():
        return rate(step, FLOCKS * LEADERS, seconds)


def leader_actions():
    import torch
    from tensordict import TensorDict

    action = torch.from_numpy(rudders()).unsqueeze(-1)
    leaders = TensorDict({"action": action}, [FLOCKS, LEADERS])
    return TensorDict({"leaders": leaders}, [FLOCKS])


def torchrl(seconds: float, state: str = "none") -> float:
    from flockenv.torchrl import LeadersEnv

    env = LeadersEnv(FLOCKS, state=state, **FLOCK)
    return torchrl_steps(env, leader_actions(), seconds)


def gym_wrapper(seconds: float) -> float:
    import torch
    from tensordict import TensorDict
    from torchrl.envs import GymWrapper

    import flockenv

    env = GymWrapper(flockenv.LeadersVectorEnv(FLOCKS, autoreset_mode="disabled", **FLOCK))
    action = TensorDict({"action": torch.from_numpy(rudders())}, [FLOCKS])
    return torchrl_steps(env, action, seconds)


def benchmarl(seconds: float) -> float:
    """Return samples per second of a task with the transforms that BenchMARL adds."""
    from torchrl.envs import TransformedEnv

    from flockenv.benchmarl import LeadersTask

    task = LeadersTask.LEADERS.get_task({**FLOCK, "state": "features"})
    env = task.get_env_fun(FLOCKS, True, 0, "cpu")()
    env = TransformedEnv(env, task.get_reward_sum_transform(env))
    return torchrl_steps(env, leader_actions(), seconds)


def rllib_samples(config, runner, seconds: float, samples: int) -> float:
    """Return samples per second of RLlib's environment runner with random actions."""
    sampler = runner(config=config)
    steps, start = 0, None
    sampler.sample(num_timesteps=FLOCKS, random_actions=True)
    start = time.perf_counter()
    while time.perf_counter() - start < seconds:
        episodes = sampler.sample(num_timesteps=20 * FLOCKS, random_actions=True)
        steps += sum(len(episode) for episode in episodes)
    return steps * samples / (time.perf_counter() - start)


def rllib_joint(seconds: float, mode: str) -> float:
    from ray.rllib.algorithms.ppo import PPOConfig
    from ray.rllib.core.rl_module.rl_module import RLModuleSpec
    from ray.rllib.env.single_agent_env_runner import SingleAgentEnvRunner

    import flockenv  # noqa: F401 - registers the environment
    from flockenv.rllib import LeadersModule

    config = (
        PPOConfig()
        .environment("flockenv/Leaders-v0", env_config=FLOCK)
        .env_runners(num_env_runners=0, num_envs_per_env_runner=FLOCKS, gym_env_vectorize_mode=mode)
        .rl_module(rl_module_spec=RLModuleSpec(LeadersModule))
    )
    return rllib_samples(config, SingleAgentEnvRunner, seconds, LEADERS)


def rllib_agents(seconds: float) -> float:
    from ray.rllib.algorithms.ppo import PPOConfig
    from ray.rllib.env.multi_agent_env_runner import MultiAgentEnvRunner
    from ray.rllib.env.wrappers.pettingzoo_env import ParallelPettingZooEnv
    from ray.tune.registry import register_env

    import flockenv

    register_env("leaders", lambda config: ParallelPettingZooEnv(flockenv.parallel_env(**config)))
    config = (
        PPOConfig()
        .environment("leaders", env_config=FLOCK)
        .env_runners(num_env_runners=0, num_envs_per_env_runner=FLOCKS)
        .multi_agent(policies={"leader"}, policy_mapping_fn=lambda *args, **kwargs: "leader")
    )
    return rllib_samples(config, MultiAgentEnvRunner, seconds, LEADERS)


#: Rows: name in the table, function that measures, and the environment whose Python it needs.
ROWS: dict[str, tuple[str, Callable[[float], float], str]] = {
    "batch": ("the batch itself", batch, ".venv"),
    "vector": ("LeadersVectorEnv, in the file of PPO", vector, ".venv"),
    "sb3": ("flockenv.sb3.LeaderVecEnv", sb3, ".venv"),
    "torchrl": ("TorchRL, LeadersEnv without a state", torchrl, ".venv"),
    "torchrl features": (
        "TorchRL, LeadersEnv with features of the flock",
        lambda seconds: torchrl(seconds, "features"),
        ".venv",
    ),
    "torchrl boats": (
        "TorchRL, LeadersEnv with the global state",
        lambda seconds: torchrl(seconds, "boats"),
        ".venv",
    ),
    "torchrl GymWrapper": ("TorchRL, GymWrapper on LeadersVectorEnv", gym_wrapper, ".venv"),
    "benchmarl": (
        "BenchMARL, with features of the flock and sums of rewards",
        benchmarl,
        ".venv-benchmarl",
    ),
    "rllib native": (
        "RLlib, LeadersVectorEnv",
        lambda seconds: rllib_joint(seconds, "vector_entry_point"),
        ".venv-rllib",
    ),
    "rllib sync": (
        "RLlib, single flocks in a loop",
        lambda seconds: rllib_joint(seconds, "sync"),
        ".venv-rllib",
    ),
    "rllib agents": (
        "RLlib, leaders as agents of single flocks in a loop",
        rllib_agents,
        ".venv-rllib",
    ),
}
PACKAGES = {".venv": ["torchrl", "stable-baselines3"], ".venv-benchmarl": ["benchmarl", "torchrl"]}
PACKAGES[".venv-rllib"] = ["ray"]


def measure(row: str, seconds: float) -> float:
    """Take one measurement in a process of its own."""
    python = ROOT / ROWS[row][2] / "bin" / "python"
    command = [python, "-W", "ignore", __file__, "--row", row, "--seconds", str(seconds)]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{row} failed:\n{done.stderr}")
    return json.loads(done.stdout.splitlines()[-1])["value"]


def versions() -> str:
    """Return the versions of the libraries, each in its environment."""
    code = "import sys; from importlib.metadata import version as v; print([v(n) for n in {!r}])"
    parts = []
    for environment, names in PACKAGES.items():
        python = ROOT / environment / "bin" / "python"
        out = subprocess.check_output([python, "-c", code.format(names)], text=True)
        versions = json.loads(out.replace("'", '"'))
        named = zip(names, versions, strict=True)
        parts.append(" and ".join(f"{name} {version}" for name, version in named))
    return "; ".join(parts)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--row", choices=ROWS, help="measure one row and print it as JSON")
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    if options.row:
        print(json.dumps({"value": ROWS[options.row][1](options.seconds)}))
        return
    measured: dict[str, list[float]] = {row: [] for row in ROWS}
    for _ in range(options.rounds):
        for row, rates in measured.items():
            rates.append(measure(row, options.seconds))
            print(f"{row:>20}: {rates[-1]:,.4g} samples/s", flush=True)
    OUT.mkdir(parents=True, exist_ok=True)
    with (OUT / "learners.csv").open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        columns = ["interface", "samples/s", "least", "most"]
        table.writerow(
            [*columns, *(f"{name} of the batch" for name in ("median", "least", "most"))]
        )
        for row, rates in measured.items():
            ratios = [rate / batch for rate, batch in zip(rates, measured["batch"], strict=True)]
            table.writerow(
                [
                    ROWS[row][0],
                    *(
                        f"{number:.0f}"
                        for number in (statistics.median(rates), min(rates), max(rates))
                    ),
                    *(
                        f"{ratio:.3f}"
                        for ratio in (statistics.median(ratios), min(ratios), max(ratios))
                    ),
                ]
            )
    written = {**provenance(options.rounds, options.seconds), "libraries": versions()}
    (OUT / "learners.toml").write_text(tomli_w.dumps(written), encoding="utf-8")


if __name__ == "__main__":
    sys.path.append(str(Path(__file__).parent))
    main()
