"""Run ten million control steps with random rudders, and check the results: `make soak`.

Two batches, one per pool, take turns. Each episode draws its backward duration and its target
direction, and episodes reset automatically. The exit code is 1 if a check fails. The page goes to
docs/soak.md.
"""

import argparse
import os
import platform
import shlex
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.progress import Progress
from throughput import processor

import flockenv
from flockenv._io.atomic_write import atomic_write

ROOT = Path(__file__).parents[1]
SCENE = {"n_boats": 27, "n_leaders": 4, "bw_s": (0.0, 1.0), "target": "random", "episode_s": 48.0}
POOLS = ("wide", "narrow")
FLOCKS = 64
#: Share of the steps before memory is stationary, and number of readings.
TRANSIENT, SAMPLES = 0.2, 200
#: Steps between two round trips through bytes, and until an average leader moves its rudder.
STORED_EVERY, RUDDER_HELD = 1000, 5
MOST_GROWTH_KIB = 1024.0
BOUNDS = {"worst_residual_cm_s": 1e-8, "worst_overlap_cm": 0.1}


@dataclass
class Pool:
    """A batch and its extreme values."""

    name: str
    env: flockenv.LeadersVectorEnv
    rudders: np.ndarray
    ended: np.ndarray
    steps: int = 0
    episodes: int = 0
    substeps: int = 0
    contacts: int = 0
    unsolved: int = 0
    worst_residual_cm_s: float = 0.0
    worst_overlap_cm: float = 0.0
    sum_of_worst_overlaps_cm: float = 0.0

    def step(self, random: np.random.Generator) -> None:
        moved = random.random(self.rudders.shape) < 1 / RUDDER_HELD
        drawn = random.uniform(-1.2, 1.2, self.rudders.shape)
        self.rudders = np.where(moved, drawn, self.rudders)
        observations, rewards, _, truncated, _ = self.env.step(self.rudders)
        if not (np.isfinite(observations).all() and np.isfinite(rewards).all()):
            raise SystemExit(f"{self.name}: NaN after {self.steps} control steps")
        # The step after an episode's end starts the next one, and moves nothing.
        self.steps += int((~self.ended).sum())
        self.ended = truncated
        for flock in np.flatnonzero(truncated).tolist():
            self.note(flock)

    def note(self, flock: int) -> None:
        ended = self.env._batch.flock(flock)
        if not (np.isfinite(ended.pose).all() and np.isfinite(ended.velocity).all()):
            raise SystemExit(f"{self.name}: NaN in a state after {self.steps} control steps")
        found = ended.statistics
        self.episodes += 1
        self.substeps += found.substeps
        self.contacts += found.contacts
        self.unsolved += found.unsolved
        self.worst_residual_cm_s = max(self.worst_residual_cm_s, found.worst_residual_cm_s)
        self.worst_overlap_cm = max(self.worst_overlap_cm, found.worst_overlap_cm)
        self.sum_of_worst_overlaps_cm += found.worst_overlap_cm


def make(name: str, seed: int) -> Pool:
    flocks = FLOCKS // len(POOLS)
    env = flockenv.LeadersVectorEnv(flocks, pool=name, autoreset_mode="next_step", **SCENE)
    env.reset(seed=seed)
    return Pool(name, env, np.zeros(env.action_space.shape), np.zeros(flocks, bool))


