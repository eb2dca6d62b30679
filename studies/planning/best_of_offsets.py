"""Measure what one step of planning without foresight adds to the learned leaders.

    python -m studies.planning.best_of_offsets        # a quarter of an hour of one core

Design, fixed before the runs. 128 states: flocks that the learned leaders have led for 4 minutes.
From each, 16 joint offsets of the leans are tried: none first, and 15 with a normal offset for each
leader (0.3 rad), held for 16 s. Each meets the same 64 continuations
by fresh noise, which the flock itself does not meet. One half of the noises chooses the best offset
by the mean order from 8 s after the branch to the horizon, the other half judges it against none;
then the halves change places. The gain of a state is the mean of both. It would be 0 in the mean if
no offset were better than another. The leaders go on as learned after 16 s, so that this is one
step: a planner that replans could add more, and 16 offsets at random are not all there are.

`wide`, 27 boats, three leaders, bw = 0.31 s, physics of trainings. Seeds follow from the words
"best of offsets". OUT/best_of_offsets.csv has a row for each state, set and horizon; an interrupted
command resumes after its last block of states.
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from flockenv.policies.laws import LARGEST_LEAN
from flockenv.runs.seeds import release_seeds
from flockenv.statistics import mean_interval
from studies.planning.plan_ahead import flocks, learned
from studies.store import resumed, write_table
from studies.study import run

STATES, OFFSETS, NOISES, BLOCK = 128, 16, 64, 4
SIZES_RAD, HORIZONS_S, BEFORE_S, HELD_S, SKIPPED_S = (0.3,), (64, 96), 240, 16, 8


def states(count: int) -> tuple[list[bytes], list[str]]:
    """Return the snapshots and targets of flocks that the learned leaders have led."""
    trunk, leans = flocks(count, 1e4), learned()
    seen, infos = trunk.reset(seed=list(release_seeds("best of offsets", count)))
    for _ in range(BEFORE_S):
        seen, *_ = trunk.step(leans(seen))
    return trunk.snapshots(), [str(each) for each in infos["target"]]


def orders(
    snapshots: list[bytes], targets: list[str], offsets: np.ndarray, noises: int, first: int
) -> np.ndarray:
    """Return the order in each second of each branch, shape (seconds, states, offsets, noises).

    `offsets` (states, offsets, leaders) are in rad, and `first` is the seed of the first noise.
    """
    count, tried, leaders = offsets.shape
    each = tried * noises
    branches, leans = flocks(count * each, 1e4), learned()
    start: dict[str, Any] = {
        "snapshot": [blob for blob in snapshots for _ in range(each)],
        "target": [target for target in targets for _ in range(each)],
        "noise_seed": list(range(first, first + noises)) * (count * tried),
    }
    seen, _ = branches.reset(seed=0, options=start)
    added = (offsets / LARGEST_LEAN).repeat(noises, axis=1).reshape(-1, leaders)
    found = []
    for second in range(max(HORIZONS_S)):
        actions = leans(seen) + (added if second < HELD_S else 0.0)
        seen, reward, *_ = branches.step(np.clip(actions, -1.0, 1.0))
        found.append(reward)
    return np.array(found).reshape(-1, count, tried, noises)


def gains(scores: np.ndarray) -> np.ndarray:
    """Return the gain of each state by scores (states, offsets, noises), the first offset none."""
    halves = scores[..., ::2].mean(axis=-1), scores[..., 1::2].mean(axis=-1)
    both = []
    for chooses, judges in (halves, halves[::-1]):
        best = chooses.argmax(axis=1)
        both.append(judges[np.arange(len(judges)), best] - judges[:, 0])
    return np.asarray(np.mean(both, axis=0))


def block(
    number: int, size_rad: float, snapshots: list[bytes], targets: list[str], noises: int
) -> list[dict[str, float]]:
    """Return the rows of a block of states."""
    random = np.random.default_rng([number, round(100 * size_rad)])
    offsets = random.normal(0.0, size_rad, (len(snapshots), OFFSETS, 3))
    offsets[:, 0] = 0.0
    found = orders(snapshots, targets, offsets, noises, number * NOISES)
    rows = []
    for horizon in HORIZONS_S:
        scores = found[SKIPPED_S:horizon].mean(axis=0)
        for place, gain in enumerate(gains(scores)):
            row = {"state": number * BLOCK + place, "offset_rad": size_rad, "horizon_s": horizon}
            row |= {"order": scores[place, 0].mean(), "gain": gain}
            rows.append(row)
    return rows


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--states", type=int, default=STATES)
    parser.add_argument("--noises", type=int, default=NOISES)
    parser.add_argument(
        "--out", type=Path, default=Path("studies/planning/results/best_of_offsets.csv")
    )
    options = parser.parse_args(arguments)
    snapshots, targets = states(options.states)
    rows = resumed(options.out).to_dict("records")
    done = {(row["state"], row["offset_rad"]) for row in rows}
    for size_rad in SIZES_RAD:
        for first in range(0, options.states, BLOCK):
            if (first, size_rad) in done:
                continue
            own = slice(first, first + BLOCK)
            rows += block(first // BLOCK, size_rad, snapshots[own], targets[own], options.noises)
            write_table(options.out, pd.DataFrame(rows))
        table = pd.DataFrame(rows)
        for horizon, found in table[table["offset_rad"] == size_rad].groupby("horizon_s"):
            mean, low, high = mean_interval(found["gain"])
            print(f"{size_rad} rad, {horizon} s: gain {mean:+.3f} ({low:+.3f} to {high:+.3f})")


if __name__ == "__main__":
    run(main)
