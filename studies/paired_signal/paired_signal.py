"""Measure how long two branches of one state stay paired, and what that is worth to a learner.

    python -m studies.paired_signal.paired_signal    # a minute of one core

With 1024 states the signal after 48 s is 1.10 in pairs and 0.38 in other flocks, per square root of
a flock-hour.

Flocks led by the tuned law for 4 minutes are branched in two under one noise: one continues by the
tuned law, the other leans as the learned leaders do. Their orders differ by what the better policy
does, and by what chaos has made of it. z is the mean of the difference over its standard error. It
grows with the square root of the flock-hours, so that z per square root of a flock-hour compares
horizons. Unpaired, the two policies lead flocks of other seeds. `wide`, 27 boats, three leaders,
bw = 0.31 s, physics of trainings; the seeds follow from the words "paired signal".
"""

import argparse
from pathlib import Path

import numpy as np
import pandas as pd

from flockenv.runs.seeds import release_seeds
from studies.planning.plan_ahead import flocks, learned
from studies.store import check_version, write_table
from studies.study import run

HORIZONS_S = (8, 16, 24, 32, 48, 64, 96, 128, 192, 240)
LONGEST_S, WINDOW_S = 240, 8


def orders(states: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the order in each second after the branch, by the law and by the learned leans."""
    trunk, seeds = flocks(states, LONGEST_S), release_seeds("paired signal", states)
    _, infos = trunk.reset(seed=list(seeds))
    straight = np.zeros((states, trunk.num_leaders), np.float32)
    for _ in range(LONGEST_S - 1):
        trunk.step(straight)
    branches, leans = flocks(2 * states, LONGEST_S), learned()
    start = {"snapshot": 2 * trunk.snapshots(), "target": 2 * infos["target"].tolist()}
    seen, _ = branches.reset(seed=0, options=start)
    found = []
    for _ in range(LONGEST_S):
        seen, rewards, *_ = branches.step(np.concatenate([straight, leans(seen)[states:]]))
        found.append(rewards)
    each = np.array(found).T
    return each[:states], each[states:]


def signal(first: np.ndarray, second: np.ndarray, paired: bool) -> tuple[float, float, float]:
    """Return the mean difference, its scatter, and z for one pair."""
    difference = second - first if paired else second - np.roll(first, 1)
    mean, scatter = difference.mean(), difference.std(ddof=1)
    return float(mean), float(scatter), float(mean / scatter)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--states", type=int, default=1024)
    parser.add_argument("--out", type=Path, default=Path("studies/paired_signal/results"))
    options = parser.parse_args(arguments)
    check_version(options.out / "signal.csv")
    law, better = orders(options.states)
    random, rows = np.random.default_rng(0), []
    for horizon in HORIZONS_S:
        last = slice(horizon - WINDOW_S, horizon)
        ends = law[:, last].mean(axis=1), better[:, last].mean(axis=1)
        spend = np.sqrt(2.0 * horizon / 3600.0)
        for paired in (True, False):
            mean, scatter, z = signal(*ends, paired)
            again = [
                signal(ends[0][chosen], ends[1][chosen], paired)[2]
                for chosen in random.integers(0, options.states, (2000, options.states))
            ]
            low, high = np.percentile(again, [2.5, 97.5]) / spend
            row = {"horizon_s": horizon, "paired": paired, "difference": mean, "scatter": scatter}
            rows.append({**row, "z": z / spend, "z_low": low, "z_high": high})
    write_table(options.out / "signal.csv", pd.DataFrame(rows))


if __name__ == "__main__":
    run(main, resumes=False)
