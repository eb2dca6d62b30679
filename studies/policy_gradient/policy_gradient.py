"""Measure whether a better leaning law lies near one: the squared gradient of the order.

    python -m studies.policy_gradient.policy_gradient        # some minutes of one core

A lean of a leader changes the flock's order by a slope that depends on what the leader sees. How
far that slope is a linear function of the lean features says how much better a leaning law close by
leads; where no linear part is left, the law is a stationary point of its class.

Design, fixed before the runs:

- States. 256 flocks, led by the policy, after 4 minutes and every 64 s from then on, 20 times.
- Pairs. Each state is branched in two, which meet the flock's own noise. In the first 16 s, and in
  the next, each leader's lean has a normal offset of 0.4 rad; the other branch has the opposite
  one. y is the difference of the branches' order from 8 s to 64 s, over two.
- Slope. The mean over the pairs of y times the offsets times the features is, up to a factor, the
  gradient of the order with the weights. Its square is taken over pairs of different flocks alone,
  so that it is 0 in the mean if no slope depends on the features, and can be negative. It is given
  in two metrics: "lean", the mean of the squared slope with the lean over what leaders saw, in
  (order per rad)², which asks all features alike; and "weights", the squared gradient with the
  weights of the features as they are, in which those of large values count more.
- Chance. The signs of y, one for each pair, are flipped at random 2000 times: their standard
  deviation is what is printed after ±, and p is the share of flips with as large a square. Pairs of
  one flock are 64 s apart and have random offsets of their own.
- Cases. The tuned law and the shipped leaders in `wide` with the 29 lean features and a bias, the
  shipped leaders with the features of the whole flock beside them, and the tuned law in `narrow`.

The first design regressed y on the features in two halves of the flocks, in the first metric alone;
of it the cases in `wide` were seen: p = 0.013, 0.19 and 0.35.

27 boats, three leaders, critical noise, physics of trainings. Seeds follow from the words "policy
gradient". A case that OUT has is not made again.
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import flockenv
from flockenv.policies import LeaningLaw, load
from flockenv.policies.laws import LARGEST_LEAN, LEAN_FEATURES
from flockenv.runs.seeds import release_seeds
from studies.flocks import lean
from studies.store import resumed, write_table
from studies.study import run

FLOCKS, ROUNDS, BEFORE_S, BRANCH_S, HELD_S, HOLDS, SKIPPED_S = 256, 20, 240, 64, 16, 2, 8
OFFSET_RAD, FLIPS = 0.4, 2000
CASES = (
    ("wide", "tuned law", "lean features"),
    ("wide", "learned", "lean features"),
    ("wide", "learned", "lean and flock features"),
    ("narrow", "tuned law", "lean features"),
)


def flocks(pool: str, count: int) -> flockenv.LeadersVectorEnv:
    """Return flocks whose leaders lean, with the order alone as reward, and no end."""
    task = {**lean(pool, 1e4), "reward_horizon_s": 1.0, "mirror_to_target": True}
    task["target"] = "random"
    return flockenv.LeadersVectorEnv(count, autoreset_mode="disabled", **task)


def weights_of(policy: str) -> np.ndarray:
    """Return the weights of the features and the bias, in units of the largest lean."""
    if policy == "tuned law":
        return np.zeros(len(LEAN_FEATURES) + 1)
    law = load(policy, pool="wide")
    assert isinstance(law, LeaningLaw)
    return np.array([*(law.weights[name] for name in LEAN_FEATURES), law.bias]) / LARGEST_LEAN


def with_bias(seen: np.ndarray) -> np.ndarray:
    """Return what leaders see and a one, shape (flocks, leaders, features + 1)."""
    rows = seen.reshape(len(seen), -1, len(LEAN_FEATURES)).astype(float)
    return np.concatenate([rows, np.ones_like(rows[..., :1])], axis=-1)


def pairs(
    pool: str, policy: str, count: int, rounds: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return offsets, features and differences of all pairs, in the order of rounds and flocks.

    Shapes (pairs, holds, leaders), (pairs, holds, leaders, features) and (pairs,). Features are the
    mean of both branches at the start of a hold: of the leader, a one, and of the whole flock.
    """
    weights, random = weights_of(policy), np.random.default_rng([len(pool), len(policy)])
    trunk, branches = flocks(pool, count), flocks(pool, 2 * count)
    seen, infos = trunk.reset(seed=list(release_seeds("policy gradient", count)))
    targets = [str(each) for each in infos["target"]]
    branches.reset(seed=0)
    found = []
    for number in range(rounds):
        for _ in range(BRANCH_S if number else BEFORE_S):
            seen, *_ = trunk.step(np.tanh(with_bias(seen) @ weights))
        start: dict[str, Any] = {"snapshot": 2 * trunk.snapshots(), "target": 2 * targets}
        ahead, _ = branches.reset(options=start)
        offsets = random.normal(0.0, OFFSET_RAD, (count, HOLDS, trunk.num_leaders))
        features, y = [], np.zeros(count)
        for second in range(BRANCH_S):
            hold, begun = divmod(second, HELD_S)
            if hold < HOLDS and begun == 0:
                features.append(_features(branches, ahead))
            added = offsets[:, hold] / LARGEST_LEAN if hold < HOLDS else 0.0 * offsets[:, 0]
            leans = np.tanh(with_bias(ahead) @ weights) + np.concatenate([added, -added])
            ahead, orders, *_ = branches.step(np.clip(leans, -1.0, 1.0))
            if second >= SKIPPED_S:
                y += (orders[:count] - orders[count:]) / 2.0
        found.append((offsets, np.stack(features, 1), y / (BRANCH_S - SKIPPED_S)))
    offsets, features, y = (np.concatenate(each) for each in zip(*found, strict=True))
    return offsets, features, y


