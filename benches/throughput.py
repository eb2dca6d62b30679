"""Environment steps a second, ours and others', on this machine in one run: `make throughput`.

Every row is measured in a process of its own, in turn, several rounds of them; the median counts.
The page goes to docs/throughput.md.
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

import numpy as np

ROOT = Path(__file__).parents[1]
PEERS_PYTHON = ROOT / ".venv-peers" / "bin" / "python"
SCENE = {"n_boats": 27, "n_leaders": 4}
POOLS = {"500-boats": 0.3, "table-1": 0.4}


def vector_env(num_envs: int, pool: str):
    import flockenv

    return flockenv.LeadersVectorEnv(
        num_envs, pool=pool, bw_s=POOLS[pool], autoreset_mode="same_step", **SCENE
    )


def control_step_us(pool: str, seconds: float) -> float:
    """Microseconds a flock control step on one thread, flocks 30 s into their episode."""
    env = vector_env(64, pool)
    env.reset(seed=0)
    actions = np.random.default_rng(0).uniform(-1, 1, (300, *env.action_space.shape))
    for row in actions:
        env.step(row)
    steps, begin = 0, time.perf_counter()
    while time.perf_counter() - begin < seconds:
        env.step(actions[steps % 300])
        steps += 1
    return (time.perf_counter() - begin) / (steps * 64) * 1e6


def batch_steps_per_s(pool: str, seconds: float) -> float:
    """Flock control steps a second by Gymnasium's own benchmark, 64 flocks, all threads."""
    from gymnasium.utils.performance import benchmark_vector_step

    return benchmark_vector_step(vector_env(64, pool), target_duration=seconds, seed=0)


class Canned:
    """A core that returns what it returned once: what is left is the interface around it."""

    def __init__(self, core) -> None:
        self.core = core
        self.result = core.step(np.zeros(sum(core.leaders)))

    def step(self, actions):
        return self.result

    def __getattr__(self, name: str):
        return getattr(self.core, name)


def vec_env_overhead_us(seconds: float) -> float:
    """Microseconds a sample that LeaderVecEnv adds to the core's own step, at 64 slots."""
    from flockenv.sb3 import LeaderVecEnv

    env = LeaderVecEnv(16, **SCENE)
    env.reset()
    env._batch.core = Canned(env._batch.core)
    actions = np.zeros((64, 1), np.float32)
    best = np.inf
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        begin = time.perf_counter()
        for _ in range(2000):
            env.step(actions)
        best = min(best, (time.perf_counter() - begin) / 2000)
    return best / 64 * 1e6


def ppo_environment_share(seconds: float) -> float:
    """Part of PPO's time in the environment, in %: 64 slots, 64 steps, batch 512, 10 epochs."""
    from stable_baselines3 import PPO

    from flockenv.sb3 import LeaderVecEnv

    spent = 0.0

    class Timed(LeaderVecEnv):
        def step(self, actions):
            nonlocal spent
            begin = time.perf_counter()
            result = super().step(actions)
            spent += time.perf_counter() - begin
            return result

    model = PPO(
        "MlpPolicy", Timed(16, **SCENE), n_steps=64, batch_size=512, n_epochs=10, device="cpu"
    )
    model.learn(64 * 64)
    spent, begin = 0.0, time.perf_counter()
    while time.perf_counter() - begin < seconds:
        model.learn(64 * 64, reset_num_timesteps=False)
    return 100 * spent / (time.perf_counter() - begin)


#: Rows measured here: name, function of seconds, threads of the simulator (None: all).
OWN: dict[str, tuple[Callable[[float], float], str | None]] = {
    "step 500-boats": (lambda seconds: control_step_us("500-boats", seconds), "1"),
    "step table-1": (lambda seconds: control_step_us("table-1", seconds), "1"),
    "batch 500-boats": (lambda seconds: batch_steps_per_s("500-boats", seconds), None),
    "batch table-1": (lambda seconds: batch_steps_per_s("table-1", seconds), None),
    "vec env overhead": (vec_env_overhead_us, "1"),
    "ppo share": (ppo_environment_share, None),
}


def measure(row: str, seconds: float) -> float:
    """One measurement in a process of its own."""
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


