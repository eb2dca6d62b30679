"""The report of `flockenv fit`: search, finals, residuals on held-out seeds, files."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import tomli_w
from rich.table import Table

from flockenv import _core
from flockenv._io.atomic_write import write_csv, write_text
from flockenv._io.extras import require
from flockenv._io.locks import held
from flockenv.calibration.search import Fit, Trial, residuals, run_flocks
from flockenv.calibration.targets import NOISE_S, TARGETS
from flockenv.parameters import FlockParameters
from flockenv.runs.seeds import MODEL_SEEDS

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["FitReport", "check", "report", "work"]

VERIFIED_DT_S = 0.02
"""Substep of the runs on held-out seeds."""

_SHOWN = ("target", "source", "paper", "fitted", "95 %", "in range", "best seen")


@dataclass(frozen=True, slots=True)
class FitReport:
    """The result of a fit.

    Attributes
    ----------
    parameters : FlockParameters
        The fitted parameters.
    residuals : pandas.DataFrame
        One row per target, of held-out seeds; see `calibration.search.residuals`. ``best_seen``
        is the value of the trial nearest to this one target, on that trial's own few seeds; no
        trial is that near to all targets together.
    """

    parameters: FlockParameters
    residuals: "pd.DataFrame"

    def table(self) -> Table:
        """Return the residuals as a table for the terminal."""
        table = Table(*_SHOWN, title_justify="left")
        for row in self.residuals.to_dict("records"):
            low, high = row["value_low"], row["value_high"]
            best = row.get("best_seen")
            table.add_row(
                row["target"],
                row["source"],
                f"{row['target_low']:.3g} to {row['target_high']:.3g}",
                f"{row['value']:.3g}",
                f"{low:.3g} to {high:.3g}",
                "yes" if row["in_range"] else "[bold]no[/]",
                "" if best is None else f"{best:.3g}",
            )
        return table


def work(fit: Fit, held_out: int) -> int:
    """Return the number of steps that `report` reports: trials and finalists."""
    return fit.trials + fit.finalists + 1 + held_out


def report(
    fit: Fit, held_out: int, folder: Path, progress: Callable[[str, float], None]
) -> FitReport:
    """Fit, measure the chosen constants on held-out seeds, and write the files.

    Writes ``fit.toml`` (the options), ``trials.csv`` (during the search; an interrupted fit resumes
    from it), ``parameters.toml`` (the fitted ones) and ``residuals.csv``.

    Parameters
    ----------
    fit
        The search.
    held_out
        Seeds, of the range ``"calibration check"`` of `flockenv.runs.seeds.MODEL_SEEDS`.
    folder
        Where to write.
    progress
        Called with the work that was done, in words, and its steps of `work`.

    Raises
    ------
    ParameterError
        If the folder holds another fit's log.
    MissingExtraError
        Without the extra ``fit``; nothing is written then.
    InUseError
        If another fit is at work in the folder.
    """
    # Both are required before hours of trials.
    for package in ("cmaes", "pandas"):
        require(package, "fit")
    folder.mkdir(parents=True, exist_ok=True)
    with held(folder / ".lock", str(folder)):
        return _reported(fit, held_out, folder, progress)


def _reported(
    fit: Fit, held_out: int, folder: Path, progress: Callable[[str, float], None]
) -> FitReport:
    options = asdict(fit) | {"parameters": fit.parameters.to_dict(), "held_out": held_out}
    header = f"# flockenv {_core.__version__}\n"
    write_text(folder / "fit.toml", header + tomli_w.dumps(options))
    trials = []
    best = float("inf")
    for trial in fit.search(folder / "trials.csv"):
        trials.append(trial)
        best = min(best, trial.loss)
        progress(f"trial {len(trials)}, least loss {best:.2f}", 1)
    finals = fit.finals(trials, lambda: progress("finalists", 1))
    parameters = fit.parameters.replace(**_rounded(finals[0])).replace(dt_s=VERIFIED_DT_S)
    seeds = MODEL_SEEDS["calibration check"].seeds(held_out)
    table = _residuals(parameters, seeds, fit.jobs, progress)
    table["best_seen"] = _best_seen(fit, trials)
    write_text(folder / "parameters.toml", header + parameters.to_toml())
    write_csv(folder / "residuals.csv", table.round(4))
    return FitReport(parameters, table)


def check(
    parameters: FlockParameters, held_out: int, jobs: int, progress: Callable[[str, float], None]
) -> FitReport:
    """Measure every target of a flock on held-out seeds, without a fit: `held_out` steps of work.

    Raises
    ------
    MissingExtraError
        Without pandas, of the extra ``fit``; nothing is run then.
    """
    require("pandas", "fit")
    seeds = MODEL_SEEDS["calibration check"].seeds(held_out)
    return FitReport(parameters, _residuals(parameters, seeds, jobs, progress))


def _residuals(
    parameters: FlockParameters,
    seeds: Sequence[int],
    jobs: int,
    progress: Callable[[str, float], None],
) -> "pd.DataFrame":
    a_run = 1 / sum(map(len, NOISE_S.values()))
    runs = run_flocks(parameters, seeds, NOISE_S, jobs, lambda: progress("held-out seeds", a_run))
    return residuals(parameters, runs)


def _best_seen(fit: Fit, trials: Sequence[Trial]) -> list[float]:
    """Return for each target the value of the trial nearest to it."""
    with_flocks = [trial for trial in trials if trial.loss < fit.HOPELESS]
    if not with_flocks:
        return [float("nan")] * len(TARGETS)
    return [
        min((trial.values[target.key] for trial in with_flocks), key=target.residual)
        for target in TARGETS
    ]


def _rounded(trial: Trial) -> dict[str, float]:
    """Return the constants with three digits, because more are not determined."""
    return {name: float(f"{value:.3g}") for name, value in trial.constants.items()}
