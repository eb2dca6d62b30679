"""Search leaders in pairs of branches: one state, one noise, and opposite changes of the weights.

    python baselines/paired_branches.py --seed 0          # from the tuned law, a minute of one core
    flockenv compare --policy "tuned law" --policy results/paired/0/policy.json --n-leaders 3
    python -m studies.trainings.judge_trainings results/paired/*     # in the same 512 flocks

Seeds 0 to 4 reach an order of 0.455 to 0.481 with 200 flock-hours, 42 s of one core each. The tuned
law has 0.451.

A policy is linear in the 29 lean features, as in examples/train_leaders.py, and starts as the tuned
law. Both flocks of a pair start from one snapshot and have the same noise. The two flocks differ by
a Gaussian change of the weights, added in one and subtracted in the other. For about a minute the
noise moves both nearly alike, so that the difference of their orders shows the effect of the
weights (measured in studies/paired_signal). Adam follows the sum of changes times differences.
After a branch one flock of the pair is chosen at random, and both continue from its state. After an
episode of 8 minutes the pair starts at rest again. So every flock-hour is spent on the comparison,
in states that the policy itself leads to.

There is no critic, no baseline and no credit within a branch. The result is the average of the
weights over the second half of the search, a law in a file that every command takes.
"""

import argparse
import shlex
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flockenv.policies import LeaningLaw
from flockenv.policies.laws import LARGEST_LEAN, LEAN_FEATURES
from flockenv.policies.provenance import provenance_of
from flockenv.training.branching import BranchingFlocks

DECAY_1, DECAY_2 = 0.9, 0.99

#: Decisions per second of a flock's three leaders.
DECISIONS_HZ = 3


@dataclass(frozen=True)
class Settings:
    """Settings of the search."""

    pool: str = "wide"
    #: Number of pairs of flocks, and length of a branch in s.
    pairs: int = 64
    branch_s: int = 64
    #: Length in s of the end of a branch. Only the order there counts, since at first even a good
    #: change may lower it.
    judged_s: int = 32
    episode_s: int = 480
    #: Standard deviation of a weight's changes, and the initial learning rate, which falls to 0.
    sigma: float = 0.2
    learning_rate: float = 0.01


def orders_led_by(candidates: np.ndarray, flocks: BranchingFlocks, judged_s: int) -> np.ndarray:
    """Return the mean order of each flock, led by its own weights, at the end of a branch."""
    weights, bias = candidates[:, :-1].astype(np.float32), candidates[:, -1:]
    orders = flocks.branch(lambda rows: np.einsum("fls,fs->fl", rows, weights) + bias)
    return (orders[-judged_s:] / judged_s).sum(axis=0)


def search(settings: Settings, seed: int, flock_hours: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the average weights, and the mean order of each generation."""
    flocks = BranchingFlocks(
        settings.pool,
        groups=settings.pairs,
        size=2,
        branch_s=settings.branch_s,
        episode_s=settings.episode_s,
        seed=seed,
    )
    random = np.random.default_rng([seed, 0])
    generations = max(1, round(flock_hours / flocks.branch_hours))
    weights = np.zeros(len(LEAN_FEATURES) + 1)
    moment_1, moment_2, total = weights.copy(), weights.copy(), weights.copy()
    curve = []
    for number in range(generations):
        changes = random.standard_normal((settings.pairs, len(weights)))
        candidates = weights + settings.sigma * np.concatenate([changes, -changes])
        orders = orders_led_by(candidates, flocks, settings.judged_s)
        differences = orders[: settings.pairs] - orders[settings.pairs :]
        gradient = differences @ changes / (settings.pairs * differences.std() + 1e-12)
        moment_1 = DECAY_1 * moment_1 + (1 - DECAY_1) * gradient
        moment_2 = DECAY_2 * moment_2 + (1 - DECAY_2) * gradient**2
        step = moment_1 / (1 - DECAY_1 ** (number + 1))
        step /= np.sqrt(moment_2 / (1 - DECAY_2 ** (number + 1))) + 1e-8
        weights = weights + settings.learning_rate * (1 - number / generations) * step
        if number >= generations // 2:
            total += weights
        curve.append(orders.mean())
    return total / (generations - generations // 2), np.array(curve)


def law(pool: str, weights: np.ndarray, provenance: dict[str, str]) -> LeaningLaw:
    """Return the law of leans with these weights; the last one is the bias."""
    *leans, bias = map(float, LARGEST_LEAN * weights)
    weights_by_feature = dict(zip(LEAN_FEATURES, leans, strict=True))
    return LeaningLaw(pool, bias, weights_by_feature, bound="clip", provenance=provenance)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pool", choices=("wide", "narrow"), default="wide")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--pairs", type=int, default=Settings().pairs)
    parser.add_argument("--flock-hours", type=float, default=200.0)
    parser.add_argument("--out", type=Path, default=Path("results/paired"))
    options = parser.parse_args(arguments)
    words = sys.argv[1:] if arguments is None else arguments
    settings, start_s = Settings(pool=options.pool, pairs=options.pairs), time.process_time()
    weights, curve = search(settings, options.seed, options.flock_hours)
    hours = 2 * settings.pairs * settings.branch_s / 3600.0
    folder = options.out / str(options.seed)
    folder.mkdir(parents=True, exist_ok=True)
    rows = np.column_stack([hours * np.arange(1, len(curve) + 1), curve])
    header = "flock_hours,signed_order"
    np.savetxt(folder / "curve.csv", rows, "%.5g", ",", header=header, comments="")
    provenance = provenance_of(
        shlex.join(["python", "baselines/paired_branches.py", *words]),
        seed=options.seed,
        samples=round(len(curve) * hours * 3600 * DECISIONS_HZ),
        cpu_s=time.process_time() - start_s,
        flock_hours=len(curve) * hours,
    )
    law(options.pool, weights, provenance).save(folder / "policy.json")
    print(
        f"{len(curve) * hours:.0f} flock-hours, {time.process_time() - start_s:.0f} s of one core"
    )
    print(f"order in branches {curve[0]:.3f} at first, {curve[-len(curve) // 4 :].mean():.3f} late")


if __name__ == "__main__":
    main()
