"""Measure the critical noise of a pool and preset, at which leaderless order is lost.

With seeds 0 to 7 it is 0.31 s in `wide` and 0.45 s in `narrow`, for the preset `simulation`.

The critical noise is the length bw of the backward phase at which mean Ψ_o of leaderless runs falls
through the middle between its ordered and its disordered level. The ordered level is mean Ψ_o at
the noise of the strongest rotation, mean |Ψ_o sin φ_o|, so that a jam, which has a high Ψ_o too, is
not taken for order; the disordered level is mean Ψ_o at the highest noise.

    python -m studies.critical_noise.critical_noise --seeds 8 \
        --out studies/critical_noise/results/critical_noise.csv
    python -m studies.critical_noise.critical_noise --preset experiment --pool narrow \
        --out studies/critical_noise/results/critical_noise_experiment.csv

Runs that stand in the file are not made again. The committed tables are of results versions 1 and
2: a scan by other code goes to another file.
"""

import argparse
import os
from itertools import product
from pathlib import Path

import numpy as np

import flockenv
from flockenv.statistics import critical_noise
from studies.store import Row, Store, existing
from studies.study import run

NOISE_S = {
    "simulation": np.round(np.arange(0.0, 0.91, 0.05), 2),
    "paper": np.round(np.arange(0.0, 0.91, 0.05), 2),
    "experiment": np.round(np.arange(0.4, 2.81, 0.2), 1),
}
POOLS = ("wide", "narrow")


def order_of_run(row: Row) -> Row:
    """Return mean Ψ_o and mean |Ψ_o sin φ_o| after the first tenth of a run."""
    flock = {name: row[name] for name in ("n_boats", "pool", "bw_s")}
    parameters = flockenv.FlockParameters.preset(row["preset"]).replace(**flock)
    made = flockenv.simulate(parameters, row["seed"], row["minutes"] * 60, dtype=np.float32)
    order = made.analyzed().order
    return {"psi_o": order.psi_o.mean(), "rotation": abs(order.rotation()).mean()}


def main(arguments: list[str] | None = None) -> None:
    """Make the runs that are missing, and print the critical noise of each pool."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--boats", type=int, default=27)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--out", type=Path, default=Path("results/critical_noise.csv"))
    parser.add_argument("--preset", choices=NOISE_S, action="append")
    parser.add_argument("--pool", choices=POOLS, action="append")
    options = parser.parse_args(arguments)
    if options.seeds < 1:
        parser.error("--seeds is at least 1")

    names = ("preset", "pool", "bw_s", "seed", "n_boats", "minutes")
    rows = [
        dict(zip(names, (*cell, options.boats, options.minutes), strict=True))
        for preset in options.preset or ("simulation", "paper")
        for cell in product(
            [preset], options.pool or POOLS, NOISE_S[preset].tolist(), range(options.seeds)
        )
    ]
    store = Store(existing(options.out), names)
    keys = {store.key(row): row for row in rows}
    missing = {key: row for key, row in keys.items() if key not in store.lines}
    store.fill(missing, order_of_run, os.cpu_count() or 1)
    runs = store.table(keys)
    for (preset, pool), group in runs.groupby(["preset", "pool"], sort=False):
        levels = group.groupby("bw_s")[["psi_o", "rotation"]]
        noise, low, high = critical_noise(list(levels.groups), [runs for _, runs in levels])
        print(f"{preset:10} {pool:9} {noise:.3f} s  [{low:.3f}, {high:.3f}]")


if __name__ == "__main__":
    run(main)
