"""TOML as a dictionary, with a ParameterError for text that is not TOML."""

import os
import tomllib
from typing import Any

from flockenv._io.plain_file import open_plain
from flockenv.errors import ParameterError

_MOST_BYTES = 1 << 20


def read_limited(path: str | os.PathLike[str], failure: str) -> bytes:
    """Return the content of a file; raise ParameterError for more than 1 MiB.

    The error's message starts with `failure`.
    """
    with open_plain(path) as file:
        data = file.read(_MOST_BYTES + 1)
    if len(data) > _MOST_BYTES:
        raise ParameterError(f"{failure}: it is larger than {_MOST_BYTES} bytes")
    return data


def read_toml_file(path: str | os.PathLike[str], label: str) -> dict[str, Any]:
    """Return the values in a TOML file of at most 1 MiB; messages call the file `label`."""
    try:
        return read_toml(read_limited(path, f"{label} is not TOML").decode("utf-8-sig"), label)
    except OSError as error:
        raise ParameterError(f"{label} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise ParameterError(f"{label} is not TOML: {error}") from error


def read_toml(text: str, label: str) -> dict[str, Any]:
    """Return the values in a TOML text; messages call the text `label`.

    Raises ParameterError for text that is not TOML, or has too large numbers or too deep nesting.
    """
    if not isinstance(text, str):
        raise TypeError(f"{label} must be a string, not {type(text).__name__}")
    try:
        return tomllib.loads(text.removeprefix("\ufeff"))
    except RecursionError as error:
        raise ParameterError(f"{label} is not TOML: it is nested too deeply") from error
    except ValueError as error:  # Integers of thousands of digits raise it, too.
        raise ParameterError(f"{label} is not TOML: {error}") from error
