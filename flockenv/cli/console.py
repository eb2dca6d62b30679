"""Where commands print: results to standard output, progress and errors to standard error."""

import codecs
import functools
import io
import sys
import unicodedata
from collections.abc import Callable, Collection, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import typer
from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from flockenv._io.interrupts import INTERRUPTED, end_if_interrupted, noted_interrupts

__all__ = [
    "console",
    "ends_on_interrupt",
    "errors",
    "finished_in",
    "interruptible",
    "print_anywhere",
    "print_json",
    "progress_bar",
    "resumable",
    "say",
]

_STORED = "Work that was finished before is stored."

console = Console()
errors = Console(stderr=True)


def say(text: str, on: Console = console) -> None:
    """Print a line unchanged: brackets in a file's name are no markup, and nothing breaks it."""
    on.print(text, markup=False, highlight=False, soft_wrap=True)


def print_json(data: Any) -> None:
    """Print data as JSON, in ASCII: the same on every console."""
    console.print_json(data=data, ensure_ascii=True)


_PLAIN_SIGNS = {
    "–": "-",
    "—": "-",
    "−": "-",
    "×": "x",
    "·": "*",
    "±": "+-",
    "°": "deg",
    "≥": ">=",
    "≤": "<=",
    "≈": "~",
    "√": "sqrt",
    "→": "->",
    "«": '"',
    "»": '"',
}


def _plain(error: UnicodeError) -> tuple[str | bytes, int]:
    """Stand in for a sign that a console lacks: a Greek letter's name, or a sign like it."""
    assert isinstance(error, UnicodeEncodeError)
    sign, end = error.object[error.start], error.start + 1
    if "\udc80" <= sign <= "\udcff":  # A byte of a file's name that is no UTF-8.
        return bytes([ord(sign) - 0xDC00]), end
    name = unicodedata.name(sign, "")
    if name.startswith("GREEK "):
        letter = name.split()[3] if " LETTER " in name else name.split()[1]
        return (letter.capitalize() if " CAPITAL " in name else letter.lower()), end
    alike = unicodedata.normalize("NFKD", sign).encode("ascii", "ignore").decode()
    return _PLAIN_SIGNS.get(sign, alike or "?"), end


def print_anywhere() -> None:
    """Let both streams print signs that they lack, such as Ψ, as plain ones instead of failing."""
    codecs.register_error("flockenv", _plain)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="flockenv")


class _Bar(Progress):
    """A bar that goes away with an error, which is all that is left to read then.

    Without one it ends full, whatever the rounding of its parts. Work ends where it advances, if
    Ctrl-C was noted; `update` is for work that ends elsewhere.
    """

    def advance(self, task_id: TaskID, advance: float = 1.0) -> None:
        super().advance(task_id, advance)
        end_if_interrupted()

    def __exit__(self, kind: type[BaseException] | None, *rest: Any) -> None:
        for task in self.tasks if kind is None else ():
            self.update(task.id, completed=task.total)
        self.live.transient = kind is not None and not issubclass(kind, KeyboardInterrupt)
        if self.live.transient and not self.console.is_interactive:
            self.live.stop()  # What is left where no bar was drawn is an empty line.
        else:
            super().__exit__(kind, *rest)


def progress_bar(disable: bool) -> Progress:
    """Return a bar with the share done and the time left, on standard error."""
    return _Bar(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("left:"),
        TimeRemainingColumn(),
        console=errors,
        disable=disable,
    )


def ends_on_interrupt(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command that Ctrl-C ends with exit code 130 and what `interruptible` noted on it."""

    @functools.wraps(command)
    def wrapped(*arguments: Any, **options: Any) -> None:
        with noted_interrupts():
            try:
                command(*arguments, **options)
                end_if_interrupted()
            except KeyboardInterrupt as interrupt:
                notes = getattr(interrupt, "__notes__", [_STORED])
                say(f"Interrupted. {notes[0]}", errors)
                raise typer.Exit(INTERRUPTED) from None

    return wrapped


@contextmanager
def interruptible(message: str | Callable[[], str]) -> Iterator[None]:
    """Note on a Ctrl-C within a `with` block what became of the work: the command ends with it.

    Parameters
    ----------
    message
        The message, or a function that returns it then.
    """
    try:
        yield
    except KeyboardInterrupt as interrupt:
        interrupt.add_note(message if isinstance(message, str) else message())
        raise


def finished_in(folder: Path, parts: Collection[str]) -> AbstractContextManager[None]:
    """Note on a Ctrl-C within a `with` block which parts are finished.

    Parameters
    ----------
    folder
        Where each part has a folder of its name, written when it is finished.
    parts
        Names of the finished parts, as it grows within the block.
    """

    def message() -> str:
        done = f"Finished and stored in {folder}: {', '.join(parts)}."
        return done if parts else "Nothing was written."

    return interruptible(message)


def resumable(folder: Path) -> AbstractContextManager[None]:
    """Note on a Ctrl-C within a `with` block where work resumes from."""
    return interruptible(
        f"Finished runs are stored in {folder}: the same command resumes from them."
    )
