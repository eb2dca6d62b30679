"""What commands do with files they are given and asked for."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import typer

from flockenv import ParameterError, Recording
from flockenv.cli.console import errors, say

__all__ = ["INTERRUPTED", "interruptible", "load_recording", "writable"]

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it."""


def load_recording(path: Path) -> Recording:
    """Return a recording.

    Raises
    ------
    ParameterError
        If the file cannot be read, is damaged, or no recording; the message names it.
    """
    try:
        return Recording.load(path)
    except OSError as error:
        raise ParameterError(f"{path} cannot be read: {error.strerror}") from error


@contextmanager
def writable(path: Path) -> Iterator[Path]:
    """Make a file's folder, and turn failures to write it into a named error.

    Raises
    ------
    ParameterError
        If the file or its folder cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield path
    except OSError as error:
        raise ParameterError(f"{path} cannot be written: {error.strerror}") from error


@contextmanager
def interruptible(told: str) -> Iterator[None]:
    """Let Ctrl-C end a command with a line on what became of its work."""
    try:
        yield
    except KeyboardInterrupt:
        say(f"Stopped. {told}", errors)
        raise typer.Exit(INTERRUPTED) from None
