"""The command line, one file per command; `flockenv COMMAND --help` describes each."""

from typing import Annotated, Any

import typer
import typer.core

from flockenv._core import __version__
from flockenv.cli.analyze import analyze
from flockenv.cli.compare import compare
from flockenv.cli.console import (
    console,
    ends_on_interrupt,
    errors,
    print_anywhere,
    say,
)
from flockenv.cli.demo import demo
from flockenv.cli.parameters import refuse_fields_as_options
from flockenv.cli.presets import presets
from flockenv.cli.replay import replay
from flockenv.cli.run import run
from flockenv.cli.sweep import sweep
from flockenv.cli.train import train
from flockenv.errors import FlockError

__all__ = ["app", "main"]

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Flocks of radio-controlled boats with a few steerable leaders (Tarcai et al. 2011).",
)


class _Command(typer.core.TyperCommand):
    """A command that shows how a parameter is changed, which is no option of its own."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        if any(parameter.name == "changes" for parameter in self.params):
            known = {option for parameter in self.params for option in parameter.opts}
            refuse_fields_as_options(args, known)
        return super().parse_args(ctx, args)


COMMANDS = (
    demo,
    run,
    replay,
    analyze,
    compare,
    presets,
    sweep,
    train,
)

for command in COMMANDS:
    app.command(cls=_Command)(ends_on_interrupt(command))


def main() -> None:
    """Run the command line; errors of the user's or of files end it with exit code 2."""
    print_anywhere()
    try:
        app()
    except (FlockError, OSError) as error:
        errors.print("[bold red]Error:[/]", end=" ")
        say(_in_words(error), errors)
        raise SystemExit(2) from error


def _in_words(error: FlockError | OSError) -> str:
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    return str(error)


@app.callback(invoke_without_command=True)
def _root(
    version: Annotated[bool, typer.Option("--version", help="Print the version and exit.")] = False,
) -> None:
    if version:
        console.print(__version__)
        raise typer.Exit
