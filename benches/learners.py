"""Samples per second of each learner's interface beside the batch: `make learners-throughput`.

Every row is measured in a process of its own, in turn, in several rounds, each with the Python of
the library that it measures. A row is compared with the batch of its own round. The numbers go to
docs/learners_throughput.toml, and `make tables` fills the table of docs/learners_throughput.md.
"""

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import numpy as np
import tomli_w
from throughput import POOLS, ROOT, SCENE, processor

FLOCKS = 64
DATA = ROOT / "docs" / "learners_throughput.toml"
FLOCK = {"pool": "wide", "bw_s": POOLS["wide"], **SCENE}
LEADERS = FLOCK["n_leaders"]


def rate(step: Callable[[], object], samples: int, seconds: float) -> float:
    """Return samples per second of a step that takes so many, after some steps to start with."""
    for _ in range(20):
        step()
    steps, start = 0, time.perf_counter()
    while time.perf_counter() - start < seconds:
        step()
        steps += 1
    return steps * samples / (time.perf_counter() - start)


def rudders() -> np.ndarray:
    """Return one rudder per leader."""
    return np.random.default_rng(0).uniform(-1, 1, (FLOCKS, LEADERS)).astype(np.float32)


def batch(seconds: float) -> float:
    from flockenv.envs.batch import LeaderBatch
    from flockenv.envs.options import EnvOptions

    flocks = LeaderBatch(EnvOptions.parse(FLOCK), [LEADERS] * FLOCKS, "same_step")
    flocks.reset(range(FLOCKS), None, int)
    flat = rudders().astype(np.float64).reshape(-1)
    return rate(lambda: flocks.step(flat), flat.size, seconds)


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
    """Return samples per second of TorchRL's own loop, which resets what has ended."""
    import torch

    env.set_seed(0)
    now = [env.reset()]

    def step() -> None:
        _, now[0] = env.step_and_maybe_reset(now[0].update(action))

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
    """Return the rate of a task with what BenchMARL puts around it."""
    from torchrl.envs import TransformedEnv

    from flockenv.benchmarl import LeadersTask

    task = LeadersTask.LEADERS.get_task({**FLOCK, "state": "features"})
    env = task.get_env_fun(FLOCKS, True, 0, "cpu")()
    env = TransformedEnv(env, task.get_reward_sum_transform(env))
    return torchrl_steps(env, leader_actions(), seconds)


def rllib_samples(config, runner, seconds: float, samples: int) -> float:
    """Return the rate of RLlib's environment runner with random actions."""
    sampler = runner(config=config)
    steps, start = 0, None
    sampler.sample(num_timesteps=FLOCKS, random_actions=True)
    start = time.perf_counter()
    while time.perf_counter() - start < seconds:
        episodes = sampler.sample(num_timesteps=20 * FLOCKS, random_actions=True)
        steps += sum(len(each) for each in episodes)
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


#: Rows: name, what it measures, and the environment whose Python it needs.
ROWS: dict[str, tuple[Callable[[float], float], str]] = {
    "batch": (batch, ".venv"),
    "vector": (vector, ".venv"),
    "sb3": (sb3, ".venv"),
    "torchrl": (torchrl, ".venv"),
    "torchrl features": (lambda seconds: torchrl(seconds, "features"), ".venv"),
    "torchrl boats": (lambda seconds: torchrl(seconds, "boats"), ".venv"),
    "torchrl GymWrapper": (gym_wrapper, ".venv"),
    "benchmarl": (benchmarl, ".venv-benchmarl"),
    "rllib native": (lambda seconds: rllib_joint(seconds, "vector_entry_point"), ".venv-rllib"),
    "rllib sync": (lambda seconds: rllib_joint(seconds, "sync"), ".venv-rllib"),
    "rllib agents": (rllib_agents, ".venv-rllib"),
}
PACKAGES = {".venv": ["torchrl", "stable-baselines3"], ".venv-benchmarl": ["benchmarl", "torchrl"]}
PACKAGES[".venv-rllib"] = ["ray"]


def measure(row: str, seconds: float) -> float:
    """Take one measurement in a process of its own."""
    python = ROOT / ROWS[row][1] / "bin" / "python"
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
    for place, names in PACKAGES.items():
        python = ROOT / place / "bin" / "python"
        out = subprocess.check_output([python, "-c", code.format(names)], text=True)
        found = json.loads(out.replace("'", '"'))
        parts.append(
            " and ".join(f"{name} {each}" for name, each in zip(names, found, strict=True))
        )
    return "; ".join(parts)


def results(found: dict[str, list[float]], seconds: float) -> dict:
    """Return the medians and ranges of rates, and of their ratios to the batch of their round."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    summary: dict = {
        "made": {
            "date": time.strftime("%Y-%m-%d"),
            "machine": f"{processor()}, {os.cpu_count()} cores, {platform.system()} "
            f"{platform.machine()}, Python {platform.python_version()}, "
            f"flockenv {version('flockenv')}",
            "libraries": versions(),
            "load": round(load, 1),
            "rounds": len(found["batch"]),
            "seconds": seconds,
        }
    }
    for row, rates in found.items():
        ratios = [each / own for each, own in zip(rates, found["batch"], strict=True)]
        summary[row] = {
            "median": statistics.median(rates),
            "least": min(rates),
            "most": max(rates),
            "ratio": statistics.median(ratios),
            "ratio_least": min(ratios),
            "ratio_most": max(ratios),
        }
    return summary


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--row", choices=ROWS, help="measure one row and print it as JSON")
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    if options.row:
        print(json.dumps({"value": ROWS[options.row][0](options.seconds)}))
        return
    found: dict[str, list[float]] = {row: [] for row in ROWS}
    for _ in range(options.rounds):
        for row, rates in found.items():
            rates.append(measure(row, options.seconds))
            print(f"{row:>20}: {rates[-1]:,.4g} samples/s", flush=True)
    DATA.write_text(tomli_w.dumps(results(found, options.seconds)), encoding="utf-8")
    print(f"written to {DATA}")


if __name__ == "__main__":
    sys.path.append(str(Path(__file__).parent))
    main()
