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
"""

import argparse
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from rich.progress import track

import flockenv
from flockenv.runs.executors import finished
from flockenv.statistics import critical_noise
from studies.study import run, write_table

NOISE_S = {
    "simulation": np.round(np.arange(0.0, 0.91, 0.05), 2),
    "paper": np.round(np.arange(0.0, 0.91, 0.05), 2),
    "experiment": np.round(np.arange(0.4, 2.81, 0.2), 1),
}
POOLS = ("wide", "narrow")


def order_of_run(
    parameters: flockenv.FlockParameters, seed: int, minutes: float
) -> dict[str, float]:
    """Mean Ψ_o and mean |Ψ_o sin φ_o| in the analysis window after the first tenth of a run."""
    order = flockenv.simulate(parameters, seed, minutes * 60, dtype=np.float32).analyzed().order
    return {"psi_o": order.psi_o.mean(), "rotation": abs(order.rotation()).mean()}


def main(arguments: list[str] | None = None) -> None:
    """Run the scan, write one row per run, print the critical noise of each pool."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--boats", type=int, default=27)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--minutes", type=float, default=30)
    parser.add_argument("--out", type=Path, default=Path("results/critical_noise.csv"))
    parser.add_argument("--preset", choices=NOISE_S, action="append")
    parser.add_argument("--pool", choices=POOLS, action="append")
    options = parser.parse_args(arguments)
    if options.seeds < 1:
        parser.error("--seeds is at least 1")

    cells = [
        cell
        for preset in options.preset or ("simulation", "paper")
        for cell in product(
            [preset], options.pool or POOLS, NOISE_S[preset].tolist(), range(options.seeds)
        )
    ]

    def run(cell: tuple[str, str, float, int]) -> dict[str, object]:
        preset, pool, bw_s, seed = cell
        parameters = flockenv.FlockParameters.preset(preset)
        parameters = parameters.replace(n_boats=options.boats, pool=pool, bw_s=bw_s)
        order = order_of_run(parameters, seed, options.minutes)
        return {"preset": preset, "pool": pool, "bw_s": bw_s, "seed": seed, **order}

    found = dict(track(finished(run, cells), "simulating", total=len(cells)))
    rows = [found[place] for place in range(len(cells))]
    runs = pd.DataFrame(rows)
    write_table(options.out, runs.round(4))
    for (preset, pool), group in runs.groupby(["preset", "pool"], sort=False):
        levels = group.groupby("bw_s")[["psi_o", "rotation"]]
        noise, low, high = critical_noise(list(levels.groups), [runs for _, runs in levels])
        print(f"{preset:10} {pool:9} {noise:.3f} s  [{low:.3f}, {high:.3f}]")


if __name__ == "__main__":
    run(main)
