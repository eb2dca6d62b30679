"""Progress bars of commands, and their end after Ctrl-C."""

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import typer
from rich.progress import Progress

from flockenv._io.interrupts import INTERRUPTED, end_if_interrupted, noted_interrupts
from flockenv.cli.console import echo, errors


def checkpoint_note(folder: Path) -> str:
    """Return the sentence on an interrupted training: where its checkpoint is."""
    return f"{folder} holds the last checkpoint: --resume continues from it."


@contextmanager
def progress(
    description: str,
    total: float,
    quiet: bool,
    interruptible: bool = True,
    stored_note: str = "Nothing of it is stored.",
) -> Iterator[Callable[..., None]]:
    """Show a progress bar with the time left: on a terminal, and unless `quiet`.

    Yields a function that advances the bar by an amount of work, and may change its description.
    `total` is the whole amount. If `interruptible`, that function raises KeyboardInterrupt after
    Ctrl-C. A KeyboardInterrupt without a message gets the sentence `stored_note`, which tells the
    user how much of the work is stored.
    """
    disable = quiet or not errors.is_terminal
    with Progress(console=errors, transient=True, disable=disable) as bar:
        task = bar.add_task(description, total=total)

        def advance(amount: float = 1.0, new_description: str | None = None) -> None:
            bar.update(task, advance=amount, description=new_description)
            if interruptible:
                end_if_interrupted()

        try:
            yield advance
        except KeyboardInterrupt as interrupt:
            raise KeyboardInterrupt(*(interrupt.args or (stored_note,))) from None


def ends_on_interrupt(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command that ends with exit code 130 after Ctrl-C, at the next safe point.

    Safe points are the calls of `end_if_interrupted`, and the end of the command.
    """

    @functools.wraps(command)
    def wrapped(*arguments: object, **options: object) -> None:
        with noted_interrupts():
            try:
                command(*arguments, **options)
                end_if_interrupted()
            except KeyboardInterrupt as interrupt:
                echo(" ".join(["Interrupted.", *map(str, interrupt.args)]), errors)
                raise typer.Exit(INTERRUPTED) from None

    return wrapped
