"""The command line: `flockenv COMMAND --help` tells what each command does."""

import json
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from flockenv import FlockError, FlockParameters, __version__

__all__ = ["app", "main"]

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="markdown",
    help="Flocks of radio-controlled boats with a few steerable leaders (Tarcai et al. 2011).",
)
_console = Console()
_errors = Console(stderr=True)


class PoolChoice(StrEnum):
    """Pools that a comparison can be run in."""

    BOTH = "both"
    FIVE_HUNDRED_BOATS = "500-boats"
    TABLE_1 = "table-1"


def main() -> None:
    """Run the command line; a `FlockError` ends it with its message and exit code 2."""
    try:
        app()
    except FlockError as error:
        _errors.print(f"[bold red]Error:[/] {error}", highlight=False)
        raise SystemExit(2) from error


@app.callback(invoke_without_command=True)
def _root(
    version: Annotated[bool, typer.Option("--version", help="Print the version and exit.")] = False,
) -> None:
    if version:
        _console.print(__version__)
        raise typer.Exit


@app.command()
def compare(
    pool: Annotated[PoolChoice, typer.Option(help="Which pool.")] = PoolChoice.BOTH,
    preset: Annotated[str, typer.Option(help="Preset of the scene.")] = "simulation",
    boats: Annotated[int, typer.Option(help="Boats, leaders included.")] = 27,
    most_leaders: Annotated[int, typer.Option(min=1, help="Runs 0 to this many leaders.")] = 4,
    episodes: Annotated[int, typer.Option(min=2, help="Seeds for each number.")] = 64,
    minutes: Annotated[float, typer.Option(help="Length of an episode.")] = 8.0,
    bw_s: Annotated[
        float | None, typer.Option(help="Noise: length of the backward phase in s. [critical]")
    ] = None,
    target: Annotated[str, typer.Option(help="Direction: cw or ccw.")] = "cw",
    seed: Annotated[int, typer.Option(min=0, help="First seed.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for tables and pictures.")] = Path(
        "results/compare"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print the means as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Print and plot order against the number of leaders (figure 12).

    Runs without leaders, and with leaders that follow the paper's law, on the same seeds, at the
    critical noise of the pool. Writes `runs.csv`, `means.csv`, `leader_curve.png` and
    `parameters.toml` for each pool.

    Example: `flockenv compare --pool table-1 --episodes 128`
    """
    from flockenv.comparison_report import report

    pools = [choice.value for choice in PoolChoice if choice != PoolChoice.BOTH]
    chosen = pools if pool == PoolChoice.BOTH else [pool.value]
    base = FlockParameters.preset(preset).replace(n_boats=boats, target=target)
    scenes = {
        name: base.replace(
            pool=name,
            bw_s=FlockParameters.critical_bw_s(preset, name) if bw_s is None else bw_s,
        )
        for name in chosen
    }
    work = len(scenes) * (most_leaders + 1) * episodes * minutes * 60
    results = {}
    with _progress(quiet or as_json) as progress:
        task = progress.add_task("simulating", total=work)
        for name, scene in scenes.items():
            results[name] = report(
                scene,
                range(most_leaders + 1),
                range(seed, seed + episodes),
                minutes * 60,
                out / name,
                lambda seconds: progress.advance(task, seconds),
            )
    if as_json:
        means = {name: each.means.to_json(orient="records") for name, each in results.items()}
        _console.print_json(data={name: json.loads(text) for name, text in means.items()})
        return
    for name, result in results.items():
        _console.print(result.table())
        _console.print(result.lines_in_words(), highlight=False, soft_wrap=True)
        _console.print(f"Written to {out / name}\n", highlight=False, soft_wrap=True)


@app.command()
def presets() -> None:
    """Print every preset."""
    table = Table("field", *FlockParameters.presets())
    columns = [FlockParameters.preset(name).to_dict() for name in FlockParameters.presets()]
    for field in columns[0]:
        table.add_row(field, *(str(column[field]) for column in columns))
    _console.print(table)


def _progress(disable: bool) -> Progress:
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("left:"),
        TimeRemainingColumn(),
        console=_errors,
        disable=disable,
    )
