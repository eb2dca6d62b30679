"""Learn two roles for the task `misinformed` of suite v2: a policy for each leader.

    python -m studies.roles.learn_roles     # six minutes of one core (extra search)

In the task's 256 flocks the five seeds reach 0.346, 0.324, 0.305, 0.354 and 0.334, after 171
flock-hours and 63 s of one core each; the pair written by hand reaches 0.330.

CMA-ES, an evolution strategy, searches eight numbers: for each leader the three gains of the damped
law, within the ranges of tune_laws.py, and a sign: a leader with a negative number steers against
its target. All start at zero, so that chance decides which way the first leaders steer. A
candidate's score is its mean order in 32 flocks of four minutes, the same for all candidates of a
generation (physics of trainings). The budget was fixed before the first search. All seeds count;
the flocks of the task judge them. The folder results keeps the table `reached.csv` as roles.csv.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Self

import numpy as np
import pandas as pd
from cmaes import CMA
from numpy.typing import ArrayLike

from flockenv.comparison import run_episodes, score_policies
from flockenv.policies import DampedLaw
from flockenv.runs.seeds import POLICY_SEEDS
from studies.roles.misinformed_pair import TASK, Signed
from studies.store import check_version, write_table
from studies.study import run
from studies.tuned_laws.tune_laws import RANGES, law

LEADERS, NUMBERS = 2, 1 + len(RANGES)


class Pair:
    """A policy for each leader of a flock."""

    def __init__(self, policies: Sequence[Signed]) -> None:
        self.policies = policies

    @classmethod
    def of(cls, numbers: np.ndarray) -> Self:
        """Return the pair of a candidate."""
        middle, widths = np.array(list(RANGES.values())).T
        return cls(
            [
                Signed(
                    DampedLaw(**law(np.log(middle) + widths * np.array(gains))),
                    1.0 if sign >= 0.0 else -1.0,
                )
                for sign, *gains in numbers.reshape(LEADERS, NUMBERS)
            ]
        )

    def predict(self, observation: ArrayLike, state: Any = None, *_: Any) -> tuple[Any, Any]:
        """Return the rudders of all leaders; a row of what is seen is a flock's."""
        seen = np.asarray(observation)
        each = np.moveaxis(seen.reshape(len(seen), LEADERS, -1), 1, 0)
        rudders = [
            policy.predict(rows)[0] for policy, rows in zip(self.policies, each, strict=True)
        ]
        return np.concatenate(rudders, axis=1), state


def orders(pair: Pair, seeds: Sequence[int], minutes: float, physics: str) -> np.ndarray:
    """Return the order of flocks of the task, half of them with exchanged directions."""
    options = {**TASK.environment, "physics": physics}
    found = [
        run_episodes(
            TASK.parameters.replace(target=target),
            pair,
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
        seeds = POLICY_SEEDS["roles"].seeds(flocks, seed, generation * flocks)
        asked = [cma.ask() for _ in range(cma.population_size)]
        scores = [float(orders(Pair.of(each), seeds, minutes, "training").mean()) for each in asked]
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
    check_version(options.out / "reached.csv")
    rows: list[dict[str, Any]] = []

    def judge(name: int | str, hours: float, pair: Pair) -> None:
        judging = TASK.seeds[: options.judged]
        found = orders(pair, judging, TASK.episode_s / 60.0, "default")
        score = score_policies({"pair": found}).loc[0, ["signed_order", "low", "high"]].to_dict()
        rows.append({"seed": name, "flock_hours": hours, **score})
        print(f"seed {name}: {score}", flush=True)

    tuned = DampedLaw.tuned("wide")
    judge("by hand", 0.0, Pair([Signed(tuned, 1.0), Signed(tuned, -1.0)]))
    for seed in range(options.seeds):
        curve = search(seed, options.generations, options.flocks, options.minutes)
        curve.to_csv(options.out / f"curve-{seed}.csv", index=False, float_format="%.5g")
        last = curve.iloc[-1]
        numbers = last[[f"number_{k}" for k in range(LEADERS * NUMBERS)]].to_numpy(float)
        judge(seed, last["flock_hours"], Pair.of(numbers))
    write_table(options.out / "reached.csv", pd.DataFrame(rows))


if __name__ == "__main__":
    run(main, resumes=False)
