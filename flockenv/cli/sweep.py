"""`flockenv sweep`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from flockenv._io.atomic_write import atomic_write
from flockenv.cli.console import print_json, progress_bar, resumable, say
from flockenv.cli.output import check_folder, writable
from flockenv.cli.workload import (
    DryRun,
    EngineName,
    ShardOf,
    Workers,
    chosen_shard,
    end_if_failed,
    make_shard,
    show_workload,
    warn,
)
from flockenv.runs.executors import named
from flockenv.runs.store import RUNS_FOLDER

__all__ = ["sweep"]


def sweep(
    spec: Annotated[Path, typer.Argument(help="What to run: a TOML file.")],
    engine: EngineName = "local",
    workers: Workers = None,
    shard: ShardOf = None,
    dry_run: DryRun = False,
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
    Several machines that share a folder make one shard each, with `--shard 1/8` to `--shard 8/8`;
    the command without `--shard` then writes the table.
    `docs/sweep.md` describes the TOML file. Runs that fail cost no others: their rows say why, and
    the command ends with exit code 1.

    Example: `flockenv sweep docs/sweep-example.toml`
    """
    from flockenv.runs.sweep import run_sweep
    from flockenv.runs.sweep_spec import read_sweep

    where, part = named(engine), chosen_shard(shard)
    work = read_sweep(spec)
    folder = out or Path("results/sweep") / spec.stem
    if dry_run:
        show_workload(work.runs, folder / RUNS_FOLDER, part, as_json)
        return
    check_folder(folder)
    given = spec.read_bytes()
    with writable(folder / "sweep.toml") as path, atomic_write(path) as file:
        file.write(given)
    if part is not None:
        make_shard(work.runs, folder / RUNS_FOLDER, part, where, workers, quiet, as_json)
        return
    with resumable(folder / RUNS_FOLDER), progress_bar(quiet or as_json) as progress:
        task = progress.add_task(f"{len(work.runs)} runs", total=sum(run.cost for run in work.runs))
        table = run_sweep(
            work,
            folder,
            where,
            lambda run: progress.update(task, advance=run.cost),
            warn,
            workers,
        )
    if as_json:
        print_json(json.loads(table.to_json(orient="records")))
    else:
        say(f"{len(table)} runs, written to {folder}")
    end_if_failed(int((table["failure"] != "").sum()), len(table), "see the column failure")
