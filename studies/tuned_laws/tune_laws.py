"""Tune the gains of the damped law in each pool and for each number of leaders, and judge them.

    python -m studies.tuned_laws.tune_laws           # both pools, 1 to 4 leaders, 1.6 hours
    python -m studies.tuned_laws.tune_laws --pool narrow --leaders 3 --generations 10

No gains that two searches found, seeds 0 and 1, pass the tuned law by more than 0.003.

A search is CMA-ES (Hansen's covariance matrix adaptation, from the package cmaes) over logarithms
of the gains. A candidate's score is the mean signed order of its episodes. All candidates of a
generation steer the same training episodes, and those of the next generation others. A search ends
with the mean of its distribution, which depends on all episodes, and not with the luckiest
candidate. The gains of a pool and number of leaders are the means (of logarithms) of two searches
with seeds of their own, which take 2000 flock-hours together by the physics of trainings: the
experience of a training of leaders.

The design was fixed before the searches: the gains found are judged against the pool's tuned law in
2048 fresh flocks per pool and number of leaders by the default physics, paired by flock. The tuned
law of a pool gets new gains where those for three leaders gain more than 0.01 with an interval
above 0; in any case the table stands beside that of the pretrained leaders.

Every candidate is written to results/tune_laws, and the judged gains to gains.csv beside them. A
search whose candidates stand there is not made again.
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
from cmaes import CMA
from rich.progress import Progress

import flockenv
from flockenv.comparison import run_episodes, score_policies
from flockenv.policies import DampedLaw
from flockenv.policies.provenance import provenance_of
from flockenv.runs.seeds import POLICY_SEEDS, release_seeds
from studies.store import resumed, write_table
from studies.study import run

#: Gains, each with the middle and the width (in factors of e) of the first generation.
RANGES: dict[str, tuple[float, float]] = {
    "gain": (6.0 / math.pi, 1.0),
    "backward_gain": (6.0 / math.pi, 1.0),
    "damping": (6.0, 1.0),
}
POOLS = ("wide", "narrow")


def flock_parameters(pool: str, leaders: int) -> flockenv.FlockParameters:
    """27 boats at the pool's critical noise, as policies are compared."""
    preset = flockenv.FlockParameters.preset("simulation")
    bw_s = flockenv.FlockParameters.critical_bw_s("simulation", pool)
    return preset.replace(pool=pool, n_boats=27, n_leaders=leaders, bw_s=bw_s)


def law(logarithms: np.ndarray) -> dict[str, float]:
    """Return the gains with these logarithms, to three digits."""
    values = np.exp(logarithms)
    return {name: float(f"{value:.3g}") for name, value in zip(RANGES, values, strict=True)}


def search(pool: str, leaders: int, seed: int, options: argparse.Namespace) -> pd.DataFrame:
    """Return every candidate of a search, and its mean at the end as generation -1."""
    middle, widths = np.array(list(RANGES.values())).T
    first = np.zeros(len(RANGES))
    cma = CMA(mean=first, sigma=0.5, seed=seed)
    parameters, rows = flock_parameters(pool, leaders), []
    for generation in range(options.generations):
        start = generation * options.episodes
        seeds = POLICY_SEEDS["law tuning"].seeds(options.episodes, seed, start)
        reported = []
        for _ in range(cma.population_size):
            place = cma.ask()
            gains = law(np.log(middle) + widths * place)
            found = run_episodes(
                parameters,
                DampedLaw(**gains),
                seeds,
                options.minutes * 60.0,
                options={"physics": "training"},
            )
            score = float(found["signed_order"].mean())
            rows.append({"generation": generation, **gains, "signed_order": score})
            reported.append((place, -score))
        cma.tell(reported)
    rows.append({"generation": -1, **law(np.log(middle) + widths * cma.mean)})
    return pd.DataFrame(rows).assign(search=seed)


def tuned(pool: str, leaders: int, options: argparse.Namespace) -> dict[str, float]:
    """Return the means of what the searches found, written with every candidate, or read again."""
    seeds = range(options.seed, options.seed + options.searches)
    path = options.out / f"damped-law-{pool}-{leaders}.csv"
    if not len(tables := resumed(path)):
        write_table(path, pd.concat(search(pool, leaders, s, options) for s in seeds), "%.17g")
        tables = resumed(path)
    ends = tables.loc[tables["generation"] == -1, list(RANGES)]
    return law(np.log(ends).mean().to_numpy())


def judged(
    pool: str, leaders: int, gains: dict[str, float], flocks: int, duration_s: float = 480.0
) -> dict[str, float]:
    """Return the score of these gains in fresh flocks, in which the tuned law leads as well.

    What they add to it is called `beyond`: the law itself has a `gain`.
    """
    seeds = release_seeds("tune_laws", flocks)
    parameters = flock_parameters(pool, leaders)
    laws = {"searched": DampedLaw(**gains), "tuned law": DampedLaw.tuned(pool)}
    orders = {
        name: run_episodes(parameters, each, seeds, duration_s)["signed_order"]
        for name, each in laws.items()
    }
    score = score_policies(orders, "tuned law").loc[0].drop(["policy", "flocks"])
    return score.rename(lambda name: name.replace("gain", "beyond")).to_dict()


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pool", choices=POOLS, action="append", help="[both]")
    parser.add_argument("--leaders", type=int, action="append", help="[1 to 4]")
    parser.add_argument("--generations", type=int, default=34)
    parser.add_argument("--episodes", type=int, default=32, help="for each candidate")
    parser.add_argument("--minutes", type=float, default=8.0, help="length of an episode")
    parser.add_argument("--searches", type=int, default=2, help="for each pool and number")
    parser.add_argument("--seed", type=int, default=0, help="of the first search")
    parser.add_argument("--flocks", type=int, default=2048, help="that judge the gains found")
    parser.add_argument("--out", type=Path, default=Path("results/tune_laws"))
    parser.add_argument("--quiet", action="store_true")
    options = parser.parse_args(arguments)
    if min(options.generations, options.episodes, options.searches, options.flocks) < 1:
        parser.error("generations, episodes, searches and flocks are at least 1")
    given = sys.argv[1:] if arguments is None else arguments
    command = shlex.join(["python", "-m", "studies.tuned_laws.tune_laws", *given])
    start = time.process_time()
    options.out.mkdir(parents=True, exist_ok=True)
    cells = [(p, k) for p in options.pool or POOLS for k in options.leaders or (1, 2, 3, 4)]
    rows = []
    with Progress(disable=options.quiet) as progress:
        for pool, leaders in progress.track(cells):
            gains = tuned(pool, leaders, options)
            scores = judged(pool, leaders, gains, options.flocks)
            rows.append({"pool": pool, "leaders": leaders, **gains, **scores})
            write_table(options.out / "gains.csv", pd.DataFrame(rows).round(4), "%.6g")
    cpu_s = time.process_time() - start
    provenance = provenance_of(command, seed=options.seed, samples=0, cpu_s=cpu_s)
    (options.out / "gains.toml").write_text(tomli_w.dumps(provenance), encoding="utf-8")
    print(pd.DataFrame(rows).round(3).to_string(index=False))
    print(f"written to {options.out}")


if __name__ == "__main__":
    run(main)
