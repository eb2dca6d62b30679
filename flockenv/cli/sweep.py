"""`flockenv sweep`."""

import json
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from flockenv._io.atomic_write import write_text
from flockenv.cli.console import echo, errors, print_json, warn
from flockenv.cli.options import Overwriting, Printing, argument, option, takes
from flockenv.cli.output import prepare
from flockenv.cli.progress import progress
from flockenv.errors import ParameterError
from flockenv.runs.executors import named
from flockenv.runs.spec import RunSpec
from flockenv.runs.store import RUNS_FOLDER, RunStore, run_missing
from flockenv.runs.workload import Shard, measure_workload

if TYPE_CHECKING:
    import pandas as pd

    from flockenv.runs.sweep import SweepSpec


@dataclass(frozen=True, kw_only=True)
class SweepOptions(Overwriting, Printing):
    """Options of `flockenv sweep`."""

    spec: Path = argument("TOML file that says what to run.")
    engine: str = option("local", "Where to run: local or ray.")
    workers: int | None = option(
        None, "Runs at a time. [every core that this process may use]", min=1
    )
    shard: str | None = option(None, "Make only the I-th of N shares of the runs.", metavar="I/N")
    dry_run: bool = option(
        False, "Run nothing; print the number of runs and how long they take.", "--dry-run"
    )
    out: Path | None = option(None, "Folder for results. [results/sweep/NAME]")


@takes(SweepOptions)
def sweep(options: SweepOptions) -> None:
    """Run a grid of parameters and seeds, as one table.

    Writes `sweep.csv` and `sweep.parquet`, one row per run, and beside them the TOML file as
    `sweep.toml`; `flockenv.runs.sweep.load_sweep` reads the table. Finished runs are stored in
    `runs/`: give the same command again to resume. Machines that share a folder can make one shard
    each, with `--shard 1/8` to `--shard 8/8`; afterwards the command without `--shard` writes the
    table.
    If the noise `bw_s` varies, the command prints at which noise each flock loses its order, with a
    95 % interval. It needs at least three runs at each noise.
    A folder holds one sweep: for another one, name another folder or give `--force`.
    `docs/runs.md` describes the TOML file. If a run fails, its row says why, the others go on, and
    the command ends with exit code 1.

    Example: `flockenv sweep docs/sweep-example.toml`
    """
    from flockenv.runs.sweep import read_sweep, run_sweep

    engine = named(options.engine)
    shard = None if options.shard is None else Shard.parse(options.shard)
    spec = read_sweep(options.spec)
    runs = list(dict.fromkeys(spec.runs))
    if shard is not None:
        runs = shard.runs_of(runs)
    folder = options.out or Path("results/sweep") / options.spec.stem
    store = RunStore(folder / RUNS_FOLDER, warn)
    if options.dry_run:
        _show_workload(options, runs, store)
        return
    _store_spec(options, folder / "sweep.toml", spec)
    with _progress_of(options, runs, folder) as finished:
        if shard is not None:
            failures = run_missing(runs, store, engine, finished, options.workers)
        else:
            table = run_sweep(spec, folder, engine, finished, warn, options.workers)
    if shard is not None:
        failed, reasons = _show_shard(options, shard, len(runs), failures), "see the warnings"
    else:
        failed, reasons = _show_table(options, folder, len(runs), table), "see the column failure"
    if failed:
        echo(f"{failed} of {len(runs)} runs failed: {reasons}", errors)
        raise typer.Exit(1)


def _store_spec(options: SweepOptions, copy: Path, spec: "SweepSpec") -> None:
    """Copy the TOML file into the folder of the sweep; refuse that of another one."""
    if not options.force:
        _check_same(copy, spec)
    prepare(copy)
    write_text(copy, options.spec.read_text("utf-8"))


