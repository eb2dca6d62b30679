"""A command's options as a dataclass, and those that several commands share."""

import inspect
from collections.abc import Callable
from dataclasses import MISSING, dataclass, fields
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_type_hints

import typer

__all__ = ["Flocks", "Overwriting", "Printing", "TrustOption", "takes"]

Options = TypeVar("Options")

TrustOption = Annotated[
    bool,
    typer.Option(
        "--trust",
        help="Read .zip files of stable-baselines3 models, which executes the code in them.",
    ),
]


def takes(options: type[Options]) -> Callable[[Callable[[Options], None]], Callable[..., None]]:
    """Let a command take a dataclass: each of its fields is an option of the command line.

    Parameters
    ----------
    options
        A dataclass whose fields are annotated as `typer` has it; a field without a default is an
        argument.
    """
    hints = get_type_hints(options, include_extras=True)
    parameters = [
        inspect.Parameter(
            each.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=inspect.Parameter.empty if each.default is MISSING else each.default,
            annotation=hints[each.name],
        )
        for each in fields(options)  # type: ignore[arg-type]
    ]

    def taking(command: Callable[[Options], None]) -> Callable[..., None]:
        @wraps(command)
        def called(**given: Any) -> None:
            command(options(**given))

        called.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        called.__annotations__ = {each.name: each.annotation for each in parameters}
        return called

    return taking


@dataclass(frozen=True, kw_only=True)
class Flocks:
    """Which parameters a flock has."""

    preset: Annotated[
        str | None,
        typer.Option("--preset", help="Named parameters: see `flockenv presets`. [simulation]"),
    ] = None
    params: Annotated[
        Path | None,
        typer.Option(
            "--params", help="TOML file of parameters, such as those saved beside results."
        ),
    ] = None
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="FIELD=VALUE", help="Change one field; may be repeated."),
    ] = None


@dataclass(frozen=True, kw_only=True)
class Overwriting:
    """Whether files that are there may be written over."""

    force: Annotated[
        bool, typer.Option("--force", help="Overwrite files that are there already.")
    ] = False


@dataclass(frozen=True, kw_only=True)
class Printing:
    """How much a command prints."""

    as_json: Annotated[bool, typer.Option("--json", help="Print the results as JSON.")] = False
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Print no progress and no remarks.")
    ] = False

    @property
    def shows_nothing(self) -> bool:
        """Whether no progress is shown."""
        return self.as_json or self.quiet
