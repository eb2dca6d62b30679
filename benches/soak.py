"""Run ten million control steps with random rudders, and check the results: `make soak`.

A batch per pool, physics and speed takes turns with the others. Each episode draws its backward
duration and its target direction, and episodes reset automatically. The exit code is 1 if a check
fails. The numbers go to docs/throughput/soak.csv.
"""

import argparse
import csv
import io
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np
from rich.progress import Progress

import flockenv
from flockenv._io.atomic_write import write_text

ROOT = Path(__file__).parents[1]
SCENE = {"n_boats": 27, "n_leaders": 4, "bw_s": (0.2, 2.8), "target": "random", "episode_s": 48.0}
POOLS = ("wide", "narrow")
PHYSICS = ("training", "default", "publication")
SPEEDS_CM_S = (5.0, 20.0, 60.0)
FLOCKS = 8
#: Repetitions of the same rounds, whose last half shows leaks, and their number of rounds.
REPEATS, STRETCH = 16, 300
#: Rounds between two round trips through bytes, and steps until an average leader moves its rudder.
STORED_EVERY, RUDDER_HELD = 1000, 5
MOST_GROWTH_KIB = 256.0
WORST_RESIDUAL_CM_S = 1e-8


@dataclass
class Batch:
    """Flocks of one pool, physics and speed, and their extreme values."""

    pool: str
    physics: str
    speed_cm_s: float
    env: flockenv.LeadersVectorEnv
    rudders: np.ndarray
    ended: np.ndarray
    tolerance_cm: float = 0.0
    control_steps: int = 0
    episodes: int = 0
    substeps: int = 0
    halved_substeps: int = 0
    contacts: int = 0
    unsolved: int = 0
    solver_errors: int = 0
    worst_residual_cm_s: float = 0.0
    worst_overlap_cm: float = 0.0

    @property
    def name(self) -> str:
        return f"{self.pool}, {self.physics}, {self.speed_cm_s:g} cm/s"

    def step(self, random: np.random.Generator) -> None:
        is_moved = random.random(self.rudders.shape) < 1 / RUDDER_HELD
        drawn = random.uniform(-1.2, 1.2, self.rudders.shape)
        self.rudders = np.where(is_moved, drawn, self.rudders)
        try:
            observations, rewards, _, truncated, _ = self.env.step(self.rudders)
        except flockenv.SolverError:
            self.solver_errors += 1
            self.env.reset()
            self.ended[:] = False
            return
        if not (np.isfinite(observations).all() and np.isfinite(rewards).all()):
            raise SystemExit(f"{self.name}: NaN after {self.control_steps} control steps")
        # The step after an episode's end starts the next one, and moves nothing.
        self.control_steps += int((~self.ended).sum())
        self.ended = truncated
        for flock in np.flatnonzero(truncated).tolist():
            self.add_episode(flock)

    def add_episode(self, flock: int) -> None:
        """Check the last state of an episode, and add its statistics."""
        ended = self.env._batch.flock(flock)
        if not (np.isfinite(ended.pose).all() and np.isfinite(ended.velocity).all()):
            raise SystemExit(f"{self.name}: NaN in a state after {self.control_steps} steps")
        p, statistics = ended.parameters, ended.statistics
        outer_cm, inner_cm = p.pool_radii_cm
        distance_cm = np.hypot(*ended.pose[:, :2].T)
        if not ((inner_cm <= distance_cm) & (distance_cm <= outer_cm)).all():
            raise SystemExit(f"{self.name}: a boat is outside the water")
        self.tolerance_cm = p.tolerance_cm
        self.episodes += 1
        self.substeps += statistics.substeps
        self.halved_substeps += statistics.halved_substeps
        self.contacts += statistics.contacts
        self.unsolved += statistics.unsolved
        self.worst_residual_cm_s = max(self.worst_residual_cm_s, statistics.worst_residual_cm_s)
        self.worst_overlap_cm = max(self.worst_overlap_cm, statistics.worst_overlap_cm)


