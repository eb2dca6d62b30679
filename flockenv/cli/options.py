"""A command's options as a dataclass, and those that several commands share."""

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
"""A function that returns the accepted endings of a file's name."""


def option(
    default: Value,
    help: str,  # noqa: A002
    *names: str,
    endings: Endings | None = None,
    **settings: Any,
) -> Value:
    """Return a dataclass field for an option of a command; `settings` go to `typer.Option`.

    `endings` returns the accepted endings of the name of a file that the option names.
    """
    declared = typer.Option(*names, help=help, **settings)
    return field(default=default, metadata={"typer": declared, "endings": endings})


def argument(help: str, default: Any = MISSING, **settings: Any) -> Any:  # noqa: A002
    """Return a dataclass field that is an argument; without a default it must be given."""
    return field(default=default, metadata={"typer": typer.Argument(help=help, **settings)})


def takes(options: type[Options]) -> Callable[[Callable[[Options], None]], Callable[..., None]]:
    """Let a command take a dataclass of options and arguments."""
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

    def taking(command: Callable[[Options], None]) -> Callable[..., None]:
        @wraps(command)
        def called(**given: object) -> None:
            checked = options(**given)
            _check_endings(checked)
            command(checked)

        called.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        called.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
        return called

    return taking


def option_of(name: str) -> str:
    """Return a field's spelling as an option."""
    return f"--{name.replace('_', '-')}"


def _check_endings(options: object) -> None:
    """Refuse files whose names lack the endings that their options declare."""
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
    """Options for the printing of a command."""

    as_json: bool = option(False, "Print the results as JSON.", "--json")
    quiet: bool = option(False, "Print no progress and no remarks.", "--quiet", "-q")

    @property
    def shows_nothing(self) -> bool:
        """Whether no progress is shown."""
        return self.as_json or self.quiet
