"""Learn two roles for the task `misinformed` of suite v2: a policy for each leader.

    python baselines/learn_roles.py     # six minutes of one core (extra search)

In the task's 256 flocks the five seeds reach 0.329, 0.292, 0.314, 0.308 and 0.321, after 171
flock-hours and 75 s of one core each; the pair written by hand reaches 0.330.

CMA-ES, an evolution strategy, searches eight numbers: for each leader the three gains of the damped
law, and how much it heeds the direction that it is told. A leader with a negative number steers the
other way. All start at zero, so that the first leaders heed their directions or not by chance. A
candidate's score is its mean order in 32 flocks of four minutes, the same for all candidates of a
generation (physics of trainings). The design was fixed before the first search. All seeds count;
the flocks of the task judge them.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from cmaes import CMA
from misinformed_pair import TASK, Heeds
from numpy.typing import ArrayLike
from tune_laws import SEEDS

from flockenv.comparison import run_episodes
from flockenv.policies import DampedLaw
from flockenv.statistics import mean_interval

MIDDLE, WIDTH = np.array([1.9, 1.9, 6.0]), 1.0
"""The gains where a number is 0, and the width of their logarithms."""
LEADERS, NUMBERS = 2, 4


class Pair:
    """A policy for each leader of a flock."""

    def __init__(self, numbers: np.ndarray) -> None:
        self.policies = []
        for heeds, *gains in numbers.reshape(LEADERS, NUMBERS):
            law = DampedLaw(*(MIDDLE * np.exp(WIDTH * np.array(gains))).tolist())
            self.policies.append(Heeds(law, 1.0 if heeds >= 0.0 else -1.0))

    def predict(self, observation: ArrayLike, state: Any = None, *_: Any) -> tuple[Any, Any]:
        """Return the rudders of all leaders; a row of what is seen is a flock's."""
        seen = np.asarray(observation)
        each = np.moveaxis(seen.reshape(len(seen), LEADERS, -1), 1, 0)
        rudders = [
            policy.predict(rows)[0] for policy, rows in zip(self.policies, each, strict=True)
        ]
        return np.concatenate(rudders, axis=1), state


def orders(numbers: np.ndarray, seeds: Sequence[int], minutes: float, physics: str) -> np.ndarray:
    """Return the order of flocks of the task, half of them with exchanged directions."""
    options = {**TASK.environment, "physics": physics}
    found = [
        run_episodes(
            TASK.parameters.replace(target=target),
            Pair(numbers),
            seeds[place :: len(TASK.targets)],
            60.0 * minutes,
            options={"target": target, **options},
        )["signed_order"]
        for place, target in enumerate(TASK.targets)
    ]
    return np.concatenate(found)


def search(seed: int, generations: int, flocks: int, minutes: float) -> pd.DataFrame:
    """Return the mean and the best order of each generation, and the numbers at its middle."""
    cma = CMA(mean=np.zeros(LEADERS * NUMBERS), sigma=0.5, seed=seed)
    rows = []
    for generation in range(generations):
        seeds = SEEDS.seeds(flocks, seed, generation * flocks)
        asked = [cma.ask() for _ in range(cma.population_size)]
        scores = [float(orders(each, seeds, minutes, "training").mean()) for each in asked]
        cma.tell([(each, -score) for each, score in zip(asked, scores, strict=True)])
        hours = (generation + 1) * len(asked) * flocks * minutes / 60.0
        row = {"seed": seed, "flock_hours": hours, "mean": np.mean(scores), "best": max(scores)}
        rows.append(row | {f"number_{k}": value for k, value in enumerate(cma.mean)})
    return pd.DataFrame(rows)


def main(arguments: list[str] | None = None) -> None:
    """Search with each seed, and judge what it ends with."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--generations", type=int, default=8)
    parser.add_argument("--flocks", type=int, default=32)
    parser.add_argument("--minutes", type=float, default=4.0)
    parser.add_argument("--judged", type=int, default=len(TASK.seeds), help="flocks of the task")
    parser.add_argument("--out", type=Path, default=Path("results/learn_roles"))
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    judging, rows = TASK.seeds[: options.judged], []
    for seed in range(options.seeds):
        curve = search(seed, options.generations, options.flocks, options.minutes)
        curve.to_csv(options.out / f"curve-{seed}.csv", index=False, float_format="%.5g")
        last = curve.iloc[-1]
        numbers = last[[f"number_{k}" for k in range(LEADERS * NUMBERS)]].to_numpy(float)
        order, low, high = mean_interval(orders(numbers, judging, TASK.episode_s / 60.0, "default"))
        row = {"seed": seed, "flock_hours": last["flock_hours"]}
        rows.append(row | {"signed_order": order, "low": low, "high": high})
        print(f"seed {seed}: {order:.3f} [{low:.3f}, {high:.3f}]", flush=True)
    pd.DataFrame(rows).to_csv(options.out / "reached.csv", index=False, float_format="%.5g")


if __name__ == "__main__":
    main()
