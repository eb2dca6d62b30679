"""The report of `flockenv fit`: search, front, finalists, residuals on held-out seeds, files."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import tomli_w

from flockenv import _core
from flockenv._io.atomic_write import atomic_write, write_csv, write_text
from flockenv._io.extras import require
from flockenv._io.locks import held
from flockenv.calibration.figure import save_front
from flockenv.calibration.flock_runs import (
    JUDGED,
    SEARCHED,
    single_boat,
)
from flockenv.calibration.held_out import (
    START,
    FitReport,
    Progress,
    check_hours,
    compared,
    held_out_runs,
    judged_stepping,
    residuals,
    stored_runs,
)
from flockenv.calibration.search import Fit, Trial
from flockenv.calibration.targets import GROUPS, MISFITS, TARGETS, measure, misfits
from flockenv.calibration.tradeoffs import (
    Landscape,
    finalists,
    front_table,
    landscape,
    pair_table,
)
from flockenv.errors import ParameterError
from flockenv.parameters import FlockParameters
from flockenv.runs.seeds import MODEL_SEEDS
from flockenv.runs.store import RESULTS_VERSION

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Effort", "report"]

_FIRST_FINAL = 10_000
"""Where the finalists' seeds start in the range "calibration", beyond those of trials."""


@dataclass(frozen=True, slots=True)
class Effort:
    """What follows the search.

    Attributes
    ----------
    repetitions : int
        Runs of each cell of `JUDGED` by a finalist.
    judged : int
        Finalists that are measured on held-out seeds.
    held_out : int
        Runs of each cell on held-out seeds, by each of them and by the parameters that the fit
        started from.
    """

    repetitions: int = 4
    judged: int = 2
    held_out: int = 24

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if value < 1:
                raise ParameterError(f"{name} = {value} is not accepted: at least 1")

    def flock_hours(self, fit: Fit) -> dict[str, float]:
        """Return the largest simulated time of each part of a fit, in hours."""
        finals = len(fit.pools) * (4 + len(GROUPS)) * self.repetitions
        return {
            "search": fit.trials * SEARCHED.flock_hours,
            "finalists": finals * JUDGED.flock_hours,
            "held-out seeds": (self.judged + 1) * check_hours(self.held_out),
        }


def report(fit: Fit, effort: Effort, folder: Path, progress: Progress) -> FitReport:
    """Fit, run the finalists again, measure the best on held-out seeds, and write the files.

    Writes ``fit.toml`` (the options), ``trials.csv`` (what the runs of each trial measured),
    ``targets.csv`` (each trial's targets and misfits), ``front.csv`` and ``front.png`` (the Pareto
    front), ``pairs.csv`` (targets in pairs), ``finalists.csv``, ``judged.csv`` (targets of the best
    finalists and of the parameters that the fit started from, on held-out seeds),
    ``comparison.csv`` (their misfits), ``residuals.csv`` and ``parameters.toml`` (the best one's).
    ``runs`` stores what the finalists' runs measured. A killed fit resumes with the same options
    and makes the same files.

    Parameters
    ----------
    fit, effort
        The search, and what follows it. Held-out seeds are of the range ``"calibration check"`` of
        `flockenv.runs.seeds.MODEL_SEEDS`.
    folder
        Where to write.
    progress
        Called with the work that is done, in words, and the flock-hours since the last call.

    Raises
    ------
    ParameterError
        If the folder holds another fit's options or log.
    MissingExtraError
        Without the extra ``fit``; nothing is written then.
    InUseError
        If another fit is at work in the folder.
    """
    # All are required before hours of trials.
    for package in ("matplotlib", "pandas", "scipy", "sklearn"):
        require(package, "fit")
    folder.mkdir(parents=True, exist_ok=True)
    with held(folder / ".lock", str(folder)):
        return _reported(fit, effort, folder, progress)


