"""The command line, one file per command; `flockenv COMMAND --help` describes each."""

import importlib
import io
import os
import sys
from collections.abc import Collection, Mapping
from typing import Annotated

import typer

from flockenv._core import __version__
from flockenv.cli.console import echo, errors
from flockenv.errors import FlockError

__all__ = ["app", "main"]

app: typer.Typer
"""Every command, imported."""

COMMANDS: Mapping[str, str] = {
    "demo": "Run the paper's law and the learned leaders side by side, and open the page that "
    "plays both.",
    "run": "Run one flock and record it.",
    "replay": "Write recordings as one page that plays them: in any browser, without a network.",
    "analyze": "Print the order parameters of a recording, or of tracked robots or animals.",
    "compare": "Print and plot order against the number of leaders, for your policies and others.",
    "presets": "Print every preset: values, units, meanings and sources (sections of Tarcai et al. "
    "2011).",
    "sweep": "Run a grid of parameters and seeds, as one table.",
    "train": "Train one policy for all leaders, with PPO (extra `train`) or in paired branches.",
}
"""The commands, and the first line of each one's help."""


def main() -> None:
    """Run the command line; an error of the user's or of a file ends it with exit code 2."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # Not every console has a Ψ.
    arguments = sys.argv[1:]
    if arguments == ["--version"]:
        _print_version()  # Typer would import pydantic to read a flag.
        return
    try:
        # For completions, a shell puts the words of the line into an environment variable.
        is_completion = "_FLOCKENV_COMPLETE" in os.environ
        _app(COMMANDS if is_completion else COMMANDS.keys() & set(arguments))()
    except (FlockError, OSError) as error:
        text = str(error)
        if isinstance(error, OSError) and error.filename is not None:
            text = f"{error.filename}: {error.strerror}"
        errors.print("[bold red]Error:[/]", end=" ")
        echo(text, errors)
        raise SystemExit(2) from error


def _app(imported: Collection[str]) -> typer.Typer:
    """Return the command line with these commands imported; the others only have help lines."""
    app = typer.Typer(
        no_args_is_help=True,
        rich_markup_mode="markdown",
        context_settings={"help_option_names": ["-h", "--help"]},
        help="Flocks of radio-controlled boats with a few steerable leaders (Tarcai et al. 2011).",
    )
    app.callback(invoke_without_command=True)(_root)
    for name, help_line in COMMANDS.items():
        if name in imported:
            from flockenv.cli.command import Command
            from flockenv.cli.progress import ends_on_interrupt

            command = getattr(importlib.import_module(f"flockenv.cli.{name}"), name)
            app.command(cls=Command)(ends_on_interrupt(command))
        else:
            app.command(name, help=help_line)(_not_imported)
    return app


def _print_version() -> None:
    echo(__version__)


def _root(
    version: Annotated[bool, typer.Option("--version", help="Print the version and exit.")] = False,
) -> None:
    if version:
        _print_version()
        raise typer.Exit


def _not_imported() -> None:
    # This is never called: the user names the command that runs, and named ones are imported.
    raise NotImplementedError


def __getattr__(name: str) -> typer.Typer:
    if name == "app":
        return _app(COMMANDS)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
