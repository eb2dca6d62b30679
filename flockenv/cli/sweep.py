"""`flockenv sweep`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from flockenv._io.atomic_write import atomic_write
from flockenv.cli.console import errors, print_json, progress_bar, resumable, say
from flockenv.cli.output import check_folder, writable
from flockenv.runs.executors import named

__all__ = ["sweep"]


def sweep(
    spec: Annotated[Path, typer.Argument(help="What to run: a TOML file.")],
    engine: Annotated[str, typer.Option(help="Where to run: local, joblib or ray.")] = "local",
    out: Annotated[
        Path | None, typer.Option(help="Folder for results. [results/sweep/NAME]")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the table as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Run a grid of parameters and seeds, as one table.

    Writes `sweep.csv` and `sweep.parquet`, one row per run, which `flockenv.runs.sweep.load_sweep`
    reads, and beside them the TOML file as `sweep.toml`.
    Finished runs are stored in `runs/`, and an interrupted sweep resumes with the same command.
    `docs/sweep.md` describes the TOML file.

    Example: `flockenv sweep docs/sweep-example.toml`
    """
    from flockenv.runs.sweep import run_sweep
    from flockenv.runs.sweep_spec import read_sweep

    where = named(engine)
    work = read_sweep(spec)
    folder = out or Path("results/sweep") / spec.stem
    check_folder(folder)
    given = spec.read_bytes()
    with writable(folder / "sweep.toml") as path, atomic_write(path) as file:
        file.write(given)
    with resumable(folder / "runs"), progress_bar(quiet or as_json) as progress:
        task = progress.add_task(f"{len(work.runs)} runs", total=sum(run.cost for run in work.runs))
        table = run_sweep(
            work,
            folder,
            where,
            lambda run: progress.advance(task, run.cost),
            lambda line: say(f"Warning: {line}", errors),
        )
    failed = int((table["failure"] != "").sum())
    if failed:
        errors.print(f"Warning: {failed} of {len(table)} runs failed; see the column failure")
    if as_json:
        print_json(json.loads(table.to_json(orient="records")))
        return
    say(f"{len(table)} runs, written to {folder}")
