"""Options of the commands that make many runs: engine, workers, shards and dry runs."""

from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from flockenv.cli.console import errors, print_json, progress_bar, resumable, say
from flockenv.runs.executors import Engine
from flockenv.runs.spec import RunSpec
from flockenv.runs.store import RunStore, run_missing
from flockenv.runs.workload import Shard, measure_workload

__all__ = [
    "DryRun",
    "EngineName",
    "ShardOf",
    "Workers",
    "chosen_shard",
    "end_if_failed",
    "make_shard",
    "show_workload",
    "warn",
]

EngineName = Annotated[str, typer.Option("--engine", help="Where to run: local or ray.")]
Workers = Annotated[
    int | None, typer.Option(min=1, help="Runs at a time. [every core that this process may use]")
]
ShardOf = Annotated[
    str | None,
    typer.Option("--shard", metavar="I/N", help="Make the I-th of N shares of the runs, no more."),
]
DryRun = Annotated[
    bool, typer.Option("--dry-run", help="Print how many runs there are and what they take.")
]


def chosen_shard(text: str | None) -> Shard | None:
    """Return the shard that `--shard` names."""
    return None if text is None else Shard.parse(text)


def warn(line: str) -> None:
    """Print a warning."""
    say(f"Warning: {line}", errors)


def end_if_failed(failed: int, runs: int, where: str) -> None:
    """End the command with exit code 1 if some of its runs failed, and say how many and `where`."""
    if failed:
        say(f"{failed} of {runs} runs failed: {where}", errors)
        raise typer.Exit(1)


def show_workload(
    specs: Iterable[RunSpec], runs: Path, shard: Shard | None, as_json: bool = False
) -> None:
    """Print how many runs there are, how many of them are stored, and what the others take."""
    specs = list(dict.fromkeys(specs))
    work = measure_workload(specs if shard is None else shard.runs_of(specs), RunStore(runs))
    if as_json:
        print_json(asdict(work))
        return
    of_shard = "" if shard is None else f" of shard {shard} (of {len(specs)} in all)"
    say(f"{work.runs} runs{of_shard}, {work.stored} of them stored in {runs}")
    hours = "an unknown number of" if work.core_hours is None else f"{work.core_hours:.2g}"
    say(
        f"{work.runs - work.stored} to be made: {work.flock_hours:.4g} flock-hours, about "
        f"{hours} core-hours on this machine"
    )


def make_shard(
    specs: Iterable[RunSpec],
    runs: Path,
    shard: Shard,
    engine: Engine,
    workers: int | None,
    quiet: bool,
    as_json: bool,
) -> None:
    """Make a shard's runs, and say how the results of all shards are made."""
    mine = shard.runs_of(dict.fromkeys(specs))
    with resumable(runs), progress_bar(quiet or as_json) as progress:
        task = progress.add_task(f"{len(mine)} runs", total=sum(spec.cost for spec in mine))
        failures = run_missing(
            mine,
            RunStore(runs, warn),
            engine,
            lambda spec: progress.update(task, advance=spec.cost),
            workers,
        )
    for spec, error in failures.items():
        warn(f"the run of seed {spec.seed} failed: {error}")
    if as_json:
        print_json({"shard": str(shard), "runs": len(mine), "failed": len(failures)})
    else:
        say(f"Shard {shard}: {len(mine) - len(failures)} of {len(mine)} runs are stored in {runs}")
        say("When all shards have ended, the same command without --shard writes the results.")
    end_if_failed(len(failures), len(mine), "see the warnings")
