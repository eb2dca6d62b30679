"""Tune the gains of the damped law on training seeds.

    python baselines/tune_laws.py                            # both pools, half an hour
    python baselines/tune_laws.py --pool narrow --generations 10

The search is CMA-ES (Hansen's covariance matrix adaptation, from the package cmaes) over logarithms
of the gains. A candidate's score is the mean signed order of its episodes. All candidates of a
generation steer the same training episodes, and those of the next generation others. The reported
gains are the search's mean at its end, which depends on all episodes, and not those of the luckiest
candidate. Every candidate is written to results/tune_laws, and the gains to gains.toml beside it.
"""

import argparse
import math
import shlex
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import tomli_w
from provenance import provenance_of
from rich.progress import Progress

import flockenv
from flockenv._io.atomic_write import write_csv, write_text
from flockenv._io.extras import require
from flockenv.comparison import run_episodes
from flockenv.policies import DampedLaw
from flockenv.runs.seeds import POLICY_SEEDS

#: Gains, each with the middle and the width (in factors of e) of the first generation.
RANGES: dict[str, tuple[float, float]] = {
    "gain": (6.0 / math.pi, 1.0),
    "backward_gain": (6.0 / math.pi, 1.0),
    "damping": (6.0, 1.0),
}
POOLS = ("wide", "narrow")


def flock_parameters(pool: str, options: argparse.Namespace) -> flockenv.FlockParameters:
    """27 boats at the pool's critical noise, as policies are compared."""
    preset = flockenv.FlockParameters.preset("simulation")
    return preset.replace(
        pool=pool,
        n_boats=27,
        n_leaders=options.leaders,
        bw_s=flockenv.FlockParameters.critical_bw_s("simulation", pool),
    )


def tune(pool: str, options: argparse.Namespace, progress: Progress) -> dict[str, float]:
    """Return the gains found, having written every candidate."""
    middle, widths = np.array(list(RANGES.values())).T
    first = np.zeros(len(RANGES))
    search = require("cmaes", "search").CMA(mean=first, sigma=0.5, seed=options.seed)
    parameters, rows = flock_parameters(pool, options), []

    def gains(place: np.ndarray) -> dict[str, float]:
        values = middle * np.exp(widths * place)
        return {name: float(f"{value:.3g}") for name, value in zip(RANGES, values, strict=True)}

    task = progress.add_task(pool, total=options.generations)
    for generation in range(options.generations):
        start = generation * options.episodes
        seeds = POLICY_SEEDS["law tuning"].seeds(options.episodes, options.seed, start)
        reported = []
        for _ in range(search.population_size):
            place = search.ask()
            policy = DampedLaw(**gains(place))
            found = run_episodes(parameters, policy, seeds, options.minutes * 60.0)
            score = float(found["signed_order"].mean())
            rows.append({"generation": generation, **gains(place), "signed_order": score})
            reported.append((place, -score))
        search.tell(reported)
        write_csv(options.out / f"damped-law-{pool}.csv", pd.DataFrame(rows))
        progress.advance(task)
    return gains(search.mean)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pool", choices=POOLS, action="append", help="[both]")
    parser.add_argument("--leaders", type=int, default=3)
    parser.add_argument("--generations", type=int, default=10)
    parser.add_argument("--episodes", type=int, default=32, help="for each candidate")
    parser.add_argument("--minutes", type=float, default=8.0, help="length of an episode")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("results/tune_laws"))
    parser.add_argument("--quiet", action="store_true")
    options = parser.parse_args(arguments)
    if min(options.generations, options.episodes) < 1:
        parser.error("generations and episodes are at least 1")
    given = sys.argv[1:] if arguments is None else arguments
    command = shlex.join(["python", "baselines/tune_laws.py", *given])
    start, tuned = time.perf_counter(), dict[str, dict[str, float]]()
    options.out.mkdir(parents=True, exist_ok=True)
    with Progress(disable=options.quiet) as progress:
        for pool in options.pool or POOLS:
            tuned[pool] = tune(pool, options, progress)
    wall_s = time.perf_counter() - start
    provenance = provenance_of(command, seed=options.seed, samples=0, wall_s=wall_s)
    write_text(options.out / "gains.toml", tomli_w.dumps({"damped law": tuned, "made": provenance}))
    print(tomli_w.dumps(tuned))
    print(f"written to {options.out}")


if __name__ == "__main__":
    main()
