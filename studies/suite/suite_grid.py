"""Compare algorithms and inputs with equal budgets, on three tasks of suite v2.

After 100 flock-hours (seeds 0 to 4, 20 to 69 s of one core) TRPO and PPO lead better than MAPPO,
evolution, IPPO and SAC (`compare_grid.py`), and no cell is shown to gain on the tuned law. After
1000 (seed 0, 199 to 346 s) PPO does with each input; only PPO, evolution and TRPO's first cell ran.

    make env-benchmarl
    OMP_NUM_THREADS=1 .venv-benchmarl/bin/python -m studies.suite.suite_grid
    OMP_NUM_THREADS=1 .venv-benchmarl/bin/python -m studies.suite.suite_grid --flock-hours 1000 \\
        --algorithms ppo trpo evolution

Seven algorithms learn from three inputs: the 29 lean features with a linear actor, the same with
two hidden layers of 32, and the default observation with those layers. All leaders of a flock share
the policy. Everything else about the task is that of `flockenv train`: three leaders in `wide` at
the critical noise lean about the heading of the tuned law, decide once per second, and are paid the
order plus 30 times `contact_alignment` (physics of trainings). How an algorithm explores is its
own: PPO and TRPO perturb the weights of the last layer, one perturbation for all leaders of a
flock (gSDE); recurrent PPO and SAC do so for each leader; IPPO and MAPPO add noise to each action;
evolution perturbs all weights. Recurrent PPO has a layer of 32 LSTM cells before the actor, so that
its "linear" actor is linear in them. The critic of MAPPO sees features of the whole flock.

The design was committed before the first run:

- Settings. One for each algorithm (`SETTINGS`), the same with all inputs. None is searched here.
  PPO takes the step, the exploration and the horizons of `flockenv train`, once searched with the
  first input. TRPO has its horizons and exploration, too, and a divergence that was one of four.
  Evolution has the spread of six that were tried. All others are first guesses. A row has the
  flock-hours of these searches (`SEARCHED`), all with the first input.
- Trainings. Seeds 0 to 4 with 100 flock-hours each, seed by seed, each for all algorithms and
  inputs. If the time ends early, all that were trained count: this order chose them, and not a
  result. Then 1000 flock-hours, PPO, TRPO and evolution first. Budgets are rounded up to whole
  rollouts or generations.
- One training with 10 000 flock-hours, whatever comes of it: `flockenv train --pool wide
  --n-leaders 3 --flock-hours 10000 --seed 0`, PPO with the first input. It is an entry of the whole
  suite, and meets the 2048 flocks of studies/leaders with one and with three leaders.
  results/v2.csv has the first command's rows, with the command of docs/suite.md for the others;
  11 500 flock-hours count PPO's searches.

      flockenv compare --suite v2 --policy results/train/model.zip --trust --flock-hours 11500
      flockenv compare --policy results/train/model.zip --policy "tuned law" --trust --only \\
          --n-leaders 1,3 --episodes 2048 --seed 2780189507    # results/ten_thousand.csv

- Judgment. The first 40 seeds of `three-leaders`, `one-leader` and `camera`, where each policy
  decides as in its training. A score is the difference from the tuned law in the same flock. Over
  all seeds and tasks there are the interquartile mean and the probability of improvement.
- Answer. A cell (an algorithm with an input) gains if the 95 % interval of its interquartile mean
  is above 0, and loses if it is below. The interval draws seeds and flocks (a bootstrap). If it
  holds 0 and reaches above 0.03, which PPO gains in 500 flock-hours, the grid says nothing about
  that cell. After three seeds this replaced an interval that averaged the seeds and drew flocks
  alone, which hides how seeds differ.

What is there is not made again. A folder OUT/ALGORITHM/INPUT/HOURS/SEED holds the policy
(policy.npz, or model.zip for recurrent PPO), what made it and its orders. OUT/grid-HOURS.csv has
all of a class.
"""

import argparse
import json
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import torch

from flockenv.comparison.suite import REFERENCE, tasks_named
from flockenv.policies import NetworkPolicy
from flockenv.policies.provenance import commit
from flockenv.runs.store import RESULTS_VERSION
from flockenv.statistics import interquartile_mean
from studies.store import StudyError, write_table
from studies.study import run
from studies.suite.suite_learners import INPUTS, Training, learn

#: Of each algorithm, as `Training.setting`.
SETTINGS = {
    "ppo": 2e-3,
    "trpo": 0.01,
    "evolution": 0.1,
    "recurrent-ppo": 1e-3,
    "sac": 3e-4,
    "ippo": 1e-3,
    "mappo": 1e-3,
}
#: Of a bootstrap.
DRAWS = 2000
#: Flock-hours that chose a setting, before, with the first input; with the others none.
SEARCHED = {"ppo": 1500.0, "trpo": 1000.0, "evolution": 1500.0}
SEEDS = range(5)
JUDGED = ("three-leaders", "one-leader", "camera")


@dataclass(frozen=True)
class Budget:
    """What is spent."""

    flock_hours: float = 100.0
    #: Flocks that are stepped together, and pairs of a generation of the evolution strategy.
    together: tuple[int, int] = (128, 16)
    #: Flocks of each task that judge.
    judged: int = 40


TRIAL = Budget(0.1, (2, 2), 2)


