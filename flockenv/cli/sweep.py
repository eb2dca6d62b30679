"""`flockenv sweep`."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flockenv._io.atomic_write import atomic_write
from flockenv.cli.console import print_json, progress_bar, resumable, say
from flockenv.cli.options import Printing, takes
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
from flockenv.runs.executors import Engine, named
from flockenv.runs.store import RUNS_FOLDER

if TYPE_CHECKING:
    from flockenv.runs.sweep import SweepSpec

__all__ = ["sweep"]


@dataclass(frozen=True, kw_only=True)
class SweepOptions(Printing):
    """Options of `flockenv sweep`."""

    spec: Annotated[Path, typer.Argument(help="What to run: a TOML file.")]
    engine: EngineName = "local"
    workers: Workers = None
    shard: ShardOf = None
    dry_run: DryRun = False
    out: Annotated[Path | None, typer.Option(help="Folder for results. [results/sweep/NAME]")] = (
        None
    )


@takes(SweepOptions)
def sweep(options: SweepOptions) -> None:
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
    from flockenv.runs.sweep import read_sweep

    engine, part = named(options.engine), chosen_shard(options.shard)
    work = read_sweep(options.spec)
    folder = options.out or Path("results/sweep") / options.spec.stem
    runs = folder / RUNS_FOLDER
    if options.dry_run:
        show_workload(work.runs, runs, part, options.as_json)
        return
    check_folder(folder)
    given = options.spec.read_bytes()
    with writable(folder / "sweep.toml") as path, atomic_write(path) as file:
        file.write(given)
    if part is not None:
        make_shard(work.runs, runs, part, engine, options.workers, options.quiet, options.as_json)
        return
    _whole(options, work, folder, engine)


def _whole(options: SweepOptions, work: "SweepSpec", folder: Path, engine: Engine) -> None:
    """Make all runs that are missing, and the table."""
    from flockenv.runs.sweep import run_sweep

    runs = work.runs
    with resumable(folder / RUNS_FOLDER), progress_bar(options.shows_nothing) as progress:
        task = progress.add_task(f"{len(runs)} runs", total=sum(run.cost for run in runs))
        table = run_sweep(
            work,
            folder,
            engine,
            lambda run: progress.update(task, advance=run.cost),
            warn,
            options.workers,
        )
    if options.as_json:
        print_json(json.loads(table.to_json(orient="records")))
    else:
        say(f"{len(table)} runs, written to {folder}")
    end_if_failed(int((table["failure"] != "").sum()), len(table), "see the column failure")