@contextmanager
def _progress_of(
    options: SweepOptions, runs: list[RunSpec], folder: Path
) -> Iterator[Callable[[RunSpec], None]]:
    """Show the progress of runs, and yield the function to call after each of them."""
    total = sum(run.cost for run in runs)
    stored_note = f"The runs that were finished are stored in {folder}: the same command resumes."
    with progress(
        f"{len(runs)} runs",
        total,
        options.hides_progress,
        interruptible=False,
        stored_note=stored_note,
    ) as advance:
        yield lambda run: advance(run.cost)


def _show_shard(
    options: SweepOptions, shard: Shard, run_count: int, failures: Mapping[RunSpec, Exception]
) -> int:
    """Print the result of a shard, and return the number of failed runs."""
    for run, error in failures.items():
        warn(f"the run of seed {run.seed} failed: {error}")
    failed = len(failures)
    if options.as_json:
        print_json({"shard": str(shard), "runs": run_count, "failed": failed})
    else:
        echo(
            f"Shard {shard}: {run_count - failed} of {run_count} runs are stored. When all shards "
            "have ended, the same command without --shard writes the table."
        )
    return failed


def _show_table(options: SweepOptions, folder: Path, run_count: int, table: "pd.DataFrame") -> int:
    """Print the table or its path, and return the number of failed runs."""
    if options.as_json:
        print_json(json.loads(table.to_json(orient="records")))
    else:
        echo(f"{run_count} runs, written to {folder}")
        _show_critical_noises(table)
    return int((table["failure"] != "").sum())


def _show_critical_noises(table: "pd.DataFrame") -> None:
    """Print at which noise each flock loses its order, if the sweep has several noises."""
    from flockenv.runs.sweep import critical_noises
    from flockenv.statistics import LEAST_ROTATION

    rows = critical_noises(table)
    flock_columns = rows.columns[:-4]
    for row in rows.to_dict("records"):
        flock = ", ".join(f"{name} {row[name]}" for name in flock_columns)
        noise, low, high = (row[f"critical_bw_s{end}"] for end in ("", "_low", "_high"))
        strongest = row["rotation_size"]
        if not math.isnan(noise):
            result = f"order is lost at bw_s {noise:.3g} s ({low:.3g} to {high:.3g})"
        elif strongest >= LEAST_ROTATION:
            result = (
                "the noise at which order is lost is unknown: it takes three runs at each noise, "
                "and noises up to disorder"
            )
        else:
            result = (
                f"no order to lose: mean |m| is {strongest:.2f} at most, below {LEAST_ROTATION}"
            )
        echo(f"{flock}: {result}" if flock else f"{result[0].upper()}{result[1:]}")


def _check_same(path: Path, spec: "SweepSpec") -> None:
    """Refuse to replace the sweep of a folder by a different one.

    Two files that specify the same runs are the same sweep, whatever their spelling.
    """
    from flockenv.runs.sweep import read_sweep

    try:
        is_same = not path.exists() or read_sweep(path) == spec
    except ParameterError:
        is_same = False
    if not is_same:
        raise ParameterError(
            f"{path} already exists and belongs to another sweep: name another folder with --out, "
            "or replace its table with --force"
        )


def _show_workload(options: SweepOptions, runs: list[RunSpec], store: RunStore) -> None:
    """Print how many runs there are, how many are stored, and how long the rest will take."""
    work = measure_workload(runs, store)
    if options.as_json:
        print_json(asdict(work))
        return
    echo(f"{work.runs} runs, {work.stored} of them stored")
    hours = work.core_hours
    time = "an unknown time" if hours is None else f"about {_in_units(3600 * hours)}"
    echo(f"The others: {work.flock_hours:.4g} flock-hours, {time} of one core here")


def _in_units(seconds: float) -> str:
    """Return a time in seconds, minutes or hours, such as "3.0 h"."""
    if seconds < 100.0:
        return f"{max(seconds, 1.0):.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000.0 else f"{seconds / 3600:.1f} h"
