"""Run ten million control steps with random rudders, and check the results: `make soak`.

Two batches, one per pool, take turns. Each episode draws its backward duration and its target
direction, and episodes reset automatically. The exit code is 1 if a check fails. The numbers go to
docs/throughput/soak.csv.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.progress import Progress

import flockenv
from flockenv._io.atomic_write import write_text

ROOT = Path(__file__).parents[1]
SCENE = {"n_boats": 27, "n_leaders": 4, "bw_s": (0.0, 1.0), "target": "random", "episode_s": 48.0}
POOLS = ("wide", "narrow")
FLOCKS = 64
#: Share of the steps before memory is stationary, and number of readings.
TRANSIENT, SAMPLES = 0.2, 200
#: Steps between two round trips through bytes, and until an average leader moves its rudder.
STORED_EVERY, RUDDER_HELD = 1000, 5
MOST_GROWTH_KIB = 1024.0
BOUNDS = {"worst_residual_cm_s": 1e-8, "worst_overlap_cm": 1e-4}


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


def table(pools: list[Pool]) -> list[list[str]]:
    """Return what each pool saw, a row per quantity."""
    quantities = {
        "control steps": lambda pool: f"{pool.steps}",
        "episodes, reset automatically": lambda pool: f"{pool.episodes}",
        "substeps": lambda pool: f"{pool.substeps}",
        "contacts, summed over substeps": lambda pool: f"{pool.contacts}",
        "solves that exceeded their residual": lambda pool: f"{pool.unsolved}",
        "worst residual of a solve, cm/s": lambda pool: f"{pool.worst_residual_cm_s:.1e}",
        "worst overlap, cm": lambda pool: f"{pool.worst_overlap_cm:.1e}",
        "worst overlap of an episode, mean, cm": lambda pool: (
            f"{pool.sum_of_worst_overlaps_cm / max(pool.episodes, 1):.1e}"
        ),
    }
    header = ["quantity", *(pool.name for pool in pools)]
    return [header, *([name, *map(of, pools)] for name, of in quantities.items())]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=float, default=1e7, help="control steps, all flocks")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "throughput" / "soak.csv")
    options = parser.parse_args()
    pools, memory = soak(int(options.steps), options.seed)
    lines = [",".join(f'"{cell}"' for cell in row) for row in table(pools)]
    write_text(options.out, "\n".join(lines) + "\n")
    slope, apart = growth(memory)
    print(*lines, sep="\n")
    print(
        f"Resident memory, {memory[0, 1]:.0f} KiB at the start, changes by {slope:+.1f} KiB per "
        f"million control steps after the first {TRANSIENT:.0%}, within {apart:.0f} KiB."
    )
    if found := failures(pools, memory):
        raise SystemExit("\n".join(found))


if __name__ == "__main__":
    main()
