"""Options of commands as dataclasses, and the options that several commands share."""

import inspect
from collections.abc import Callable, Iterable
from dataclasses import MISSING, dataclass, field, fields
from functools import wraps
from typing import Annotated, Any, TypeVar, get_type_hints

import typer

from flockenv.errors import ParameterError

Options = TypeVar("Options")
Value = TypeVar("Value")

TRUST = "Read .zip files of SB3 models and import module:attribute: this executes their code."
"""Help of the option ``trust``."""


Endings = Callable[[], Iterable[str]]
"""A function that returns the endings that are accepted in a file's name."""


def option(
    default: Value,
    help: str,  # noqa: A002
    *names: str,
    endings: Endings | None = None,
    **settings: Any,
) -> Value:
    """Return a dataclass field for an option of a command.

    `settings` go to `typer.Option`. If the option names a file, `endings` returns the endings that
    are accepted in the file's name.
    """
    typer_option = typer.Option(*names, help=help, **settings)
    return field(default=default, metadata={"typer": typer_option, "endings": endings})


def argument(help: str, default: Any = MISSING, **settings: Any) -> Any:  # noqa: A002
    """Return a dataclass field for an argument; without a default it is required."""
    return field(default=default, metadata={"typer": typer.Argument(help=help, **settings)})


def takes(options: type[Options]) -> Callable[[Callable[[Options], None]], Callable[..., None]]:
    """Return a decorator that gives a command an option for each field of a dataclass.

    The command is called with an instance that holds the values from the command line.
    """
    hints = get_type_hints(options)
    parameters = [
        inspect.Parameter(
            option_.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=inspect.Parameter.empty if option_.default is MISSING else option_.default,
            annotation=Annotated[hints[option_.name], option_.metadata["typer"]],
        )
        for option_ in fields(options)  # type: ignore[arg-type]
    ]

    def decorate(command: Callable[[Options], None]) -> Callable[..., None]:
        @wraps(command)
        def wrapped(**values: object) -> None:
            filled = options(**values)
            _check_endings(filled)
            command(filled)

        # Typer reads the options from the signature and the annotations.
        wrapped.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        wrapped.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
        return wrapped

    return decorate


def option_of(name: str) -> str:
    """Return the option of a field: ``--bw-s`` for ``bw_s``."""
    return f"--{name.replace('_', '-')}"


def _check_endings(options: object) -> None:
    """Refuse a file whose name has none of the endings that its option accepts."""
    for option_ in fields(options):  # type: ignore[arg-type]
        path, endings = getattr(options, option_.name), option_.metadata.get("endings")
        if path is None or endings is None:
            continue
        accepted = list(endings())
        if path.suffix.lower() not in accepted:
            raise ParameterError(
                f"{option_of(option_.name)} {path} is not accepted: a name that ends in "
                f"{', '.join(accepted)}"
            )


@dataclass(frozen=True, kw_only=True)
class Overwriting:
    """Whether existing files may be overwritten."""

    force: bool = option(False, "Overwrite existing files.", "--force")


@dataclass(frozen=True, kw_only=True)
class Printing:
    """Options for what a command prints."""

    as_json: bool = option(False, "Print the results as JSON.", "--json")
    quiet: bool = option(False, "Print no progress and no remarks.", "--quiet", "-q")

    @property
    def hides_progress(self) -> bool:
        """Whether progress is hidden."""
        return self.as_json or self.quiet
