"""The parameters of a command: a preset, a TOML file, single fields."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from flockenv._io.toml import read_toml, read_toml_file
from flockenv.errors import ParameterError, shown
from flockenv.parameters import FlockParameters

_NOTHING: Mapping[str, Any] = MappingProxyType({})


def read_parameters(
    preset: str | None = None,
    file: Path | None = None,
    changes: Sequence[str] | None = None,
    named: Mapping[str, Any] = _NOTHING,
) -> FlockParameters:
    """Return the parameters of a preset, a TOML file and changes of single fields.

    The preset is the file's own, or "simulation", unless it is given. Changes are ``FIELD=VALUE``;
    `named` are fields by options of their own. A ParameterError names an unknown preset or field, a
    value that is not accepted, or a file that cannot be read or is no TOML.
    """
    try:
        return FlockParameters.from_dict(given_fields(preset, file, changes, named))
    except TypeError as error:
        raise ParameterError(str(error)) from error


def given_fields(
    preset: str | None = None,
    file: Path | None = None,
    changes: Sequence[str] | None = None,
    named: Mapping[str, Any] = _NOTHING,
) -> dict[str, Any]:
    """Return the fields that a command's options name, and ``preset`` if they name one."""
    fields = {} if file is None else read_toml_file(file, f"--params {file}")
    if preset is not None and fields.setdefault("preset", preset) != preset:
        raise ParameterError(
            f"--preset {preset} contradicts preset = {fields['preset']!r} in {file}"
        )
    changed = changed_fields(changes or ())
    for name, value in named.items():
        if name in changed:
            raise ParameterError(f"{option_of(name)} and --set {name} are both given: one of them")
        changed[name] = _value(value) if isinstance(value, str) else value
    return fields | changed


def option_of(name: str) -> str:
    """Return how a field is spelled as an option."""
    return f"--{name.replace('_', '-')}"


def changed_fields(changes: Sequence[str], option: str = "--set") -> dict[str, Any]:
    """Return what `--set` options, or others like it, give: ``NAME=VALUE`` each.

    Values are as in TOML, also with parentheses for brackets; words need no quotes, as in
    ``target=cw,cw,ccw``. Texts of another form and names that come twice are refused.
    """
    fields: dict[str, Any] = {}
    for change in changes:
        name, equals, text = (part.strip() for part in change.partition("="))
        if not (name and equals and text):
            raise ParameterError(
                f"{option} {shown(change)} is not accepted: NAME=VALUE, as in bw_s=0.3"
            )
        if name in fields:
            raise ParameterError(f"{option} changes {name} twice")
        fields[name] = _value(text)
    return fields


def _value(text: str) -> Any:
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
