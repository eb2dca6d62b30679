"""Environment steps per second of flockenv and of others, in one run: `make throughput`.

Every row is measured in a process of its own, in turn, in several rounds; the median counts. The
numbers go to docs/throughput.toml and the page to docs/throughput.md, which `--page` writes again
from the numbers.
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
import tomllib
from collections.abc import Callable, Mapping
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


def batch_steps_per_s(pool: str, seconds: float) -> float:
    """Return flock control steps per second by Gymnasium's benchmark: 64 flocks, all threads."""
    from gymnasium.utils.performance import benchmark_vector_step

    return benchmark_vector_step(vector_env(64, pool), target_duration=seconds, seed=0)


class Canned:
    """A batch that returns one stored result, which leaves the time of the interface around it."""

    def __init__(self, batch) -> None:
        self.batch = batch
        self.result = batch.step(np.zeros(sum(batch.leaders)))

    def step(self, actions):
        return self.result

    def __getattr__(self, name: str):
        return getattr(self.batch, name)


def vec_env_overhead_us(seconds: float) -> float:
    """Return microseconds per sample that LeaderVecEnv adds to the core's own step, at 64 slots."""
    from flockenv.sb3 import LeaderVecEnv

    env = LeaderVecEnv(16, **SCENE)
    env.reset()
    env._batch = Canned(env._batch)
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
    "batch wide": (lambda seconds: batch_steps_per_s("wide", seconds), None),
    "batch narrow": (lambda seconds: batch_steps_per_s("narrow", seconds), None),
    "vec env overhead": (vec_env_overhead_us, "1"),
    "ppo share": (ppo_environment_share, None),
}


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


def results(found: dict[str, list[float]], seconds: float) -> dict[str, Any]:
    """Return the medians and ranges of the measured values, and what they were measured with."""
    from flockenv import _core

    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    return {
        "made": {
            "date": time.strftime("%Y-%m-%d"),
            "machine": f"{processor()}, {os.cpu_count()} cores, {platform.system()} "
            f"{platform.machine()}, Python {platform.python_version()}, "
            f"flockenv {version('flockenv')} {'with' if _core.USES_AVX2 else 'without'} AVX2",
            "load": round(load, 1),
            "rounds": len(found["vmas"]),
            "seconds": seconds,
            "vmas": peer_version("vmas"),
            "mpe2": peer_version("mpe2"),
        },
        **{
            row: {
                "median": statistics.median(values),
                "least": min(values),
                "most": max(values),
            }
            for row, values in found.items()
        },
    }


def page(found: Mapping[str, Any]) -> str:
    """Return the page of the results."""
    provenance = found["made"]

    def line(row: str, what: str, unit: str) -> str:
        return f"| {what} | {number(found[row]['median'])} {unit} | {spread(found[row])} |"

    batch = found["batch wide"]
    step, narrow = found["step wide"]["median"], found["step narrow"]["median"]
    benchmark = "`gymnasium.utils.performance.benchmark_vector_step`"
    settings = "64 slots, 64 steps, batch 512, 10 epochs, MlpPolicy"
    lines = [
        "# Throughput",
        "",
        f"A control step of one flock takes {step:.3g} µs of one core in the pool `wide` and "
        f"{narrow:.3g} µs in `narrow`. A batch of 64 flocks advances by "
        f"{number(batch['median'], 3)} flock control steps per second on {os_cores(provenance)}.",
        "",
        f"`make throughput` measured all numbers of this page on {provenance['date']}: "
        f"{provenance['machine']}; load average at the end {provenance['load']:.1f}. "
        f"Every number is the median of {provenance['rounds']} processes of "
        f"{provenance['seconds']:g} s each, which took turns. The range is over these processes, "
        "and `docs/throughput.toml` holds the numbers. `make` compiles the core for AVX2 where the "
        "machine has it, to the same bits; wheels and `pip install` do without.",
        "",
        "A flock has 27 boats, 4 of them leaders. It runs 10 control steps per second of five "
        "substeps of 0.02 s each (`leapfrog`, white noise, exact contacts), with the default "
        "observation and reward.",
        "",
        "| quantity | median | range |",
        "| --- | --- | --- |",
        line("step wide", "control step of a flock, one core, `wide`, bw 0.3 s", "µs"),
        line("step narrow", "control step of a flock, one core, `narrow`, bw 0.4 s", "µs"),
        line("batch wide", f"64 flocks, {benchmark}, `wide`", "flock steps/s"),
        line("batch narrow", f"64 flocks, {benchmark}, `narrow`", "flock steps/s"),
        line("vec env overhead", "overhead of `LeaderVecEnv` at 64 slots", "µs per sample"),
        line("ppo share", f"share of the environment in the time of SB3's PPO ({settings})", "%"),
        "",
        "## Other environments",
        "",
        "The peers have the same number of agents in comparable tasks. An environment step moves "
        "all 27 agents.",
        "",
        "| environment | environment steps/s | range | flockenv over peer |",
        "| --- | --- | --- | --- |",
        f"| flockenv, 64 flocks, `wide` | {number(batch['median'])} | {spread(batch)} | 1 |",
    ]
    for row, name in (
        ("vmas", f"VMAS {provenance['vmas']} `flocking`, 27 agents, 64 environments"),
        ("mpe2", f"MPE2 {provenance['mpe2']} `simple_spread`, 27 agents"),
    ):
        median = found[row]["median"]
        ratio = batch["median"] / median
        lines.append(f"| {name} | {number(median)} | {spread(found[row])} | {ratio:,.0f} |")
    lines += ["", choices()]
    return "\n".join(lines)


