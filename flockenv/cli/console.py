"""The consoles of commands: results on standard output, progress and errors on standard error."""

from rich.console import Console

console = Console()
errors = Console(stderr=True)


def echo(text: str, on: Console = console) -> None:
    """Print a line unchanged: no brackets become markup, and long lines are not wrapped."""
    on.print(text, markup=False, highlight=False, soft_wrap=True)


def warn(line: str) -> None:
    """Print a warning."""
    echo(f"Warning: {line}", errors)


def print_json(data: object) -> None:
    """Print data as JSON, in ASCII: the same on every console."""
    console.print_json(data=data, ensure_ascii=True)