def _features(branches: Any, seen: np.ndarray) -> np.ndarray:
    own = with_bias(seen)
    whole = np.asarray(branches.flock_features(), float).reshape(len(seen), 1, -1)
    every = np.concatenate([own, whole.repeat(own.shape[1], axis=1)], axis=-1)
    return every.reshape(2, -1, *every.shape[1:]).mean(axis=0)


def squared_gradient(
    offsets: np.ndarray, features: np.ndarray, y: np.ndarray, flock: np.ndarray, flips: int = FLIPS
) -> dict[str, tuple[float, float, float]]:
    """Return the squared gradient by its metric, its spread in random signs, and p.

    `flock` is the number of the flock of each pair.
    """
    x = np.einsum("phl,phlf->pf", offsets, features)
    held = offsets.shape[1] * offsets.shape[2] * OFFSET_RAD**2
    met = np.einsum("phlf,phlg->fg", features, features) / offsets.size
    signs = np.random.default_rng(0).choice((-1.0, 1.0), (flips, len(y)))
    found = {}
    for metric, change in (
        ("lean", np.linalg.pinv(met, rcond=1e-6)),
        ("weights", np.eye(len(met))),
    ):
        values, directions = np.linalg.eigh(change)
        seen = x @ (directions * np.sqrt(np.maximum(values, 0.0))) / held

        def square(signed: np.ndarray, seen: np.ndarray = seen) -> Any:
            each = np.array([signed[..., flock == n] @ seen[flock == n] for n in np.unique(flock)])
            pairs = len(y) ** 2 - (np.unique(flock, return_counts=True)[1] ** 2).sum()
            return ((each.sum(0) ** 2).sum(-1) - (each**2).sum((0, -1))) / pairs

        value, drawn = float(square(y)), square(signs * y)
        found[metric] = value, float(drawn.std()), float((drawn >= value).mean())
    return found


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--flocks", type=int, default=FLOCKS)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument(
        "--out", type=Path, default=Path("studies/policy_gradient/results/gradient.csv")
    )
    options = parser.parse_args(arguments)
    made, rows = {}, resumed(options.out).to_dict("records")
    done = {(row["pool"], row["policy"], row["features"]) for row in rows}
    for pool, policy, named in (case for case in CASES if case not in done):
        if (pool, policy) not in made:
            made[pool, policy] = pairs(pool, policy, options.flocks, options.rounds)
        offsets, features, y = made[pool, policy]
        used = features if "flock" in named else features[..., : len(LEAN_FEATURES) + 1]
        flock = np.arange(len(y)) % options.flocks
        for metric, (value, spread, p) in squared_gradient(offsets, used, y, flock).items():
            row = {"pool": pool, "policy": policy, "features": named, "metric": metric}
            row |= {"pairs": len(y), "squared_gradient": value, "spread": spread, "p": p}
            rows.append(row)
            case = f"{pool}, {policy}, {named}, {metric}"
            print(f"{case}: {value:+.3g} ± {spread:.2g}, p = {p:.2g}", flush=True)
        write_table(options.out, pd.DataFrame(rows), "%.4g")


if __name__ == "__main__":
    run(main)
