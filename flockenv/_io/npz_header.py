"""Files of arrays with a header in JSON that describes them, read without trust."""

import json
import os
from collections.abc import Mapping
from typing import Any, TypeVar

from numpy.typing import NDArray

from flockenv import _core
from flockenv._io.array_file import read_arrays
from flockenv.errors import ParameterError, shown

__all__ = ["array_of", "entry_of", "read_headed"]


def read_headed(
    path: str | os.PathLike[str], kind: str, form: str, **limits: int
) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return the header and the other arrays of a file; nothing in it is ever executed.

    Parameters
    ----------
    path
        The file.
    kind
        What errors say it is not, such as "policy".
    form
        What its header must have as ``format``.
    limits
        As `read_arrays` takes them.

    Raises
    ------
    OSError
        If the file cannot be opened.
    ParameterError
        If it is no file in this format, is damaged, or was made for another version of the
        observation.
    """
    arrays = read_arrays(path, **limits)
    if "header" not in arrays:
        raise ParameterError(f"{path} is no {kind}: it has no header")
    try:
        header = json.loads(str(arrays.pop("header")))
    except (ValueError, RecursionError) as error:
        raise ParameterError(f"{path} is no {kind}: its header is no JSON") from error
    if not isinstance(header, dict) or header.get("format") != form:
        raise ParameterError(f"{path} is no {kind} in the format {form!r}")
    try:
        version = entry_of(header, "observation_version", int)
    except ParameterError as error:
        raise ParameterError(f"{path} is no whole {kind}: {error}") from error
    current = _core.OBSERVATION_VERSION
    if not 1 <= version <= current:
        raise ParameterError(
            f"{path} was made for version {version} of the observation; this package has versions "
            f"up to {current}: train it again"
        )
    return header, arrays


Kind = TypeVar("Kind")
_KINDS = {
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    str: "a text",
    dict: "a table",
}


def entry_of(header: Mapping[str, Any], name: str, kind: type[Kind]) -> Kind:
    """Return an entry of a header.

    Raises
    ------
    ParameterError
        If it is missing or of another kind.
    """
    if name not in header:
        raise ParameterError(f"{name} is missing in its header")
    value = header[name]
    if type(value) is not kind:
        raise ParameterError(f"{name} = {shown(value)} is not accepted: {_KINDS[kind]}")
    found: Kind = value
    return found


def array_of(
    arrays: Mapping[str, NDArray[Any]], name: str, shape: tuple[int, ...] | None = None
) -> NDArray[Any]:
    """Return an array of numbers.

    Raises
    ------
    ParameterError
        If it is missing, has no numbers, or another shape.
    """
    if name not in arrays:
        raise ParameterError(f"the array {name} is missing")
    array = arrays[name]
    if array.dtype.kind not in "biuf":
        raise ParameterError(f"{name} holds {array.dtype}, which is not accepted: numbers")
    if shape is not None and array.shape != shape:
        raise ParameterError(f"{name} has shape {array.shape}, which is not accepted: {shape}")
    return array
