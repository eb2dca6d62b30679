"""Checks and conversions of arguments: sequences, iterators, arrays, numbers, bools and bytes."""

import math
import operator
from collections.abc import Iterable, Iterator, Mapping, MappingView, Sequence, Set
from itertools import islice
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv.errors import ParameterError, short_repr

_MOST_ITEMS = 1_000_000
_NO_NUMBERS = (str, bytes, np.datetime64, np.timedelta64)


def items(values: object, name: str) -> Sequence[Any]:
    """Return the items of a sequence: a list, an array, a generator or a view of a dictionary.

    A range is returned unchanged. Raises TypeError for texts, dictionaries and sets, and
    ParameterError for more than a million items, as of an endless generator.
    """
    if isinstance(values, range):
        return values
    unordered = isinstance(values, Set) and not isinstance(values, MappingView)
    if unordered or isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
        raise TypeError(f"{name} must be a sequence, not {short_repr(values)}")
    first_items = tuple(islice(_iterator(values, name), _MOST_ITEMS + 1))
    if len(first_items) > _MOST_ITEMS:
        raise ParameterError(f"{name} has more than {_MOST_ITEMS} items: too many")
    return first_items


def _iterator(values: Iterable[object], name: str) -> Iterator[object]:
    try:
        return iter(values)
    except TypeError as error:  # A 0-dimensional array is an Iterable, too.
        raise TypeError(f"{name} must be a sequence, not {short_repr(values)}") from error


def by_name(values: object, name: str) -> dict[Any, Any]:
    """Return a mapping as a new dictionary; raise TypeError for anything else."""
    if not isinstance(values, Mapping):
        raise TypeError(f"{name} must be a dictionary, not {short_repr(values)}")
    return dict(values)


def check_function(value: object, name: str) -> None:
    """Raise TypeError for a value that cannot be called."""
    if not callable(value):
        raise TypeError(f"{name} must be a function, not {short_repr(value)}")


def materialized(values: object) -> Any:
    """Return the items of an iterator or of a dictionary's view, and any other value unchanged."""
    return items(values, "the argument") if isinstance(values, Iterator | MappingView) else values


def listed(value: object) -> object:
    """Return an array as a list or a number, and any other value as `materialized` does.

    This includes arrays of other libraries. Masked arrays, tables and arrays of more than a million
    numbers are returned unchanged: a later check refuses them by name.
    """
    if not hasattr(value, "__array__") or hasattr(value, "columns") or np.ma.is_masked(value):
        return materialized(value)
    try:
        array = np.asarray(value)
    except Exception:  # Arrays of other libraries may raise anything.
        return value
    return array.tolist() if array.size <= _MOST_ITEMS else value


def as_int(value: Any, name: str) -> int:
    """Return a whole number, such as 8 or 8.0, as an int.

    Raises ParameterError for other floats, and TypeError for everything else, bools included.
    """
    # NumPy's integers and 0-dimensional arrays of an integer are accepted too, as in the core.
    try:
        if not isinstance(value, bool | np.bool_):
            return operator.index(value)
    except TypeError:
        pass
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, float | np.floating):
        if float(value).is_integer():
            return int(value)
        raise ParameterError(f"{name} = {short_repr(value)} is not accepted: a whole number")
    kind = type(value).__name__
    raise TypeError(f"{name} must be an integer, not {short_repr(value)} of type {kind}")


def _check_no_table(values: object, name: str) -> None:
    """Refuse a table, since its column names would be ignored."""
    if hasattr(values, "columns"):
        raise ParameterError(f"{name} is not accepted: an array, as a table's to_numpy()")


def real_numbers(values: object, name: str) -> np.ma.MaskedArray[Any, Any]:
    """Return an array of real numbers, which may be masked; raise ParameterError for others.

    NumPy itself would turn text and times into numbers, and drop imaginary parts.
    """
    _check_no_table(values, name)
    try:
        array: np.ma.MaskedArray[Any, Any] = np.ma.asarray(values)
    except Exception as error:  # Arrays of other libraries may raise anything.
        raise ParameterError(f"{name} is not accepted: real numbers") from error
    if array.dtype.kind not in "biuf":
        raise ParameterError(f"{name} is not accepted: real numbers, not {array.dtype}")
    return array


def with_gaps(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return a copy as an array of real numbers, with NaN for masked values and None."""
    _check_no_table(values, name)
    try:
        array: np.ma.MaskedArray[Any, Any] = np.ma.asarray(values)
        if array.dtype.kind == "O":
            # NumPy would turn these into numbers.
            if any(isinstance(value, _NO_NUMBERS) for value in array.compressed()):
                raise TypeError("text or a time")
            array = np.ma.asarray(values, np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ParameterError(f"{name} is not accepted: real numbers") from error
    return np.array(np.ma.filled(real_numbers(array, name).astype(np.float64), np.nan))


def series(values: object, name: str) -> NDArray[np.float64]:
    """Return a sequence of numbers as an array, shape (n,); refuse anything else."""
    _check_no_table(values, name)
    array = with_gaps(items(values, name), name)
    if array.ndim != 1:
        raise ParameterError(f"{name} has shape {array.shape}, expected (n,)")
    return array


def number(value: object, name: str) -> Any:
    """Return a real number unchanged; raise TypeError for anything else, bools included."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"{name} must be a number, not {short_repr(value)}")
    return value


def as_float(value: Any) -> float:
    """Return a real number as a float, infinite if it is too large for one."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def as_bool(value: object, name: str) -> bool:
    """Return a bool; raise TypeError for anything else, such as "no", which would count as true."""
    if not isinstance(value, bool | np.bool_):
        raise TypeError(f"{name} must be True or False, not {short_repr(value)}")
    return bool(value)


def as_bytes(value: object, name: str) -> bytes:
    """Return bytes unchanged; raise TypeError for anything else."""
    if not isinstance(value, bytes):
        raise TypeError(f"{name} must be bytes, not {short_repr(value)}")
    return value
