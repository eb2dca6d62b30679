"""Runs of the design `JUDGED`: stored, on held-out seeds, and what they say of the targets."""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.table import Table

from flockenv._io.atomic_write import atomic_write
from flockenv._io.extras import require
from flockenv.calibration.flock_runs import JUDGED, QUANTITIES, FlockRuns, run_flocks, single_boat
from flockenv.calibration.targets import MISFITS, TARGETS, measure, misfits
from flockenv.errors import ParameterError
from flockenv.parameters import FlockParameters
from flockenv.runs.seeds import MODEL_SEEDS
from flockenv.statistics.intervals import percentile_ends

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "START",
    "FitReport",
    "Progress",
    "check",
    "check_hours",
    "compared",
    "held_out_runs",
    "judged_stepping",
    "residuals",
    "stored_runs",
]

JUDGED_DT_S = 0.02
"""Substep of the runs on held-out seeds, without relinearizations: that of the presets."""

_RESAMPLES = 200

START = "start"
"""Name of the parameters that the fit started from, among those on held-out seeds."""

_SHOWN = ("target", "source", "paper", "fitted", "95 %", "in range")

Progress = Callable[[str, float], None]


@dataclass(frozen=True, slots=True)
class FitReport:
    """The result of a fit.

    Attributes
    ----------
    parameters : FlockParameters
        The best finalist's: the most targets in range on held-out seeds, then the least misfit.
    residuals : pandas.DataFrame
        Its targets on held-out seeds, a row each; see `residuals`.
    """

    parameters: FlockParameters
    residuals: "pd.DataFrame"

    def table(self) -> Table:
        """Return the residuals as a table for the terminal."""
        table = Table(*_SHOWN, title_justify="left")
        for row in self.residuals.to_dict("records"):
            table.add_row(
                row["target"],
                row["source"],
                f"{row['target_low']:.3g} to {row['target_high']:.3g}",
                f"{row['value']:.3g}",
                f"{row['value_low']:.3g} to {row['value_high']:.3g}",
                "yes" if row["in_range"] else "[bold]no[/]",
            )
        return table


def judged_stepping(parameters: FlockParameters) -> FlockParameters:
    """Return parameters with the substeps of runs on held-out seeds."""
    return parameters.replace(dt_s=JUDGED_DT_S, relinearizations=0)


def held_out_runs(
    parameters: FlockParameters, held_out: int, jobs: int, folder: Path | None, progress: Progress
) -> FlockRuns:
    """Run each cell on so many held-out seeds, or read the runs from the folder."""
    seeds = MODEL_SEEDS["calibration check"].seeds(held_out * len(JUDGED.cells))
    return stored_runs(parameters, seeds, jobs, folder, "held-out seeds", progress)


def compared(sets: Mapping[str, FlockParameters], runs: Mapping[str, FlockRuns]) -> "pd.DataFrame":
    """Compare sets of parameters with the fit's start, on the same seeds.

    Columns: ``name``, ``pool``, how many targets are in range, the misfit of each group and their
    sum ``total``, and ``difference``, the sum less that of the start, with the ends of its 95 %
    interval by a bootstrap over repetitions, which are drawn for both together.
    """
    pandas = require("pandas", "fit")
    rng = np.random.default_rng(0)
    count = runs[START].repetitions
    draws = [np.arange(count), *rng.integers(count, size=(_RESAMPLES, count))]
    boats = {name: single_boat(each) for name, each in sets.items()}
    totals = {
        name: np.array([misfits(measure(boats[name], each.resampled(d))).sum() for d in draws])
        for name, each in runs.items()
    }
    rows = []
    for name, each in runs.items():
        values = measure(boats[name], each)
        differences = totals[name] - totals[START]
        low, high = percentile_ends(differences[1:])
        rows.append(
            {
                "name": name,
                "pool": sets[name].pool,
                "met": sum(target.is_in_range(values[target.key]) for target in TARGETS),
                **dict(zip(MISFITS, misfits(values).tolist(), strict=True)),
                "total": totals[name][0],
                "difference": differences[0],
                "difference_low": low,
                "difference_high": high,
            }
        )
    frame: pd.DataFrame = pandas.DataFrame(rows)
    return frame


def check_hours(held_out: int) -> float:
    """Return the simulated time of `check` in hours."""
    return held_out * JUDGED.flock_hours


def check(parameters: FlockParameters, held_out: int, jobs: int, progress: Progress) -> FitReport:
    """Measure every target of a flock on held-out seeds, without a fit.

    Raises
    ------
    MissingExtraError
        Without pandas and SciPy, of the extra ``fit``; nothing is run then.
    """
    for package in ("pandas", "scipy"):
        require(package, "fit")
    parameters = judged_stepping(parameters)
    runs = held_out_runs(parameters, held_out, jobs, None, progress)
    return FitReport(parameters, residuals(parameters, runs))


def stored_runs(
    parameters: FlockParameters,
    seeds: Sequence[int],
    jobs: int,
    folder: Path | None,
    words: str,
    progress: Progress,
) -> FlockRuns:
    """Run the design `JUDGED`, or read it from the folder if it has been run."""
    shape = (len(JUDGED.cells), len(JUDGED.seeds(seeds)), len(QUANTITIES))
    hours = JUDGED.flock_hours * shape[1]
    of = f"{parameters.to_toml()}{seeds} {JUDGED} {QUANTITIES}"
    path = folder and folder / f"{hashlib.sha256(of.encode()).hexdigest()[:16]}.npy"
    if path and path.exists():
        values = np.load(path, allow_pickle=False)
        if values.shape != shape:
            raise ParameterError(f"{path} holds no runs of this fit: remove it")
        progress(words, hours)
        return FlockRuns(JUDGED, values)
    a_run = hours / (shape[0] * shape[1])
    runs = run_flocks(parameters, JUDGED, seeds, jobs, lambda: progress(words, a_run))
    if path:
        path.parent.mkdir(exist_ok=True)
        with atomic_write(path) as file:
            np.save(file, runs.values, allow_pickle=False)
    return runs


def residuals(parameters: FlockParameters, runs: FlockRuns) -> "pd.DataFrame":
    """Return each target with its range, its value and interval, and whether it is in range.

    Intervals are percentiles of a bootstrap over repetitions, at 95 %. A target is in range if its
    value lies in its range, whatever its interval.
    """
    pandas = require("pandas", "fit")
    boat = single_boat(parameters)
    values = measure(boat, runs)
    rng = np.random.default_rng(0)
    drawn = [
        measure(boat, runs.resampled(rng.integers(runs.repetitions, size=runs.repetitions)))
        for _ in range(_RESAMPLES)
    ]
    rows = []
    for target in TARGETS:
        sample = np.array([each[target.key] for each in drawn])
        defined = sample[np.isfinite(sample)]
        low, high = percentile_ends(defined) if len(defined) else (np.nan, np.nan)
        value = values[target.key]
        rows.append(
            {
                "key": target.key,
                "target": target.name,
                "source": target.source,
                "target_low": target.low,
                "target_high": target.high,
                "value": value,
                "value_low": low,
                "value_high": high,
                "in_range": target.is_in_range(value),
                "statement": target.statement,
            }
        )
    frame: pd.DataFrame = pandas.DataFrame(rows)
    return frame
