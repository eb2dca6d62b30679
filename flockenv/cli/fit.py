"""`flockenv fit`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from flockenv.calibration.constants import CONSTANTS, POOLS
from flockenv.cli.console import console, interruptible, print_json, progress_bar, say
from flockenv.cli.output import check_folder
from flockenv.parameters import FlockParameters

__all__ = ["fit"]

_FREE = f"Constants to free, by commas, of {', '.join(CONSTANTS)}."


def fit(
    free: Annotated[str, typer.Option(help=_FREE)] = ",".join(CONSTANTS),
    pools: Annotated[str, typer.Option(help="Readings of the pool, by commas.")] = ",".join(POOLS),
    flock_hours: Annotated[
        float, typer.Option(help="Simulated time of all trials together, in hours.")
    ] = 4000.0,
    filling_hours: Annotated[
        float, typer.Option(help="Simulated time of the trials that fill the space, in hours.")
    ] = 2048.0,
    batch: Annotated[int, typer.Option(help="Proposals per pool between two fits.")] = 64,
    repetitions: Annotated[int, typer.Option(help="Runs of a kind by each finalist.")] = 4,
    judged: Annotated[int, typer.Option(help="Finalists measured on held-out seeds.")] = 2,
    held_out: Annotated[int, typer.Option(min=2, help="Runs of a kind on held-out seeds.")] = 24,
    check: Annotated[
        str | None, typer.Option(help="Search nothing: measure every target of this preset.")
    ] = None,
    scheme: Annotated[str | None, typer.Option(help="Scheme of the runs.")] = None,
    noise: Annotated[str | None, typer.Option(help="Noise of the runs.")] = None,
    jobs: Annotated[int, typer.Option(help="Runs at a time.", min=1)] = 1,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the search.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for the log and the results.")] = Path(
        "results/fit"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print the residuals as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Fit the model's constants to the experiment (Table 1, Section 4) and report the residuals.

    The first trials fill the space of constants, and Gaussian processes over the targets propose
    the others, near the Pareto front between targets without leaders, with leaders, and of jamming.
    Finalists run again on other seeds, and the best of them on seeds that the search has not used.
    An interrupted fit resumes with the same command, and more flock-hours continue a finished one.

    Example: `flockenv fit --filling-hours 512 --flock-hours 1024 --jobs 2`
    """
    from flockenv.calibration import held_out as unsearched_seeds
    from flockenv.calibration import report as fit_report
    from flockenv.calibration.search import Fit

    given = {"scheme": scheme, "noise": noise}
    changes = {name: value for name, value in given.items() if value is not None}
    parameters = FlockParameters.preset(check or "experiment-2026").replace(**changes)
    effort = fit_report.Effort(repetitions, judged, held_out)
    if check is not None:
        hours = unsearched_seeds.check_hours(held_out)
        with interruptible("Nothing was written."), progress_bar(quiet or as_json) as progress:
            task = progress.add_task("held-out seeds", total=hours)
            result = unsearched_seeds.check(
                parameters, held_out, jobs, lambda words, steps: progress.advance(task, steps)
            )
    else:
        search = Fit(
            free=_words(free),
            pools=_words(pools),
            parameters=parameters,
            flock_hours=flock_hours,
            filling_hours=filling_hours,
            batch=batch,
            seed=seed,
            jobs=jobs,
        )
        check_folder(out)
        parts = effort.flock_hours(search)
        if not as_json:
            each = ", ".join(f"{name} {hours:.0f}" for name, hours in parts.items())
            say(f"{search.trials} trials; flock-hours: {each}")
        stored = f"Finished trials are stored in {out}: the same command resumes from them."
        with interruptible(stored), progress_bar(quiet or as_json) as progress:
            task = progress.add_task("trials", total=sum(parts.values()))
            result = fit_report.report(
                search,
                effort,
                out,
                lambda words, hours: progress.update(task, description=words, advance=hours),
            )
    if as_json:
        rows = json.loads(result.residuals.to_json(orient="records"))
        print_json({"parameters": result.parameters.to_dict(), "residuals": rows})
        return
    console.print(result.table())
    if check is None:
        constants = {name: getattr(result.parameters, name) for name in _words(free)}
        fitted = ", ".join(f"{name} = {value:g}" for name, value in constants.items())
        say(f"pool = {result.parameters.pool}, {fitted}")
        say(f"Written to {out}")


def _words(text: str) -> tuple[str, ...]:
    return tuple(word.strip() for word in text.split(",") if word.strip())
