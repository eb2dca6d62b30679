"""The report of `flockenv fit`: search, finals, residuals on held-out seeds, files."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import tomli_w
from rich.table import Table

from flockenv import _core
from flockenv._io.atomic_write import whole_file
from flockenv._io.extras import require
from flockenv.calibration.search import HELD_OUT, Fit, Trial, residuals, run_flocks
from flockenv.calibration.targets import FACTS, NOISE_S
from flockenv.parameters import FlockParameters

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["FitReport", "check", "report", "work"]

VERIFIED_DT_S = 0.02
"""Substep of the runs on held-out seeds."""

_FACTS_SHOWN = ("fact", "source", "asked", "reached", "95 %", "met", "best seen")


@dataclass(frozen=True, slots=True)
class FitReport:
    """What a fit reached.

    Attributes
    ----------
    scene : FlockParameters
        The fitted parameters.
    residuals : pandas.DataFrame
        One row a fact, of held-out seeds; see `calibration.search.residuals`. ``best_seen``
        is what the trial that came nearest to the fact reached on its own few seeds, whatever it
        missed otherwise: more than can be had together.
    """

    scene: FlockParameters
    residuals: "pd.DataFrame"

    def table(self) -> Table:
        """Return the residuals as a table for the terminal."""
        table = Table(*_FACTS_SHOWN, title_justify="left")
        for row in self.residuals.to_dict("records"):
            low, high = row["value_low"], row["value_high"]
            best = row.get("best_seen")
            table.add_row(
                row["fact"],
                row["source"],
                f"{row['target_low']:.3g} to {row['target_high']:.3g}",
                f"{row['value']:.3g}",
                f"{low:.3g} to {high:.3g}",
                "yes" if row["met"] else "[bold]no[/]",
                "" if best is None else f"{best:.3g}",
            )
        return table


def work(fit: Fit, held_out: int) -> int:
    """Return the number of steps that `report` reports: trials and finalists."""
    return fit.trials + fit.finalists + 1 + held_out


def report(
    fit: Fit, held_out: int, folder: Path, progress: Callable[[str, float], None]
) -> FitReport:
    """Fit, measure what was chosen on held-out seeds, and write the files.

    Writes ``fit.toml`` (what was asked), ``trials.csv`` (while it goes on; an interrupted fit goes
    on from it), ``parameters.toml`` (the fitted scene) and ``residuals.csv``.

    Parameters
    ----------
    fit
        What to search.
    held_out
        Seeds, from `HELD_OUT` on.
    folder
        Where to write.
    progress
        Called with what was done, in words, and how many steps of `work` that is.

    Raises
    ------
    ParameterError
        If the folder holds another fit's log.
    MissingExtraError
        Without the extra ``fit``; nothing is written then.
    """
    # All of them before hours of trials.
    for package in ("cmaes", "pandas"):
        require(package, "fit")
    asked = asdict(fit) | {"scene": fit.scene.to_dict(), "held_out": held_out}
    header = f"# flockenv {_core.__version__}\n"
    _write(folder / "fit.toml", header + tomli_w.dumps(asked))
    trials = []
    best = float("inf")
    for trial in fit.search(folder / "trials.csv"):
        trials.append(trial)
        best = min(best, trial.loss)
        progress(f"trial {len(trials)}, least loss {best:.2f}", 1)
    finals = fit.finals(trials, lambda: progress("finalists", 1))
    scene = fit.scene.replace(**_rounded(finals[0])).replace(dt_s=VERIFIED_DT_S)
    seeds = range(HELD_OUT, HELD_OUT + held_out)
    table = _residuals(scene, seeds, fit.jobs, progress)
    table["best_seen"] = _best_seen(fit, trials)
    _write(folder / "parameters.toml", header + scene.to_toml())
    _write(folder / "residuals.csv", table.round(4).to_csv(index=False))
    return FitReport(scene, table)


def check(
    scene: FlockParameters, held_out: int, jobs: int, progress: Callable[[str, float], None]
) -> FitReport:
    """Measure every fact of a scene on held-out seeds, without a fit: `held_out` steps of work.

    Raises
    ------
    MissingExtraError
        Without pandas, of the extra ``fit``; nothing is run then.
    """
    require("pandas", "fit")
    seeds = range(HELD_OUT, HELD_OUT + held_out)
    return FitReport(scene, _residuals(scene, seeds, jobs, progress))


def _residuals(
    scene: FlockParameters,
    seeds: Sequence[int],
    jobs: int,
    progress: Callable[[str, float], None],
) -> "pd.DataFrame":
    a_run = 1 / sum(map(len, NOISE_S.values()))
    runs = run_flocks(scene, seeds, NOISE_S, jobs, lambda: progress("held-out seeds", a_run))
    return residuals(scene, runs)


def _best_seen(fit: Fit, trials: Sequence[Trial]) -> list[float]:
    """For each fact the value of the trial that came nearest to it, whatever else that missed."""
    with_flocks = [trial for trial in trials if trial.loss < fit.HOPELESS]
    if not with_flocks:
        return [float("nan")] * len(FACTS)
    return [min((trial.values[fact.key] for trial in with_flocks), key=fact.miss) for fact in FACTS]


def _rounded(trial: Trial) -> dict[str, float]:
    """Three digits: more are not determined, and these can be read."""
    return {name: float(f"{value:.3g}") for name, value in trial.constants.items()}


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as file:
        file.write(text.encode())
