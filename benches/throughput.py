"""Environment steps per second of flockenv and of others, in one run: `make throughput`.

Every row is measured in a process of its own, in turn, in several rounds; the median counts. The
numbers go to docs/throughput, whose page shows them.
"""

import argparse
import csv
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
from typing import Any

import numpy as np
import tomli_w

ROOT = Path(__file__).parents[1]
PEERS_PYTHON = ROOT / ".venv-peers" / "bin" / "python"
SCENE = {"n_boats": 27, "n_leaders": 4}
POOLS = {"wide": 0.3, "narrow": 0.4}


def vector_env(num_envs: int, pool: str):
    import flockenv

    return flockenv.LeadersVectorEnv(
        num_envs, pool=pool, bw_s=POOLS[pool], autoreset_mode="same_step", **SCENE
    )


def control_step_us(pool: str, seconds: float) -> float:
    """Return microseconds per control step of a flock on one thread, 30 s into the episode."""
    env = vector_env(64, pool)
    env.reset(seed=0)
    actions = np.random.default_rng(0).uniform(-1, 1, (300, *env.action_space.shape))
    for row in actions:
        env.step(row)
    steps, start = 0, time.perf_counter()
    while time.perf_counter() - start < seconds:
        env.step(actions[steps % 300])
        steps += 1
    return (time.perf_counter() - start) / (steps * 64) * 1e6


def single_step_ratio(pool: str, seconds: float) -> float:
    """Return the time of a step of single environments over that of a flock in a batch of 64.

    Both take turns on one thread, from 30 s into their episodes on. The time is processor time, to
    which other programs on the machine do not add.
    """
    import flockenv

    singles = [flockenv.LeadersEnv(pool=pool, bw_s=POOLS[pool], **SCENE) for _ in range(8)]
    batch = vector_env(64, pool)
    for seed, env in enumerate(singles):
        env.reset(seed=seed)
    batch.reset(seed=0)
    actions = np.random.default_rng(0).uniform(-1, 1, (300, *batch.action_space.shape))

    def turn(steps: int) -> tuple[float, float]:
        start = time.process_time()
        for k in range(steps):
            for env, action in zip(singles, actions[k], strict=False):
                env.step(action)
        middle = time.process_time()
        for k in range(steps):
            batch.step(actions[k])
        return (middle - start) / 8, (time.process_time() - middle) / 64

    turn(300)
    ratios: list[float] = []
    end = time.process_time() + seconds
    while time.process_time() < end:
        alone, together = turn(20)
        ratios.append(alone / together)
    return statistics.median(ratios)


def batch_steps_per_s(pool: str, seconds: float) -> float:
    """Return flock control steps per second by Gymnasium's benchmark: 64 flocks, all threads."""
    from gymnasium.utils.performance import benchmark_vector_step

    return benchmark_vector_step(vector_env(64, pool), target_duration=seconds, seed=0)


class Canned:
    """A core that returns one stored result, so that only the interface around it takes time."""

    def __init__(self, core, rows: int) -> None:
        self.core = core
        self.result = core.step(np.zeros(rows))

    def step(self, actions):
        return self.result

    def __getattr__(self, name: str):
        return getattr(self.core, name)


def vec_env_overhead_us(seconds: float) -> float:
    """Return microseconds per sample that LeaderVecEnv adds to the core's own step, at 64 slots."""
    from flockenv.sb3 import LeaderVecEnv

    env = LeaderVecEnv(16, **SCENE)
    env.reset()
    env._batch.core = Canned(env._batch.core, env.num_envs)
    actions = np.zeros((64, 1), np.float32)
    best = np.inf
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        start = time.perf_counter()
        for _ in range(2000):
            env.step(actions)
        best = min(best, (time.perf_counter() - start) / 2000)
    return best / 64 * 1e6


def ppo_environment_share(seconds: float) -> float:
    """Return the share of the environment in PPO's time, in %.

    PPO has 64 slots, 64 steps, batch 512 and 10 epochs.
    """
    from stable_baselines3 import PPO

    from flockenv.sb3 import LeaderVecEnv

    spent = 0.0

    class Timed(LeaderVecEnv):
        def step(self, actions):
            nonlocal spent
            start = time.perf_counter()
            result = super().step(actions)
            spent += time.perf_counter() - start
            return result

    model = PPO(
        "MlpPolicy", Timed(16, **SCENE), n_steps=64, batch_size=512, n_epochs=10, device="cpu"
    )
    model.learn(64 * 64)
    spent, start = 0.0, time.perf_counter()
    while time.perf_counter() - start < seconds:
        model.learn(64 * 64, reset_num_timesteps=False)
    return 100 * spent / (time.perf_counter() - start)


