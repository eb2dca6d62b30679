"""Where commands print: results to standard output, progress and errors to standard error."""

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

__all__ = ["console", "errors", "progress_bar"]

console = Console()
errors = Console(stderr=True)


def progress_bar(disable: bool) -> Progress:
    """Return a bar with the share done and the time left, on standard error."""
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("left:"),
        TimeRemainingColumn(),
        console=errors,
        disable=disable,
    )
