"""The Pareto front of the fit as it is measured: trials again, on other seeds, in repetitions.

    python baselines/measured_front.py    # into results/measured_front
    python baselines/measured_front.py --out docs/experiment_fit/measured    # for the docs

A trial of the fit runs once in each way, and its front is one of means that Gaussian processes
expect. Here trials are chosen by their single runs: those that have both critical backward
durations in range, and in each pool those of the least misfits. They run four times in each of the
ways of finalists. Those on the front of the measured misfits run 24 times, on the held-out seeds
that judged the presets. ``first.csv`` and ``again.csv`` have both measurements, with 95 % intervals
of a bootstrap over repetitions; an interrupted command resumes. `make tables` shows them in
docs/experiment_fit.md.
"""

import argparse
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pandas as pd
from missing_physics import resampled
from rich.progress import Progress

from flockenv import FlockParameters
from flockenv._io.atomic_write import write_csv
from flockenv.calibration.constants import CONSTANTS
from flockenv.calibration.flock_runs import JUDGED, FlockRuns, single_boat
from flockenv.calibration.held_out import stored_runs
from flockenv.calibration.search import DT_S
from flockenv.calibration.surrogate import front_ranks
from flockenv.calibration.targets import (
    GROUPS,
    MISFITS,
    SEARCHED_TARGETS,
    TARGETS,
    misfits,
)
from flockenv.runs.executors import cores
from flockenv.runs.seeds import MODEL_SEEDS
from flockenv.statistics.intervals import interval

TRIALS = Path("docs") / "experiment_fit" / "targets.csv"
RESULTS = Path("results") / "measured_front"
PRESET = "experiment-2026"
BOTH = ("critical_bw_0", "critical_bw_3")
LEAST_TOTAL, LEAST_OF_GROUP = 20, 10
FIRST_SEED = 20_000
"""Where the first measurement's seeds start, beyond those of trials and finalists."""


def chosen(trials: pd.DataFrame) -> pd.DataFrame:
    """Return the trials to measure, in their order."""
    searched = {target.key: trials[target.key] for target in SEARCHED_TARGETS}
    costs = misfits(searched, SEARCHED_TARGETS)
    keep = np.logical_and.reduce(
        [
            trials[target.key].between(target.low, target.high)
            for target in SEARCHED_TARGETS
            if target.key in BOTH
        ]
    )
    for pool in trials["pool"].unique():
        own = np.flatnonzero(trials["pool"] == pool)
        keep[own[np.argsort(costs[own].sum(axis=1), kind="stable")[:LEAST_TOTAL]]] = True
        for group in range(len(GROUPS)):
            keep[own[np.argsort(costs[own, group], kind="stable")[:LEAST_OF_GROUP]]] = True
    return trials[keep]


def parameters_of(trial: pd.Series) -> FlockParameters:
    """Return the parameters of a trial, with the substeps of trials."""
    constants = {name: float(trial[name]) for name in CONSTANTS}
    stepping = {"dt_s": DT_S, "relinearizations": 1}
    base = FlockParameters.preset(PRESET)
    return base.replace(**constants, **stepping, pool=str(trial["pool"]))


def row_of(trial: pd.Series, runs: FlockRuns) -> dict[str, object]:
    """Return constants, targets and misfits of measured runs, with the ends of their intervals."""
    values = resampled(single_boat(parameters_of(trial)), runs)
    found = {target.key: values[target.key].to_numpy() for target in TARGETS}
    found |= dict(zip(MISFITS, misfits(found).T, strict=True))
    # Where the trial is in its file, from 0: proposals of the processes have no draw.
    row: dict[str, object] = {"trial": trial.name, "pool": trial["pool"]}
    row |= {name: trial[name] for name in CONSTANTS}
    row["repetitions"] = runs.repetitions
    for name, each in found.items():
        row |= dict(zip((name, f"{name}_low", f"{name}_high"), interval(each), strict=True))
    row["met"] = sum(target.is_in_range(found[target.key][0]) for target in TARGETS)
    return row


def measured(
    trials: Iterable[pd.Series], seeds: list[int], jobs: int, folder: Path, words: str
) -> pd.DataFrame:
    """Run trials on the same seeds and return their rows, with those on the front marked."""
    trials = list(trials)
    rows = []
    with Progress() as progress:
        task = progress.add_task(words, total=len(trials))
        for trial in trials:
            parameters = parameters_of(trial)
            runs = stored_runs(parameters, seeds, jobs, folder, words, lambda *_: None)
            rows.append(row_of(trial, runs))
            progress.advance(task)
    table = pd.DataFrame(rows)
    table["front"] = front_ranks(table[list(MISFITS)].to_numpy(), 1) == 0
    return table


def main() -> None:
    """Measure the chosen trials, then those on the front, and write both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trials", type=Path, default=TRIALS, help=f"({TRIALS})")
    parser.add_argument("--repetitions", type=int, default=4, help="of the first measurement (4)")
    parser.add_argument("--held-out", type=int, default=24, help="of those on its front (24)")
    parser.add_argument("--jobs", type=int, default=cores(), help="runs at a time (every core)")
    parser.add_argument("--runs", type=Path, default=RESULTS / "runs", help="where runs are stored")
    parser.add_argument("--out", type=Path, default=RESULTS, help=f"({RESULTS})")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    given.runs.parent.mkdir(parents=True, exist_ok=True)
    trials = chosen(pd.read_csv(given.trials))
    width = len(JUDGED.cells)
    print(
        f"{len(trials)} trials, {len(trials) * given.repetitions * JUDGED.flock_hours:.0f} "
        f"flock-hours, then {given.held_out * JUDGED.flock_hours:.0f} for each on the front"
    )
    seeds = MODEL_SEEDS["calibration"].seeds(given.repetitions * width, start=FIRST_SEED)
    every = [trial for _, trial in trials.iterrows()]
    first = measured(every, seeds, given.jobs, given.runs, "first")
    write_csv(given.out / "first.csv", first, float_format="%.5g")
    seeds = MODEL_SEEDS["calibration check"].seeds(given.held_out * width)
    front = [trial for trial, is_front in zip(every, first["front"], strict=True) if is_front]
    again = measured(front, seeds, given.jobs, given.runs, "again")
    write_csv(given.out / "again.csv", again, float_format="%.5g")
    print(f"{len(again)} on the front; written to {given.out}")


if __name__ == "__main__":
    main()