def make(pool: str, physics: str, speed_cm_s: float, seed: int) -> Batch:
    speeds = {"speed_cm_s": speed_cm_s, "reverse_speed_cm_s": speed_cm_s}
    env = flockenv.LeadersVectorEnv(
        FLOCKS, pool=pool, physics=physics, autoreset_mode="next_step", **SCENE, **speeds
    )
    env.reset(seed=seed)
    rudders, ended = np.zeros(env.action_space.shape), np.zeros(FLOCKS, bool)
    return Batch(pool, physics, speed_cm_s, env, rudders, ended)


def resident_kib() -> float:
    """Return the resident memory of this process in KiB."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return float(next(line.split()[1] for line in lines if line.startswith("VmRSS")))


def soak(total: int, seed: int) -> tuple[list[Batch], list[float]]:
    """Make `total` control steps; return the batches and the readings of `repeated` after them."""
    random = np.random.default_rng(seed)
    kinds = enumerate(product(POOLS, PHYSICS, SPEEDS_CM_S))
    batches = [make(*kind, seed + 1000 * number) for number, kind in kinds]
    rounds = 0
    with Progress() as progress:
        task = progress.add_task("control steps", total=total)
        while (done := sum(batch.control_steps for batch in batches)) < total:
            for batch in batches:
                batch.step(random)
            rounds += 1
            if rounds % STORED_EVERY == 0:
                for batch in batches:
                    batch.env.set_state(batch.env.get_state())
                progress.update(task, completed=done)
    return batches, repeated(batches, seed)


def repeated(batches: list[Batch], seed: int) -> list[float]:
    """Return the resident memory in KiB after each repetition of the same rounds.

    New states may need more memory. Repeated states do not, so that memory that still grows is
    leaked.
    """
    starts = [(batch.env.get_state(), batch.rudders, batch.ended) for batch in batches]
    readings = []
    for _ in range(REPEATS):
        random = np.random.default_rng(seed)
        copies = [replace(batch) for batch in batches]
        for batch, (state, rudders, ended) in zip(copies, starts, strict=True):
            batch.env.set_state(state)
            batch.rudders, batch.ended = rudders.copy(), ended.copy()
        for _ in range(STRETCH):
            for batch in copies:
                batch.step(random)
        readings.append(resident_kib())
    return readings


def growth(readings: list[float]) -> float:
    """Return by how many KiB memory grew in the last half of the repetitions."""
    return readings[-1] - readings[len(readings) // 2 - 1]


def failures(batches: list[Batch], readings: list[float]) -> list[str]:
    grown = growth(readings)
    failed = [f"memory leaked {grown:.0f} KiB"] if grown > MOST_GROWTH_KIB else []
    for batch in batches:
        if batch.unsolved:
            failed.append(f"{batch.name}: {batch.unsolved} substeps were not solved")
        for name, bound in (
            ("worst_residual_cm_s", WORST_RESIDUAL_CM_S),
            ("worst_overlap_cm", batch.tolerance_cm),
        ):
            if not getattr(batch, name) <= bound * (1 + 1e-6):
                failed.append(f"{batch.name}: {name} = {getattr(batch, name):.2g}, above {bound:g}")
    return failed


COLUMNS = (
    "pool",
    "physics",
    "speed_cm_s",
    "control_steps",
    "episodes",
    "substeps",
    "halved_substeps",
    "contacts",
    "unsolved",
    "solver_errors",
    "worst_residual_cm_s",
    "worst_overlap_cm",
    "tolerance_cm",
)


def table(batches: list[Batch]) -> str:
    """Return the statistics of the batches as CSV, a row for each."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for batch in batches:
        cells = [getattr(batch, name) for name in COLUMNS]
        writer.writerow([f"{cell:.6g}" if isinstance(cell, float) else cell for cell in cells])
    return text.getvalue()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=float, default=1e7, help="control steps, all flocks")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "throughput" / "soak.csv")
    options = parser.parse_args()
    batches, readings = soak(int(options.steps), options.seed)
    text = table(batches)
    write_text(options.out, text)
    print(text)
    steps = STRETCH * FLOCKS * len(batches)
    print(
        f"Resident memory, {readings[-1]:.0f} KiB at the end, grew by {growth(readings):+.0f} KiB "
        f"in the last half of {REPEATS} times the same {steps} control steps"
    )
    if failed := failures(batches, readings):
        raise SystemExit("\n".join(failed))


if __name__ == "__main__":
    main()