def page(found: dict[str, list[float]], seconds: float) -> str:
    """The results as a page."""
    median = {row: statistics.median(values) for row, values in found.items()}
    spread = {row: f"{min(values):.3g}-{max(values):.3g}" for row, values in found.items()}

    def line(row: str, what: str, unit: str, bar: str) -> str:
        return f"| {what} | {median[row]:,.4g} {unit} | {spread[row]} | {bar} |"

    batch = median["batch 500-boats"]
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    lines = [
        "# Throughput",
        "",
        f"Measured by `make throughput` on {time.strftime('%Y-%m-%d')}: {processor()}, "
        f"{os.cpu_count()} cores, {platform.system()} {platform.machine()}, Python "
        f"{platform.python_version()}, flockenv {version('flockenv')}; load average at the end "
        f"{load:.1f}. Every number is the median of {len(found['vmas'])} processes of "
        f"{seconds:g} s each, which took turns; the range is over them.",
        "",
        "27 boats, 4 of them leaders, 10 control steps a second of five substeps of 0.02 s each "
        "(`leapfrog`, white noise, exact contacts), default observation and reward.",
        "",
        "| what | median | range | bar |",
        "| --- | --- | --- | --- |",
        line(
            "step 500-boats",
            "a flock control step on one core, `500-boats`, bw 0.3 s",
            "µs",
            "≤ 20 (goal 7)",
        ),
        line("step table-1", "the same in `table-1`, bw 0.4 s", "µs", "≤ 20 (goal 7)"),
        line(
            "batch 500-boats",
            "64 flocks, `gymnasium.utils.performance.benchmark_vector_step`, `500-boats`",
            "flock steps/s",
            "≥ 80,000 (goal 250,000)",
        ),
        line("batch table-1", "the same in `table-1`", "flock steps/s", ""),
        line("vec env overhead", "what `LeaderVecEnv` adds at 64 slots", "µs a sample", "≤ 0.2"),
        line(
            "ppo share",
            "SB3 PPO's time in the environment (64 slots, 64 steps, batch 512, "
            "10 epochs, MlpPolicy)",
            "%",
            "≤ 10",
        ),
        "",
        "## Peers",
        "",
        "The same number of agents in comparable tasks; an environment step moves all 27 of them.",
        "",
        "| environment | environment steps/s | range | ours over theirs | bar |",
        "| --- | --- | --- | --- | --- |",
        f"| flockenv, 64 flocks, `500-boats` | {batch:,.4g} | {spread['batch 500-boats']} | 1 | |",
    ]
    for row, name, bar in (
        ("vmas", f"VMAS {peer_version('vmas')} `flocking`, 27 agents, 64 environments", "≥ 100"),
        ("mpe2", f"MPE2 {peer_version('mpe2')} `simple_spread`, 27 agents", "≥ 500"),
    ):
        ratio = batch / median[row]
        lines.append(f"| {name} | {median[row]:,.4g} | {spread[row]} | {ratio:,.0f} | {bar} |")
    lines += ["", choices()]
    return "\n".join(lines)


#: What is read of the speed-against-error report: file, scene and number, and its heading here.
ERRORS = {
    "jam, µs a substep": ("speed", "jam", "us_per_step"),
    "cycle, µs a substep": ("speed", "cycle", "us_per_step"),
    "deepest overlap in the jam, cm": ("overlap", "jam", "overlap_max_cm"),
    "sliding for 2 s, cm off": ("slide", None, "slide_median_cm"),
    "Ψ_o off its reference": ("order", None, "psi_o_error"),
    "(95 %)": ("order", None, "psi_o_half_width"),
}


def choices() -> str:
    """How dt and the control rate were chosen, with what the report says of other steps."""
    lines = [
        "## How dt and the control rate were chosen",
        "",
        "Ten control steps a second are the camera's frame rate (Section 2.4), which no leader of "
        "the experiment could exceed. A substep of 0.02 s divides them and the phases evenly. From "
        "the [speed-against-error report](speed_vs_error.md), `leapfrog` with 27 boats:",
        "",
        f"| dt, s | relinearisations | {' | '.join(ERRORS)} |",
        "| ---: " * (2 + len(ERRORS)) + "|",
    ]
    for passes, dt in ((0, 0.01), (0, 0.02), (0, 0.05), (0, 0.1), (1, 0.1)):
        cells = [f"{reported(*where, passes, dt):.2g}" for where in ERRORS.values()]
        lines.append(f"| {dt:g} | {passes} | {' | '.join(cells)} |")
    return "\n".join(
        [
            *lines,
            "",
            "0.02 s is the longest of them that keeps overlaps below 0.01 cm in one pass, and its "
            "order cannot be told from the reference's.",
            "",
        ]
    )


def reported(file: str, scene: str | None, number: str, passes: int, dt: float) -> float:
    """A number of the speed-against-error report for `leapfrog` with the exact solver."""
    path = ROOT / "docs" / "speed_vs_error" / f"{file}.csv"
    with path.open(encoding="utf-8", newline="") as lines:
        for row in csv.DictReader(lines):
            is_setting = row["setting"] == f"leapfrog / block-pivoting / r{passes}"
            is_scene = scene is None or (row["scene"] == scene and row["n"] == "27")
            if is_setting and is_scene and float(row["dt_s"]) == dt:
                return float(row[number])
    raise LookupError(f"{path} does not hold {scene} at {dt} s")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--row", choices=OWN, help="measure one row and print it as JSON")
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "throughput.md")
    options = parser.parse_args()
    if options.row:
        print(json.dumps({"value": OWN[options.row][0](options.seconds)}))
        return
    found: dict[str, list[float]] = {row: [] for row in (*OWN, "vmas", "mpe2")}
    for _ in range(options.rounds):
        for row, values in found.items():
            values.append(measure(row, options.seconds))
            print(f"{row:>18}: {values[-1]:,.4g}", flush=True)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(page(found, options.seconds))
    print(f"written to {options.out}")


if __name__ == "__main__":
    main()
