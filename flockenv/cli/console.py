"""Where commands print: results to standard output, progress and errors to standard error."""

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Protocol

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from flockenv._io.interrupts import INTERRUPTED, end_if_interrupted, noted_interrupts

__all__ = ["console", "ends_on_interrupt", "errors", "print_json", "progress", "say", "warn"]

console = Console()
errors = Console(stderr=True)


def say(text: str, on: Console = console) -> None:
    """Print a line unchanged: brackets in a file's name are no markup, and nothing breaks it."""
    on.print(text, markup=False, highlight=False, soft_wrap=True)


def warn(line: str) -> None:
    """Print a warning."""
    say(f"Warning: {line}", errors)


def print_json(data: Any) -> None:
    """Print data as JSON, in ASCII: the same on every console."""
    console.print_json(data=data, ensure_ascii=True)


class Advance(Protocol):
    """Moves a bar on, by an amount of work."""

    def __call__(self, done: float = 1.0, what: str | None = None) -> None:
        """Move the bar on, and change what it says that is done."""


@contextmanager
def progress(what: str, total: float | None, quiet: bool, ends: bool = True) -> Iterator[Advance]:
    """Show a bar with the time left, on a terminal, and yield what moves it on.

    Parameters
    ----------
    what, total
        What is done, and how much of it there is; None: as the function that is yielded adds up.
    quiet
        Whether to show nothing.
    ends
        Whether work ends where it moves on, if Ctrl-C was noted.
    """
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("left:"),
        TimeRemainingColumn(),
    )
    disable = quiet or not errors.is_terminal
    with Progress(*columns, console=errors, transient=True, disable=disable) as bar:
        task = bar.add_task(what, total=total)

        def advance(done: float = 1.0, what: str | None = None) -> None:
            bar.update(task, advance=done, description=what)
            if ends:
                end_if_interrupted()

        yield advance


def ends_on_interrupt(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command that Ctrl-C ends with exit code 130, where nothing is half done."""

    @functools.wraps(command)
    def wrapped(*arguments: Any, **options: Any) -> None:
        with noted_interrupts():
            try:
                command(*arguments, **options)
                end_if_interrupted()
            except KeyboardInterrupt:
                say("Interrupted. What was finished before is stored.", errors)
                raise typer.Exit(INTERRUPTED) from None

    return wrapped
