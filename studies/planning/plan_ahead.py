"""Lead by planning ahead: branch the simulator every 8 s and take the best of 16 joint leans.

    python -m studies.planning.plan_ahead --noise fresh   # without knowing the noise
    python -m studies.planning.plan_ahead --noise known   # an upper mark: the noise is foreseen

In 64 flocks, seeds 2917986337 to 2917986400, the planner that knows the noise reaches an order of
0.753, the other one 0.494, and the pretrained leaders 0.503.

This is not a policy: it clones the whole flock, which no robot can do. It shows how much more order
the dynamics and the leans allow than the learned leaders reach. Every 8 s each flock is branched
from its snapshot. The first candidate is what the learned leaders do. The others add a constant
offset to each leader's lean for 16 s. A candidate's score is the mean signed order from 24 s to
32 s after the branch; in the first 8 s the order answers the wrong way. With `fresh` noise each
candidate meets the same continuations of the noise, which the flock itself does not meet
(`noise_seed`); with `known` it meets the flock's own. The flock follows the best candidate for 8 s.

Episodes are those of the task of examples/train_leaders.py (`wide`, three leaders, bw = 0.31 s,
8 minutes, physics of trainings), with seeds that follow from the words "plan ahead". An interrupted
command resumes after its last block of flocks. The folder results
keeps the tables as plan_fresh.csv and plan_known.csv.
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import flockenv
from flockenv.comparison import score_policies
from flockenv.policies import LeaningLaw, load
from flockenv.policies.laws import LARGEST_LEAN, LEAN_FEATURES
from flockenv.runs.seeds import release_seeds
from studies.flocks import lean
from studies.store import resumed, write_table
from studies.study import run

EPISODE_S, EVERY_S, HELD_S, HORIZON_S, JUDGED_S = 480, 8, 16, 32, 8
CANDIDATES, OFFSET_RAD = 16, 0.3
BLOCK = 16


def flocks(count: int, episode_s: float) -> flockenv.LeadersVectorEnv:
    """Return flocks whose leaders lean, and whose reward is the order alone."""
    task = {**lean("wide", episode_s), "reward_horizon_s": 1.0, "mirror_to_target": True}
    task["target"] = "random"
    return flockenv.LeadersVectorEnv(count, autoreset_mode="disabled", **task)


def learned() -> Any:
    """Return what maps what leaders see (flocks, leaders * size) to the learned leaders' leans."""
    law = load("learned", pool="wide")
    assert isinstance(law, LeaningLaw)
    weights = np.array([law.weights[name] for name in LEAN_FEATURES], np.float32)

    def leans(seen: np.ndarray) -> np.ndarray:
        rows = seen.reshape(len(seen), -1, len(LEAN_FEATURES))
        return np.tanh((rows @ weights + np.float32(law.bias)) / LARGEST_LEAN)

    return leans


def ahead(
    branches: Any, snapshots: list[bytes], targets: list[str], number: int, fresh: int, seed: int
) -> np.ndarray:
    """Return the offsets (flocks, leaders) of the best candidate of each flock.

    `fresh` is the number of continuations by other noise, and 0 for the flock's own noise.
    """
    random = np.random.default_rng([seed, number])
    leaders, leans = branches.num_leaders, learned()
    offsets = random.normal(0.0, OFFSET_RAD / LARGEST_LEAN, (len(snapshots), CANDIDATES, leaders))
    offsets[:, 0] = 0.0
    continuations = max(1, fresh)
    each = CANDIDATES * continuations
    start: dict[str, Any] = {
        "snapshot": [blob for blob in snapshots for _ in range(each)],
        "target": [target for target in targets for _ in range(each)],
    }
    if fresh:
        # One more seed per continuation, the same for all candidates of all flocks.
        noises = [number * fresh + of for of in range(fresh)]
        start["noise_seed"] = noises * (len(snapshots) * CANDIDATES)
    seen, _ = branches.reset(options=start)
    added = offsets.repeat(continuations, axis=1).reshape(-1, leaders)
    scores = np.zeros(branches.num_envs)
    for second in range(HORIZON_S):
        actions = leans(seen) + (added if second < HELD_S else 0.0)
        seen, orders, *_ = branches.step(np.clip(actions, -1.0, 1.0))
        scores += orders if second >= HORIZON_S - JUDGED_S else 0.0
    best = scores.reshape(len(snapshots), CANDIDATES, continuations).mean(axis=2).argmax(axis=1)
    return offsets[np.arange(len(snapshots)), best]


def episodes(seeds: list[int], fresh: int | None) -> np.ndarray:
    """Return the signed order of one episode of each seed; None: the learned leaders' without."""
    env, leans = flocks(len(seeds), EPISODE_S), learned()
    branches = flocks(len(seeds) * CANDIDATES * max(1, fresh or 0), HORIZON_S)
    branches.reset(seed=0)
    seen, infos = env.reset(seed=seeds)
    targets = [str(each) for each in infos["target"]]
    for number in range(EPISODE_S // EVERY_S):
        added = np.zeros((len(seeds), env.num_leaders))
        if fresh is not None:
            added = ahead(branches, env.snapshots(), targets, number, fresh, seeds[0])
        for _ in range(EVERY_S):
            seen, _, _, ended, infos = env.step(np.clip(leans(seen) + added, -1.0, 1.0))
    assert ended.all()
    return np.asarray(infos["episode_summary"]["signed_order"])


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--noise", choices=("fresh", "known"), default="fresh")
    parser.add_argument("--continuations", type=int, default=4, help="of fresh noise")
    parser.add_argument("--episodes", type=int, choices=range(2, 65), default=64, metavar="2-64")
    parser.add_argument("--out", type=Path, default=Path("results/plan_ahead"))
    options = parser.parse_args(arguments)
    if options.continuations < 1:
        parser.error("--continuations is at least 1")
    fresh = options.continuations if options.noise == "fresh" else 0
    path = options.out / (f"fresh_{fresh}.csv" if fresh else "known.csv")
    rows = resumed(path).to_dict("records")
    seeds = release_seeds("plan ahead", 64)[: options.episodes]
    for first in range(len(rows), len(seeds), BLOCK):
        block = list(seeds[first : first + BLOCK])
        plain, planned = episodes(block, None), episodes(block, fresh)
        for seed, learned_order, order in zip(block, plain, planned, strict=True):
            rows.append({"seed": seed, "learned": learned_order, "planned": order})
        write_table(path, pd.DataFrame(rows), "%.17g")
        found = {name: [row[name] for row in rows] for name in ("learned", "planned")}
        scores = score_policies(found, "learned")
        print(scores.round(3).to_string(index=False), flush=True)


if __name__ == "__main__":
    run(main)
