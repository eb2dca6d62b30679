"""Search leaders in pairs of branches: one state, one noise, and opposite changes of the weights.

    python baselines/paired_branches.py --seed 0          # from the tuned law, a minute of one core
    flockenv compare --policy "tuned law" --policy results/paired/0/policy.json --n-leaders 3
    python -m studies.trainings.judge_trainings results/paired/*     # in the same 512 flocks

Seeds 0 to 4 reach an order of 0.455 to 0.481 with 200 flock-hours, 42 s of one core each, where the
tuned law has 0.451.

A policy is linear in the 29 lean features, as in examples/train_leaders.py, and starts as the tuned
law. Each pair of flocks starts from one snapshot and meets one noise. The two flocks differ by a
Gaussian change of the weights, added in one and subtracted in the other. For about a minute what
the noise does to them is nearly the same, so that the difference of their orders shows the change
of the weights (studies/paired_signal has the measurement). Adam follows the sum of changes times
differences. Then both flocks of a pair continue from the present state of one of them, drawn by a
coin, until an episode of 8 minutes is over and the pair starts at rest again. So no flock-hour is
spent on anything but the comparison, and the states are those that the policy leads to.

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

import flockenv
from flockenv.policies import LeaningLaw
from flockenv.policies.laws import LARGEST_LEAN, LEAN_FEATURES
from flockenv.policies.provenance import provenance_of
from flockenv.runs.seeds import POLICY_SEEDS

DECAY_1, DECAY_2 = 0.9, 0.99


@dataclass(frozen=True)
class Settings:
    """What the search depends on."""

    pool: str = "wide"
    #: Pairs of flocks, and how many s they stay paired.
    pairs: int = 64
    branch_s: int = 64
    #: The order counts in this last part of a branch: before, it may answer the wrong way.
    judged_s: int = 32
    episode_s: int = 480
    #: Standard deviation of the changes of a weight, and the first learning rate, which falls to 0.
    sigma: float = 0.2
    learning_rate: float = 0.01


class Pairs:
    """Pairs of flocks that branch from one state: flocks i and i + pairs."""

    def __init__(self, settings: Settings, seed: int) -> None:
        self.settings, self.pairs = settings, settings.pairs
        others = dict.fromkeys(("own", "phase", "target", "order"), False)
        self.env = flockenv.LeadersVectorEnv(
            2 * self.pairs,
            autoreset_mode="disabled",
            pool=settings.pool,
            n_boats=27,
            n_leaders=3,
            bw_s=flockenv.FlockParameters.critical_bw_s("simulation", settings.pool),
            observation={**others, "neighbors": 0, "lean_features": True},
            mirror_to_target=True,
            action_mode="lean",
            decision_period_s=1.0,
            episode_s=settings.branch_s,
            reward_horizon_s=1.0,
            physics="training",
        )
        self._coins = np.random.default_rng([seed, 1])
        self._seeds = iter(POLICY_SEEDS["paired branches"].seeds(1 << 20, run=seed))
        self._branches = settings.episode_s // settings.branch_s
        #: How many branches of its episode each pair has had: at first all numbers alike.
        self._had = np.arange(self.pairs) % self._branches
        self._snapshots: list[bytes] = []
        self._targets = np.full(self.pairs, "ccw")
        self._rest(np.ones(self.pairs, bool))

    def _rest(self, pairs: np.ndarray) -> None:
        """Start the episodes of these pairs at rest, both flocks of one with one seed."""
        seeds = [next(self._seeds) if each else None for each in pairs]
        self._targets[pairs] = self._coins.choice(["cw", "ccw"], pairs.sum())
        options = {"target": 2 * self._targets.tolist(), "reset_mask": np.tile(pairs, 2)}
        self.env.reset(seed=2 * seeds, options=options)

    def _start(self) -> np.ndarray:
        """Start the next branch of each pair, and return what leaders see."""
        if self._snapshots:
            branching = self._had < self._branches
            options = {"snapshot": 2 * self._snapshots, "target": 2 * self._targets.tolist()}
            self.env.reset(options={**options, "reset_mask": np.tile(branching, 2)})
            if not branching.all():
                self._rest(~branching)
                self._had[~branching] = 0
        return self.env.observe()

    def branch(self, candidates: np.ndarray) -> np.ndarray:
        """Return the mean order of each flock, led by its own weights, at the end of a branch."""
        seen = self._start()
        weights, bias = candidates[:, :-1].astype(np.float32), candidates[:, -1:]
        orders = np.zeros(len(candidates))
        for second in range(self.settings.branch_s):
            rows = seen.reshape(len(candidates), -1, weights.shape[1])
            leans = np.einsum("fls,fs->fl", rows, weights) + bias
            seen, rewards, *_ = self.env.step(np.clip(leans, -1.0, 1.0))
            if second >= self.settings.branch_s - self.settings.judged_s:
                orders += rewards / self.settings.judged_s
        continued = (self._coins.random(self.pairs) * 2).astype(int)
        ends = self.env.snapshots()
        self._snapshots = [ends[pair + self.pairs * b] for pair, b in enumerate(continued)]
        self._had += 1
        return orders


def search(settings: Settings, seed: int, flock_hours: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the weights, and the mean order of each generation."""
    pairs = Pairs(settings, seed)
    random = np.random.default_rng([seed, 0])
    hours = 2 * settings.pairs * settings.branch_s / 3600.0
    generations = max(1, round(flock_hours / hours))
    weights = np.zeros(len(LEAN_FEATURES) + 1)
    moment_1, moment_2, total = weights.copy(), weights.copy(), weights.copy()
    curve = []
    for number in range(generations):
        changes = random.standard_normal((settings.pairs, len(weights)))
        candidates = weights + settings.sigma * np.concatenate([changes, -changes])
        orders = pairs.branch(candidates)
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
    """Return the law of leans by these weights, the last of which is the bias."""
    *leans, bias = map(float, LARGEST_LEAN * weights)
    named = dict(zip(LEAN_FEATURES, leans, strict=True))
    return LeaningLaw(pool, bias, named, bound="clip", provenance=provenance)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pool", choices=("wide", "narrow"), default="wide")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--flock-hours", type=float, default=200.0)
    parser.add_argument("--out", type=Path, default=Path("results/paired"))
    options = parser.parse_args(arguments)
    given = sys.argv[1:] if arguments is None else arguments
    settings, start = Settings(pool=options.pool), time.process_time()
    weights, curve = search(settings, options.seed, options.flock_hours)
    hours = 2 * settings.pairs * settings.branch_s / 3600.0
    folder = options.out / str(options.seed)
    folder.mkdir(parents=True, exist_ok=True)
    rows = np.column_stack([hours * np.arange(1, len(curve) + 1), curve])
    header = "flock_hours,signed_order"
    np.savetxt(folder / "curve.csv", rows, "%.5g", ",", header=header, comments="")
    provenance = provenance_of(
        shlex.join(["python", "baselines/paired_branches.py", *given]),
        seed=options.seed,
        samples=round(len(curve) * hours * 3600 * 3),
        cpu_s=time.process_time() - start,
        flock_hours=len(curve) * hours,
    )
    law(options.pool, weights, provenance).save(folder / "policy.json")
    print(f"{len(curve) * hours:.0f} flock-hours, {time.process_time() - start:.0f} s of one core")
    print(f"order in branches {curve[0]:.3f} at first, {curve[-len(curve) // 4 :].mean():.3f} late")


if __name__ == "__main__":
    main()