def _reported(fit: Fit, effort: Effort, folder: Path, progress: Progress) -> FitReport:
    _store_options(fit, effort, folder / "fit.toml")
    trials = []
    for trial in fit.search(folder / "trials.csv"):
        trials.append(trial)
        progress(f"trial {len(trials)}", SEARCHED.flock_hours)
    write_csv(folder / "targets.csv", _target_table(fit, trials))
    views = [landscape(fit, trials, pool) for pool in fit.pools]
    front = front_table(fit, views)
    write_csv(folder / "front.csv", front.round(4))
    write_csv(folder / "pairs.csv", pair_table(views).round(4))
    finals = _finals(fit, effort, views, folder / "runs", progress)
    write_csv(folder / "finalists.csv", finals.round(4))
    with atomic_write(folder / "front.png") as file:
        save_front(file, views, finals)
    sets = _best(fit, effort, finals)
    runs = {
        name: held_out_runs(each, effort.held_out, fit.jobs, folder / "runs", progress)
        for name, each in sets.items()
    }
    tables = {name: residuals(each, runs[name]) for name, each in sets.items()}
    judged = require("pandas", "fit").concat(
        [table.assign(name=name) for name, table in tables.items()], ignore_index=True
    )
    write_csv(folder / "judged.csv", judged.round(4))
    comparison = compared(sets, runs)
    write_csv(folder / "comparison.csv", comparison.round(4))
    finalists_alone = comparison[comparison["name"] != START]
    best = finalists_alone.sort_values(["met", "total"], ascending=[False, True])["name"].iloc[0]
    parameters = sets[best]
    header = f"# flockenv {_core.__version__}\n"
    write_text(folder / "parameters.toml", header + parameters.to_toml())
    write_csv(folder / "residuals.csv", tables[best].round(4))
    return FitReport(parameters, tables[best])


def _store_options(fit: Fit, effort: Effort, path: Path) -> None:
    options = asdict(fit) | {"parameters": fit.parameters.to_dict()} | asdict(effort)
    # How many runs are made at a time changes nothing, and more trials continue those there are.
    del options["jobs"], options["flock_hours"]
    versions = f"# flockenv {_core.__version__}, results version {RESULTS_VERSION}\n"
    text = versions + tomli_w.dumps(options)
    if path.exists() and path.read_text(encoding="utf-8") != text:
        raise ParameterError(
            f"{path} has other options or another version: repeat those, or name another --out"
        )
    write_text(path, text)


def _target_table(fit: Fit, trials: Sequence[Trial]) -> "pd.DataFrame":
    pandas = require("pandas", "fit")
    rows = []
    for trial in trials:
        values = trial.values
        numbers = {name: float(f"{value:.4g}") for name, value in values.items()}
        constants = fit.constants_at(trial.places)
        rows.append({"draw": trial.draw, "pool": trial.pool, **constants, **numbers})
    frame: pd.DataFrame = pandas.DataFrame(rows)
    return frame


def _finals(
    fit: Fit, effort: Effort, views: Sequence[Landscape], folder: Path, progress: Progress
) -> "pd.DataFrame":
    """Run the finalists of each pool again, on other seeds than the trials.

    Columns: ``pool``, ``reason``, the places and constants, the targets, their misfits by group and
    how many are in range.
    """
    pandas = require("pandas", "fit")
    count = effort.repetitions * len(JUDGED.cells)
    seeds = MODEL_SEEDS["calibration"].seeds(count, start=_FIRST_FINAL)
    rows = []
    for view in views:
        for reason, places in finalists(fit, view):
            parameters = fit.parameters_at(places).replace(pool=view.pool)
            runs = stored_runs(parameters, seeds, fit.jobs, folder, "finalists", progress)
            values = measure(single_boat(parameters), runs)
            rows.append(
                {
                    "pool": view.pool,
                    "reason": reason,
                    **{f"at_{name}": at for name, at in zip(fit.free, places, strict=True)},
                    **fit.constants_at(places),
                    **values,
                    **dict(zip(MISFITS, misfits(values).tolist(), strict=True)),
                    "met": sum(target.is_in_range(values[target.key]) for target in TARGETS),
                }
            )
    frame: pd.DataFrame = pandas.DataFrame(rows)
    return frame


def _final_parameters(fit: Fit, finals: "pd.DataFrame", place: int) -> FlockParameters:
    row = finals.iloc[place]
    places = [float(row[f"at_{name}"]) for name in fit.free]
    return fit.parameters_at(places).replace(pool=str(row["pool"]))


def _best(fit: Fit, effort: Effort, finals: "pd.DataFrame") -> dict[str, FlockParameters]:
    """Return the parameters to measure on held-out seeds by name: the fit's start is the last."""
    ranked = finals.assign(total=finals[list(MISFITS)].sum(axis=1))
    ranked = ranked.sort_values(["met", "total"], ascending=[False, True]).head(effort.judged)
    sets = {f"finalist {place}": _final_parameters(fit, finals, place) for place in ranked.index}
    sets[START] = fit.parameters
    return {name: judged_stepping(each) for name, each in sets.items()}
