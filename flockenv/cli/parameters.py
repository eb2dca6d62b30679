"""Options for the parameters of flocks: a preset, a TOML file, single fields."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from flockenv._io.toml import read_toml, read_toml_file
from flockenv.cli.options import option, option_of
from flockenv.errors import ParameterError, short_repr
from flockenv.parameters import FlockParameters


@dataclass(frozen=True, kw_only=True)
class Flocks:
    """Options for the parameters of flocks."""

    #: The fields that have options of their own.
    named: ClassVar[tuple[str, ...]] = ("n_boats",)

    preset: str | None = option(None, "Named parameters: see `flockenv presets`. [simulation]")
    params: Path | None = option(None, "TOML file of parameters, such as the one beside a result.")
    n_boats: int | None = option(None, "Boats, leaders included.")
    changes: list[str] | None = option(
        None, "Set any other field; repeatable.", "--set", metavar="FIELD=VALUE"
    )

    def parameters(self) -> FlockParameters:
        """Return the parameters of the preset, changed by the file and then by single fields.

        Without `--preset` the preset is the one that the file names, or else "simulation". Raises
        ParameterError for an unknown preset or field, a value that is not accepted, or a file that
        cannot be read or is not TOML.
        """
        try:
            return FlockParameters.from_dict(self.fields())
        except TypeError as error:
            raise ParameterError(str(error)) from error

    def fields(self) -> dict[str, object]:
        """Return the fields that the options or the file name, and ``preset`` if they name one."""
        file, preset = self.params, self.preset
        fields = {} if file is None else read_toml_file(file, f"--params {file}")
        if preset is not None:
            if fields.get("preset", preset) != preset:
                raise ParameterError(
                    f"--preset {preset} contradicts preset = {fields['preset']!r} in {file}"
                )
            fields["preset"] = preset
        changed = changed_fields(self.changes or ())
        for name in self.named:
            value = getattr(self, name)
            if value is not None and name in changed:
                raise ParameterError(f"{option_of(name)} and --set {name} are both given: give one")
            if value is not None:
                # The only option with a text is the pool.
                changed[name] = pool_of(value) if isinstance(value, str) else value
        return fields | changed


@dataclass(frozen=True, kw_only=True)
class OneFlock(Flocks):
    """Options for the parameters of a single flock."""

    named: ClassVar[tuple[str, ...]] = ("n_boats", "pool", "n_leaders", "bw_s")

    pool: str | None = option(None, "wide, narrow or (outer_cm, inner_cm). [the preset's]")
    n_leaders: int | None = option(None, "How many of the boats lead.")
    bw_s: float | None = option(None, "Noise: backward duration in s.")


def changed_fields(changes: Sequence[str], option: str = "--set") -> dict[str, object]:
    """Return the fields and values that options such as `--set` name as ``NAME=VALUE``.

    Values are written as in TOML, but parentheses may stand for brackets, and words need no quotes,
    as in ``target=cw,cw,ccw``. Texts of another form and repeated names are refused.
    """
    fields: dict[str, object] = {}
    for change in changes:
        name, equals, text = (part.strip() for part in change.partition("="))
        if not (name and equals and text):
            raise ParameterError(
                f"{option} {short_repr(change)} is not accepted: NAME=VALUE, as in bw_s=0.3"
            )
        if name in fields:
            raise ParameterError(f"{option} changes {name} twice")
        fields[name] = _value(text)
    return fields


def pool_of(text: str) -> Any:
    """Return the pool that an option names: a word, or two radii in parentheses or brackets."""
    if re.fullmatch(r"[\d.]+, *[\d.]+", text):
        raise ParameterError(f"--pool {text} is not accepted: type `--pool '({text})'`")
    return _value(text)


def _value(text: str) -> object:
    """Return the TOML value of a text.

    For a text that is not TOML: a list of its words if it has brackets or commas, or else the text.
    """
    if text[:1] in ("(", "[") and text[-1:] in (")", "]"):
        text = text.replace("(", "[").replace(")", "]")
    try:
        table = read_toml(f"value = {text}", text)
    except ParameterError:
        is_list = text.startswith("[") and text.endswith("]")
        items = [word.strip() for word in (text[1:-1] if is_list else text).split(",")]
        is_word_list = all(map(str.isidentifier, items)) and (is_list or len(items) > 1)
        return items if is_word_list else text
    # A text of several lines could hold further keys. It is returned as a text.
    return table["value"] if table.keys() == {"value"} else text