#: Rows measured here: name, function of seconds, threads of the simulator (None: all).
OWN: dict[str, tuple[Callable[[float], float], str | None]] = {
    "step wide": (lambda seconds: control_step_us("wide", seconds), "1"),
    "step narrow": (lambda seconds: control_step_us("narrow", seconds), "1"),
    "single wide": (lambda seconds: single_step_ratio("wide", seconds), "1"),
    "single narrow": (lambda seconds: single_step_ratio("narrow", seconds), "1"),
    "batch wide": (lambda seconds: batch_steps_per_s("wide", seconds), None),
    "batch narrow": (lambda seconds: batch_steps_per_s("narrow", seconds), None),
    "vec env overhead": (vec_env_overhead_us, "1"),
    "ppo share": (ppo_environment_share, None),
}


#: Name of each row in the table, and its unit.
NAMES = {
    "step wide": ("control step of a flock, one core, wide, bw 0.3 s", "µs"),
    "step narrow": ("control step of a flock, one core, narrow, bw 0.4 s", "µs"),
    "single wide": ("step of a single environment over a flock's in a batch of 64, wide", "times"),
    "single narrow": (
        "step of a single environment over a flock's in a batch of 64, narrow",
        "times",
    ),
    "batch wide": ("64 flocks, wide", "flock steps/s"),
    "batch narrow": ("64 flocks, narrow", "flock steps/s"),
    "vec env overhead": ("overhead of LeaderVecEnv at 64 slots", "µs per sample"),
    "ppo share": ("share of the environment in the time of SB3's PPO", "%"),
    "vmas": ("VMAS flocking, 27 agents, 64 environments", "environment steps/s"),
    "mpe2": ("MPE2 simple_spread, 27 agents", "environment steps/s"),
}
PEERS = ("vmas", "mpe2")


def measure(row: str, seconds: float) -> float:
    """Take one measurement in a process of its own."""
    environment = dict(os.environ)
    if row in OWN:
        command = [sys.executable, __file__, "--row", row, "--seconds", str(seconds)]
        if (threads := OWN[row][1]) is not None:
            environment["RAYON_NUM_THREADS"] = threads
    else:
        command = [str(PEERS_PYTHON), "-W", "ignore", str(ROOT / "benches" / "peers.py"), row]
        command.append(str(seconds))
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])["value"]


def peer_version(name: str) -> str:
    code = f"from importlib.metadata import version; print(version({name!r}))"
    return subprocess.check_output([str(PEERS_PYTHON), "-c", code], text=True).strip()


def processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    named = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    return named[0] if named else platform.processor()


def provenance(rounds: int, seconds: float) -> dict[str, Any]:
    """Return the date, the machine and the settings of a measurement."""
    from flockenv import _core

    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    return {
        "date": time.strftime("%Y-%m-%d"),
        "machine": f"{processor()}, {os.cpu_count()} cores, {platform.system()} "
        f"{platform.machine()}, Python {platform.python_version()}, "
        f"flockenv {version('flockenv')} {'with' if _core.USES_AVX2 else 'without'} AVX2",
        "load": round(load, 1),
        "rounds": rounds,
        "seconds": seconds,
    }


def four_digits(value: float) -> str:
    """Return a number of four significant digits, without an exponent."""
    return f"{float(f'{value:.4g}'):.12g}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--row", choices=OWN, help="measure one row and print it as JSON")
    parser.add_argument("--rows", nargs="+", choices=NAMES, help="measure these alone again")
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "throughput")
    options = parser.parse_args()
    if options.row:
        print(json.dumps({"value": OWN[options.row][0](options.seconds)}))
        return
    rows = options.rows or list(NAMES)
    measured: dict[str, list[float]] = {row: [] for row in rows}
    for _ in range(options.rounds):
        for row, values in measured.items():
            values.append(measure(row, options.seconds))
            print(f"{row:>18}: {values[-1]:,.4g}", flush=True)
    options.out.mkdir(parents=True, exist_ok=True)
    write_table(options.out / "environments.csv", measured)
    if not options.rows:
        written = {
            **provenance(options.rounds, options.seconds),
            **{n: peer_version(n) for n in PEERS},
        }
        (options.out / "environments.toml").write_text(tomli_w.dumps(written), encoding="utf-8")


def write_table(path: Path, measured: dict[str, list[float]]) -> None:
    """Write the measured rows into the table; other rows stay as they are."""
    table = {}
    if path.exists():
        with path.open(encoding="utf-8", newline="") as file:
            table = {line[0]: line for line in csv.reader(file)}
    for row, values in measured.items():
        numbers = (statistics.median(values), min(values), max(values))
        table[NAMES[row][0]] = [*NAMES[row], *map(four_digits, numbers)]
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["row", "unit", "median", "least", "most"])
        writer.writerows(table[name] for name, _ in NAMES.values() if name in table)


if __name__ == "__main__":
    main()
