"""`flockenv reproduce`."""

import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flockenv.cli.console import console, print_json, progress_bar, resumable, say
from flockenv.cli.output import check_folder
from flockenv.cli.workload import (
    DryRun,
    EngineName,
    ShardOf,
    Workers,
    chosen_shard,
    make_shard,
    show_workload,
    warn,
)
from flockenv.errors import ParameterError
from flockenv.reproduce import names, require_packages
from flockenv.runs.executors import named
from flockenv.runs.store import RUNS_FOLDER

if TYPE_CHECKING:
    from flockenv.reproduce.claim import CheckedClaim

__all__ = ["reproduce"]

_NAMES = f"What to reproduce: {', '.join(names())}, or all."


def reproduce(
    what: Annotated[list[str], typer.Argument(metavar="NAME...", help=_NAMES)],
    minutes: Annotated[
        float | None, typer.Option(help="Length of each run. [the paper's own]")
    ] = None,
    budget: Annotated[
        float, typer.Option(help="Core-minutes for each name that is beyond the paper.")
    ] = 40.0,
    engine: EngineName = "local",
    workers: Workers = None,
    shard: ShardOf = None,
    dry_run: DryRun = False,
    seed: Annotated[int, typer.Option(min=0, help="First seed.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for results.")] = Path("results/reproduce"),
    summary: Annotated[
        Path | None,
        typer.Option(help="Markdown file for claims and pictures, as in docs."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the claims as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Reproduce figures of the paper and check its claims.

    Writes each figure (PNG and SVG), its data (CSV and Parquet) and a table of claims with measured
    values, intervals and verdicts; for `all` also one HTML report. Finished runs are stored
    in `runs/`, and an interrupted command resumes when it is given again. Several machines that
    share a folder make one shard each, with `--shard 1/8` to `--shard 8/8`; the command without
    `--shard` then writes the figures.

    Example: `flockenv reproduce fig14 fig17`
    """
    require_packages()
    from flockenv.reproduce.command import plan, reproduce
    from flockenv.reproduce.reproduction import Settings

    where, part = named(engine), chosen_shard(shard)
    work = plan(what, Settings(seed, minutes, budget))
    if dry_run:
        show_workload(work.specs, out / RUNS_FOLDER, part, as_json)
        return
    check_folder(out)
    if part is not None:
        make_shard(work.specs, out / RUNS_FOLDER, part, where, workers, quiet, as_json)
        return
    if summary is not None:
        _check_summary(summary)
    with resumable(out / RUNS_FOLDER), progress_bar(quiet or as_json) as progress:
        task = progress.add_task(f"{len(work.specs)} runs", total=work.cost)
        claims = reproduce(
            work,
            out,
            where,
            lambda spec: progress.advance(task, spec.cost),
            warn,
            summary,
            workers,
        )
    if as_json:
        rows = [{"figure": name, **each.row()} for name, list_ in claims.items() for each in list_]
        print_json(rows)
        return
    for name, judged in claims.items():
        for each in judged:
            say(_block(name, each, console.width) + "\n")
    say(f"Written to {out}")


def _check_summary(page: Path) -> None:
    # Pictures go into a folder of the page's name without its suffix.
    if page.suffix != ".md":
        raise ParameterError(f"--summary {page} is not accepted: a file that ends in .md")
    check_folder(page.parent, "--summary: folder")


def _block(figure: str, checked: "CheckedClaim", width: int) -> str:
    """Return a claim in words, its verdict first, in lines of so many columns."""
    # Only now: statistics take their time to be imported.
    from flockenv.reproduce.claim import number

    claim = checked.claim
    measured = f"measured {number(checked.measured)}, interval {checked.ends}"
    lines = [
        f"{checked.verdict.upper()}  {figure}: {claim.text} (Section {claim.section})",
        f"  for {checked.scope}: {claim.quantity}",
        f"  {measured}, claimed {claim.accepted}" + (f"; {checked.note}" if checked.note else ""),
    ]
    return "\n".join(textwrap.fill(line, width, subsequent_indent="    ") for line in lines)
