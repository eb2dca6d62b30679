"""The command line, one file per command; `flockenv COMMAND --help` describes each."""

import io
import sys
from typing import Annotated

import typer

from flockenv._core import __version__
from flockenv.cli.analyze import analyze
from flockenv.cli.compare import compare
from flockenv.cli.console import console, ends_on_interrupt, errors, say
from flockenv.cli.demo import demo
from flockenv.cli.presets import presets
from flockenv.cli.replay import replay
from flockenv.cli.run import run
from flockenv.cli.sweep import sweep
from flockenv.cli.train import train
from flockenv.cli.unknown import refuse_unknown_options
from flockenv.errors import FlockError

__all__ = ["app", "main"]

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Flocks of radio-controlled boats with a few steerable leaders (Tarcai et al. 2011).",
)

for command in (demo, run, replay, analyze, compare, presets, sweep, train):
    app.command()(ends_on_interrupt(command))


def main() -> None:
    """Run the command line; errors of the user's or of files end it with exit code 2."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # Not every console has a Ψ.
    try:
        refuse_unknown_options(getattr(typer.main.get_command(app), "commands", {}), sys.argv[1:])
        app()
    except (FlockError, OSError) as error:
        words = str(error)
        if isinstance(error, OSError) and error.filename is not None:
            words = f"{error.filename}: {error.strerror}"
        errors.print("[bold red]Error:[/]", end=" ")
        say(words, errors)
        raise SystemExit(2) from error


@app.callback(invoke_without_command=True)
def _root(
    version: Annotated[bool, typer.Option("--version", help="Print the version and exit.")] = False,
) -> None:
    if version:
        console.print(__version__)
        raise typer.Exit