def judge(policy: Any, budget: Budget, path: Path) -> None:
    """Write the order in each flock of the tasks."""
    cases = [replace(each, seeds=each.seeds[: budget.judged]) for each in tasks_named("v2", JUDGED)]
    runs = pd.concat([case.run({"policy": policy}) for case in cases])
    path.parent.mkdir(parents=True, exist_ok=True)
    runs[["case", "seed", "signed_order"]].to_csv(path, index=False)


def make(algorithm: str, named: str, seed: int, budget: Budget, out: Path) -> None:
    """Train and judge a policy, unless it is there."""
    folder = out / algorithm / named / f"{budget.flock_hours:g}" / str(seed)
    if (folder / "orders.csv").exists():
        made = json.loads((folder / "made.json").read_text())
        if (version := made.get("results_version")) != RESULTS_VERSION:
            raise StudyError(
                f"{folder} has results version {version}, and this code would add trainings of "
                f"version {RESULTS_VERSION}; --out names another folder"
            )
        return
    setting, hours = SETTINGS[algorithm], budget.flock_hours
    given = Training(algorithm, named, setting, seed, hours, *budget.together)
    policy, cpu_s = learn(given)
    folder.mkdir(parents=True, exist_ok=True)
    policy.save(folder / ("policy.npz" if isinstance(policy, NetworkPolicy) else "model.zip"))
    made = {"setting": setting, "flock_hours": hours, "cpu_s": cpu_s, "commit": commit()}
    made["results_version"] = RESULTS_VERSION
    (folder / "made.json").write_text(json.dumps(made))
    judge(policy, budget, folder / "orders.csv")
    print(f"{folder}: {cpu_s:.0f} s", flush=True)


def table(cells: Iterable[tuple[str, str]], hours: float, out: Path) -> pd.DataFrame:
    """Return a row for each training, and one for all of each cell."""

    def orders(path: Path) -> np.ndarray:
        read = pd.read_csv(path)
        return np.array([own["signed_order"] for _, own in read.groupby("case", sort=False)])

    tuned, rows = orders(out / "tuned.csv"), list[dict[str, Any]]()
    for algorithm, named in cells:
        folder = out / algorithm / named / f"{hours:g}"
        seeds = [seed for seed in SEEDS if (folder / f"{seed}/orders.csv").exists()]
        made = [json.loads((folder / f"{seed}/made.json").read_text()) for seed in seeds]
        beyond = [orders(folder / f"{seed}/orders.csv") - tuned for seed in seeds]
        taken = [each["cpu_s"] for each in made]
        each = [*zip(seeds, [[own] for own in beyond], taken, strict=True)]
        for seed, own, cpu_s in [*each, ("all", beyond, np.mean(taken))] if each else []:
            row = {"algorithm": algorithm, "input": named, "flock_hours": hours, "seed": seed}
            row |= {"searched_hours": SEARCHED.get(algorithm, 0.0)}
            row |= {"setting": made[0]["setting"], "cpu_s": cpu_s}
            row |= dict(zip(JUDGED, np.mean(own, axis=(0, 2)), strict=True))
            rows.append(row | over_all(np.array(own)))
    return pd.DataFrame(rows)


def over_all(beyond: np.ndarray) -> dict[str, float]:
    """Return both statistics of differences (seeds, tasks, flocks), with 95 % intervals.

    Seeds share their flocks, so both are drawn: `bootstrap_interval` draws along one of them alone.
    """
    better = (beyond > 0.0) + 0.5 * (beyond == 0.0)
    statistics = {"iqm": (beyond, interquartile_mean), "improvement": (better, np.mean)}
    random, (seeds, tasks, flocks) = np.random.default_rng(0), beyond.shape
    draws = [
        (random.integers(seeds, size=(seeds, 1, 1)), random.integers(flocks, size=(tasks, flocks)))
        for _ in range(DRAWS)
    ]
    each = np.arange(tasks)[:, None]
    found = {}
    for name, (values, statistic) in statistics.items():
        drawn = [float(statistic(values[seed, each, flock].ravel())) for seed, flock in draws]
        low, high = np.quantile(drawn, (0.025, 0.975))
        found |= {name: float(statistic(values.ravel())), f"{name}_low": low, f"{name}_high": high}
    return found


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--flock-hours", type=float, default=100.0)
    parser.add_argument("--algorithms", nargs="+", choices=SETTINGS, default=[*SETTINGS])
    parser.add_argument("--inputs", nargs="+", choices=INPUTS, default=[*INPUTS])
    parser.add_argument("--out", type=Path, default=Path("results/grid"))
    parser.add_argument("--trial", action="store_true", help="a minute of flocks, seed 0")
    options = parser.parse_args(arguments)
    torch.set_num_threads(1)
    budget = TRIAL if options.trial else Budget(flock_hours=options.flock_hours)
    if not (options.out / "tuned.csv").exists():
        judge(REFERENCE, budget, options.out / "tuned.csv")
    cells = [*product(options.algorithms, options.inputs)]
    for seed in SEEDS[:1] if options.trial else SEEDS:
        for cell in cells:
            make(*cell, seed, budget, options.out)
        found = table(cells, budget.flock_hours, options.out)
        write_table(options.out / f"grid-{budget.flock_hours:g}.csv", found, "%.4g")
    print(found.to_string(index=False))


if __name__ == "__main__":
    run(main)
