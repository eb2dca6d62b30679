"""TOML as a dictionary, with one kind of error for text that is none."""

import tomllib
from typing import Any

from flockenv.errors import ParameterError

__all__ = ["read_toml"]


def read_toml(text: str, what: str) -> dict[str, Any]:
    """Return the values in a TOML text.

    Parameters
    ----------
    text
        The text.
    what
        What errors call it, such as the name of its file.

    Raises
    ------
    ParameterError
        For text that is no TOML, and for numbers and nesting that nothing here could take.
    TypeError
        For what is no text.
    """
    if not isinstance(text, str):
        raise TypeError(f"{what} must be a string, not {type(text).__name__}")
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise ParameterError(f"{what} is no TOML: it is nested too deeply") from error
    except ValueError as error:  # Also of integers of thousands of digits.
        raise ParameterError(f"{what} is no TOML: {error}") from error
