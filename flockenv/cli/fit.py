"""`flockenv fit`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from flockenv.calibration.search import BOUNDS, MODEL_CONSTANTS
from flockenv.cli.console import console, interruptible, print_json, progress_bar, say
from flockenv.cli.output import check_folder
from flockenv.parameters import FlockParameters

__all__ = ["fit"]

_FREE = f"Constants to fit, by commas, of {', '.join(BOUNDS)}."


def fit(
    free: Annotated[str, typer.Option(help=_FREE)] = ",".join(MODEL_CONSTANTS),
    only: Annotated[
        str, typer.Option(help="Keys of the calibration targets, by commas. [all]")
    ] = "",
    trials: Annotated[int, typer.Option(help="Trials of the search.")] = 110,
    seeds: Annotated[int, typer.Option(help="Flock seeds in each trial.")] = 4,
    finalists: Annotated[int, typer.Option(help="Trials run again on more seeds.")] = 3,
    held_out: Annotated[int, typer.Option(min=2, help="Seeds of the residuals.")] = 24,
    check: Annotated[
        str | None, typer.Option(help="Search nothing: measure every target of this preset.")
    ] = None,
    scheme: Annotated[str | None, typer.Option(help="Scheme of the runs.")] = None,
    noise: Annotated[str | None, typer.Option(help="Noise of the runs.")] = None,
    dt_s: Annotated[float | None, typer.Option(help="Substep in s. [0.05 in a search]")] = None,
    jobs: Annotated[int, typer.Option(help="Runs at a time.", min=1)] = 1,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the search.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for the log and the results.")] = Path(
        "results/fit"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print the residuals as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Fit the model's constants to the experiment (Table 1, Section 4) and report the residuals.

    Searches with CMA-ES, runs the best trials again on other seeds, and measures every target with
    the best constants on seeds that the search has not used. Writes `trials.csv`, `parameters.toml`
    and `residuals.csv`. An interrupted fit resumes with the same command.

    Example: `flockenv fit --trials 60 --jobs 2`
    """
    from flockenv.calibration import report as fit_report
    from flockenv.calibration.search import Fit, experiment_parameters

    given = {"scheme": scheme, "noise": noise, "dt_s": dt_s}
    changes = {name: value for name, value in given.items() if value is not None}
    if check is not None:
        parameters = FlockParameters.preset(check).replace(**changes)
        with interruptible("Nothing was written."), progress_bar(quiet or as_json) as progress:
            task = progress.add_task("held-out seeds", total=held_out)
            result = fit_report.check(
                parameters, held_out, jobs, lambda words, steps: progress.advance(task, steps)
            )
    else:
        parameters = experiment_parameters().replace(**{"dt_s": 0.05, **changes})
        search = Fit(
            free=_words(free),
            only=_words(only),
            parameters=parameters,
            trials=trials,
            seeds=seeds,
            finalists=finalists,
            seed=seed,
            jobs=jobs,
        )
        check_folder(out)
        stored = f"Finished trials are stored in {out}: the same command resumes from them."
        with interruptible(stored), progress_bar(quiet or as_json) as progress:
            task = progress.add_task("trials", total=fit_report.work(search, held_out))
            result = fit_report.report(
                search,
                held_out,
                out,
                lambda words, steps: progress.update(task, description=words, advance=steps),
            )
    if as_json:
        rows = json.loads(result.residuals.to_json(orient="records"))
        print_json({"parameters": result.parameters.to_dict(), "residuals": rows})
        return
    console.print(result.table())
    if check is None:
        constants = {name: getattr(result.parameters, name) for name in _words(free)}
        fitted = ", ".join(f"{name} = {value:g}" for name, value in constants.items())
        say(fitted)
        say(f"Written to {out}")


def _words(text: str) -> tuple[str, ...]:
    return tuple(word.strip() for word in text.split(",") if word.strip())
