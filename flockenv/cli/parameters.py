"""The parameters of a command: a preset, a TOML file, single fields; saved beside its results."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from flockenv._io.atomic_write import write_text
from flockenv._io.toml import read_toml, read_toml_file
from flockenv.errors import ParameterError
from flockenv.parameters import FlockParameters

__all__ = [
    "ChangesOption",
    "FileOption",
    "PresetOption",
    "TrustOption",
    "changed_fields",
    "given_fields",
    "parameters_of",
    "read_parameters",
    "refuse_fields_as_options",
    "save_parameters",
]

FIELDS = frozenset(FlockParameters.__dataclass_fields__)

PresetOption = Annotated[
    str | None,
    typer.Option("--preset", help="Named parameters: see `flockenv presets`. [simulation]"),
]
FileOption = Annotated[
    Path | None,
    typer.Option("--params", help="TOML file of parameters, such as those saved beside results."),
]
ChangesOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="FIELD=VALUE", help="Change one field; may be repeated."),
]
TrustOption = Annotated[
    bool,
    typer.Option(
        "--trust",
        help="Read .zip files of stable-baselines3 models, which executes the code in them.",
    ),
]


def read_parameters(
    preset: str | None = None, file: Path | None = None, changes: Sequence[str] | None = None
) -> FlockParameters:
    """Return the parameters that a command's options select.

    Parameters
    ----------
    preset
        The preset that all else changes; None for the file's own, or "simulation".
    file
        TOML file with any of the fields, and ``preset``.
    changes
        ``field=value`` each, values as in TOML, also with parentheses for brackets; words need no
        quotes, as in ``target=cw,cw,ccw``.

    Raises
    ------
    ParameterError
        For an unknown preset or field, a value that is not accepted, a file that cannot be read
        or is no TOML, a change without ``=``, a field that is changed twice; the message names it.
    """
    return parameters_of(given_fields(preset, file, changes))


def given_fields(
    preset: str | None = None, file: Path | None = None, changes: Sequence[str] | None = None
) -> dict[str, Any]:
    """Return the fields that a command's options name, and ``preset`` if they name one.

    Parameters and errors are those of `read_parameters`; `parameters_of` checks names and values.
    """
    fields = _file_fields(file) if file is not None else {}
    if preset is not None:
        if fields.get("preset", preset) != preset:
            raise ParameterError(
                f"--preset {preset} contradicts preset = {fields['preset']!r} in {file}"
            )
        fields["preset"] = preset
    return fields | changed_fields(changes or ())


def parameters_of(fields: Mapping[str, Any]) -> FlockParameters:
    """Return the parameters that have these fields.

    Raises
    ------
    ParameterError
        For unknown names and values that are not accepted, also of a wrong type.
    """
    try:
        return FlockParameters.from_dict(fields)
    except TypeError as error:
        raise ParameterError(str(error)) from error


def save_parameters(path: Path, parameters: FlockParameters, remark: str) -> None:
    """Write parameters as TOML that `--params` reads, with a remark on how they were used.

    Raises
    ------
    OSError
        If the file cannot be written; what was there before is still there.
    """
    lines = "".join(f"# {line}\n" for line in remark.splitlines())
    write_text(path, lines + parameters.to_toml())


def _file_fields(path: Path) -> dict[str, Any]:
    return read_toml_file(path, f"--params {path}")


def changed_fields(changes: Sequence[str], option: str = "--set") -> dict[str, Any]:
    """Return what `--set` options, or others like it, give.

    Values are as in TOML, words and lists of words also bare.

    Raises
    ------
    ParameterError
        For a change without ``=`` or a value, and a field that is changed twice.
    """
    fields: dict[str, Any] = {}
    for change in changes:
        name, equals, text = (part.strip() for part in change.partition("="))
        if not (name and equals and text):
            raise ParameterError(f"{option} {change!r} is not accepted: NAME=VALUE, as in bw_s=0.3")
        if name in fields:
            raise ParameterError(f"{option} changes {name} twice")
        fields[name] = _value(text)
    return fields


def refuse_fields_as_options(arguments: Sequence[str], known: Collection[str]) -> None:
    """Refuse fields that are given as options of their own, and say how they are changed.

    Parameters
    ----------
    arguments
        What follows a command's name.
    known
        The command's own options.

    Raises
    ------
    ParameterError
        For ``--n_boats 27`` and the like.
    """
    for place, argument in enumerate(arguments):
        option, _, value = argument.partition("=")
        field = option.removeprefix("--").replace("-", "_")
        if argument == "--":
            return
        if option.startswith("--") and field in FIELDS and option not in known:
            following = arguments[place + 1 : place + 2]
            words = value or next(
                (each for each in following if not each.startswith("--")), "VALUE"
            )
            raise ParameterError(
                f"{option} is no option: fields of the parameters are changed with --set, "
                f"as in --set {field}={words}"
            )


def _value(text: str) -> Any:
    """Return a value as TOML has it, also with parentheses for brackets; what is none is words."""
    if text[0] in "([" and text[-1] in ")]":
        text = text.replace("(", "[").replace(")", "]")
    try:
        found = read_toml(f"value = {text}", text)
    except ParameterError:
        is_list = text.startswith("[") and text.endswith("]")
        words = [word.strip() for word in (text[1:-1] if is_list else text).split(",")]
        is_words = all(map(str.isidentifier, words)) and (is_list or len(words) > 1)
        return words if is_words else text
    return found["value"] if found.keys() == {"value"} else text
