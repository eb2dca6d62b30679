"""Train learners from nothing in the levels of suite v3, and enter them.

    python -m studies.levels.train_levels                       # order-easy, 30 flock-hours
    python -m studies.levels.train_levels --levels order-noisy --flock-hours 100
    make env-benchmarl
    .venv-benchmarl/bin/python -m studies.levels.train_levels --algorithms ippo mappo

Design, fixed before the runs, but for those named at its end:

- Levels. Those of `flockenv.comparison.levels`: leaders choose rudders, and no law is in their
  action, start or reward, which is the signed order. All see the level's default observation, but
  paired branches, which see the 29 lean features.
- Algorithms, each with one setting. PPO has that of docs/train.md. TRPO and A2C have its network,
  discount, flocks and first exploration; TRPO a divergence of 0.01 per step, A2C rollouts of 16
  decisions, and both the other defaults of their libraries. SAC has the network, discount and
  flocks, and the defaults otherwise: a step of gradients for each decision of the 64 flocks. IPPO
  and MAPPO of BenchMARL have the network, discount, flocks, rollouts, batches, passes and first
  learning rate of PPO, and BenchMARL's exploration; the critic of MAPPO sees features of the whole
  flock. Linear evolution is that of baselines/evolution_strategy.py: 16 antithetic pairs of an
  episode, weights that start at 0, a spread of 0.1 and steps of 0.03. Paired branches are
  `flockenv train --algorithm branches --set action_mode=rudder`. The settings of PPO and of paired
  branches were chosen in order-easy before, in flock-hours that nobody recorded; the others are
  first guesses. Recurrent PPO has none: its policy is a file that executes code when it is read,
  and `make check-entries` reads no such file.
- Trainings. Seeds 0 to 9 in order-easy with 30 flock-hours, seed by seed, each for all algorithms.
  Then order-noisy, order-narrow and order-wide with 30 flock-hours, seed by seed, each for all
  levels and algorithms; then order-easy with 100. If the time ends early, the seeds that all
  algorithms of a level have count.
- Curve. After a fifth of its budget, two fifths and so on, what a training has learned leads the
  level's first flocks for 4.3 flock-hours: 128 in order-easy, 32 in order-wide. The area under the
  curve is the mean of these five scores. It does not choose the policy, which is always the last
  one. Its processor time does not count.
- Judgment. 512 common flocks of the level, by the policy's mean action (`score_levels.py`). The
  score is (order - no steering) / (damped law - no steering).
- Answer. Two algorithms differ if the 95 % interval of the difference of their mean scores, over
  seeds and flocks, leaves out 0. Beside it stand the probability that a training of the one is
  better than one of the other, and p by permutation of the trainings, as it is and by Holm.

Before SAC, IPPO, MAPPO and the curves were added, 14 trainings in order-easy had been judged:
evolution, paired branches and A2C with seeds 0 to 2 and 30 flock-hours, TRPO and PPO with seed 0,
and paired branches with seeds 0 to 2 and 100. They are trained again with the same seeds, for their
curves. SAC, IPPO and MAPPO had trained 3 flock-hours with seed 100, to see what a training takes.

A policy that is there is not made again, so that an interrupted command goes on.
ENTRIES/ALGORITHM-HOURS has the policies, and the file beside it is the entry for
`flockenv compare --suite v3`.
"""

import argparse
import time
from itertools import product
from pathlib import Path
from typing import Any

import tomli_w
import torch

from flockenv.comparison.levels import LEVELS, SUITE
from flockenv.policies import load
from flockenv.policies.provenance import provenance_of
from flockenv.runs.store import RESULTS_VERSION
from studies.levels.level_curves import Curve
from studies.levels.level_learners import LEARNERS
from studies.store import StudyError, write
from studies.study import run

ENTRIES = Path("studies/levels/entries")


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
    curve = Curve(level, hours)
    policy, done, seeds = LEARNERS[algorithm][2](level, hours, seed, curve)
    curve.add(done, policy({}) if callable(policy) else policy)
    cpu_s = time.process_time() - start - curve.cpu_s
    command = (
        f"python -m studies.levels.train_levels --levels {level} --algorithms {algorithm} "
        f"--flock-hours {hours:g} --seeds {seed}"
    )
    samples = round(done * 3600.0 * 2.5) * LEVELS[level].parameters.n_leaders
    origin = provenance_of(command, seed=seed, samples=samples, cpu_s=cpu_s, flock_hours=done)
    origin |= {"results_version": str(RESULTS_VERSION)}
    origin |= {"training_seeds": f"{seeds[0]}-{seeds[-1]}"}
    origin |= curve.texts()
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
    if len(versions) > 1:
        raise StudyError(f"{folder} has policies of results versions {sorted(versions)}")
    seeds = [int(end) for origin in origins for end in origin["training_seeds"].split("-")]
    entry = {
        "suite": SUITE,
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