def resident_kib() -> float:
    """Return the resident memory of this process in KiB."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return float(next(line.split()[1] for line in lines if line.startswith("VmRSS")))


def soak(total: int, seed: int) -> tuple[list[Pool], np.ndarray]:
    """Step until `total` control steps; return the batches and (steps, KiB) as they went."""
    random = np.random.default_rng(seed)
    pools = [make(name, seed + place) for place, name in enumerate(POOLS)]
    memory, rounds = [], 0
    with Progress() as progress:
        task = progress.add_task("control steps", total=total)
        while (done := sum(pool.steps for pool in pools)) < total:
            for pool in pools:
                pool.step(random)
            rounds += 1
            if rounds % STORED_EVERY == 0:
                for pool in pools:
                    pool.env.set_state(pool.env.get_state())
            if done >= len(memory) * total / SAMPLES:
                memory.append((done, resident_kib()))
                progress.update(task, completed=done)
    return pools, np.array(memory)


def growth(memory: np.ndarray) -> tuple[float, float]:
    """Return KiB per million control steps (least squares) and the range of all samples in KiB."""
    late = memory[memory[:, 0] >= TRANSIENT * memory[-1, 0]]
    return 1e6 * np.polyfit(*late.T, 1)[0], np.ptp(late[:, 1])


def failures(pools: list[Pool], memory: np.ndarray) -> list[str]:
    late = memory[memory[:, 0] >= TRANSIENT * memory[-1, 0]]
    grown = growth(memory)[0] * (late[-1, 0] - late[0, 0]) / 1e6
    found = [f"memory grew by {grown:.0f} KiB"] if grown > MOST_GROWTH_KIB else []
    for pool in pools:
        if pool.unsolved:
            found.append(f"{pool.name}: {pool.unsolved} solves exceeded their residual")
        for name, bound in BOUNDS.items():
            if not getattr(pool, name) <= bound:
                found.append(f"{pool.name}: {name} = {getattr(pool, name):.2g}, above {bound:g}")
    return found


def page(pools: list[Pool], memory: np.ndarray, seed: int, wall_s: float) -> str:
    slope, apart = growth(memory)
    steps = sum(pool.steps for pool in pools)
    places = [round(part * (len(memory) - 1) / 5) for part in range(1, 6)]
    fifths = ", ".join(f"{memory[place, 1]:.0f}" for place in places)
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    rows = {
        "control steps": [f"{pool.steps:,}" for pool in pools],
        "episodes, reset automatically": [f"{pool.episodes:,}" for pool in pools],
        "substeps": [f"{pool.substeps:,}" for pool in pools],
        "contacts, summed over substeps": [f"{pool.contacts:,}" for pool in pools],
        "solves that exceeded their residual": [f"{pool.unsolved}" for pool in pools],
        "worst residual of a solve, cm/s": [f"{pool.worst_residual_cm_s:.1e}" for pool in pools],
        "worst overlap, cm": [f"{pool.worst_overlap_cm:.1e}" for pool in pools],
        "worst overlap of an episode, mean, cm": [
            f"{pool.sum_of_worst_overlaps_cm / max(pool.episodes, 1):.1e}" for pool in pools
        ],
    }
    lines = [
        "# Soak",
        "",
        f"All {steps:,} control steps with random rudders gave finite observations and rewards, "
        "and every episode ended in a finite state.",
        "",
        f"`{shlex.join(['python', *sys.argv])}` (`make soak`) wrote this page with seed {seed} on "
        f"{time.strftime('%Y-%m-%d')}: {processor()}, {os.cpu_count()} cores, {platform.system()} "
        f"{platform.machine()}, Python {platform.python_version()}, flockenv "
        f"{flockenv.__version__}; {wall_s:.0f} s, load average at the end {load:.1f}.",
        "",
        f"The soak runs {FLOCKS} flocks of {SCENE['n_boats']} boats, {SCENE['n_leaders']} of them "
        f"leaders, half in each pool. Episodes last {SCENE['episode_s']:g} s, at 10 control steps "
        "per second of five substeps each. Every episode draws a backward duration (bw from 0 to "
        "1 s) and a target direction. Leaders hold random rudders from -1.2 to 1.2 (clipped at 1) "
        f"for {RUDDER_HELD} steps on average. Every {STORED_EVERY} steps the whole batch is "
        "stored as bytes and restored.",
        "",
        f"| | {' | '.join(f'`{pool.name}`' for pool in pools)} |",
        f"| --- |{' --- |' * len(pools)}",
        *(f"| {name} | {' | '.join(cells)} |" for name, cells in rows.items()),
        "",
        f"The resident memory is {memory[0, 1] / 1024:.1f} MiB at the start and "
        f"{memory[-1, 1] / 1024:.1f} MiB at the end. At 20, 40, 60, 80 and 100 % of the steps it "
        f"is {fifths} KiB. After the first {TRANSIENT:.0%} of the steps it changes by "
        f"{slope:+.1f} KiB per million control steps (least squares of {len(memory)} readings), "
        f"and all readings lie within {apart:.0f} KiB.",
        "",
        f"The run fails for NaN, for memory that grows by more than {MOST_GROWTH_KIB:.0f} KiB, for "
        "any solve that exceeds its residual, for a residual above "
        f"{BOUNDS['worst_residual_cm_s']:g} cm/s and for an overlap above "
        f"{BOUNDS['worst_overlap_cm']:g} cm.",
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=float, default=1e7, help="control steps, all flocks")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "soak.md")
    options = parser.parse_args()
    start = time.perf_counter()
    pools, memory = soak(int(options.steps), options.seed)
    text = page(pools, memory, options.seed, time.perf_counter() - start)
    with atomic_write(options.out) as file:
        file.write(text.encode())
    print(text)
    if found := failures(pools, memory):
        raise SystemExit("\n".join(found))


if __name__ == "__main__":
    main()