def spread(row: Mapping[str, float]) -> str:
    """Return the range of a row's values."""
    return f"{number(row['least'], 3)}-{number(row['most'], 3)}"


def number(value: float, digits: int = 4) -> str:
    """Return a number of so many significant digits, without an exponent."""
    return f"{float(f'{value:.{digits}g}'):,g}"


def os_cores(provenance: Mapping[str, Any]) -> str:
    """Return the number of cores that the machine's description names."""
    return next(part for part in provenance["machine"].split(", ") if part.endswith(" cores"))


#: Columns from the speed-against-error report: heading, file, scene and number.
ERRORS = {
    "jam, µs per substep": ("speed", "jam", "us_per_step"),
    "cycle, µs per substep": ("speed", "cycle", "us_per_step"),
    "deepest overlap in the jam, cm": ("overlap", "jam", "overlap_max_cm"),
    "error after sliding for 2 s, cm": ("slide", None, "slide_median_cm"),
    "error of Ψ_o": ("order", None, "psi_o_error"),
    "its 95 % half-width": ("order", None, "psi_o_half_width"),
}


def choices() -> str:
    """Return how dt and the control rate were chosen, with the errors of other steps."""
    lines = [
        "## Choice of dt and the control rate",
        "",
        "The control rate of 10 Hz is the camera's frame rate (Section 2.4), which no leader of "
        "the experiment could exceed. A substep of 0.02 s divides control steps and phases evenly. "
        "Of the substeps in the table below, it is the longest that keeps overlaps in the jam "
        "under 0.01 cm without relinearization. Its Ψ_o cannot be distinguished from that of the "
        "reference, which is `leapfrog` at 0.005 s. The numbers are those of `leapfrog` with 27 "
        "boats (Ψ_o: 20 boats) in [Speed against error](speed_vs_error.md):",
        "",
        f"| dt, s | relinearizations | {' | '.join(ERRORS)} |",
        "| ---: " * (2 + len(ERRORS)) + "|",
    ]
    for passes, dt in ((0, 0.01), (0, 0.02), (0, 0.05), (0, 0.1), (1, 0.1)):
        cells = [f"{reported(*where, passes, dt):.2g}" for where in ERRORS.values()]
        lines.append(f"| {dt:g} | {passes} | {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


def reported(file: str, scene: str | None, number: str, passes: int, dt: float) -> float:
    """Return a number of the speed-against-error report for `leapfrog` with the exact solver."""
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
    parser.add_argument("--docs", type=Path, default=ROOT / "docs", help="folder of the page")
    parser.add_argument("--page", action="store_true", help="write the page again, measure nothing")
    options = parser.parse_args()
    if options.row:
        print(json.dumps({"value": OWN[options.row][0](options.seconds)}))
        return
    data = options.docs / "throughput.toml"
    if not options.page:
        found: dict[str, list[float]] = {row: [] for row in (*OWN, "vmas", "mpe2")}
        for _ in range(options.rounds):
            for row, values in found.items():
                values.append(measure(row, options.seconds))
                print(f"{row:>18}: {values[-1]:,.4g}", flush=True)
        options.docs.mkdir(parents=True, exist_ok=True)
        data.write_text(tomli_w.dumps(results(found, options.seconds)), encoding="utf-8")
    text = page(tomllib.loads(data.read_text(encoding="utf-8")))
    (options.docs / "throughput.md").write_text(text, encoding="utf-8")
    print(f"written to {options.docs / 'throughput.md'}")


if __name__ == "__main__":
    main()
