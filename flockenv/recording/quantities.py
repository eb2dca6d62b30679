"""User-defined quantities of a recording: functions, and the series that they return, by name."""

from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.arguments import real_numbers
from flockenv.errors import ParameterError, short_repr
from flockenv.order import QUANTITIES, OrderSeries
from flockenv.recording.checks import MOTION, TIMES
from flockenv.recording.stored import ARRAYS, OPTIONAL


def check_names(quantities: object, expected: str) -> None:
    """Refuse quantities that are no dictionary, and names that are taken or no identifiers.

    `expected` says for the error what the dictionary must hold: "functions" or "arrays".
    """
    if not isinstance(quantities, Mapping):
        raise ParameterError(
            f"quantities = {short_repr(quantities)} is not accepted: {expected} by name"
        )
    taken = {*TIMES, *MOTION, "boat", "id", "is_leader"}
    taken |= {quantity.name for quantity in QUANTITIES}
    for name in quantities:
        if not isinstance(name, str) or not name.isidentifier() or name in taken:
            raise ParameterError(
                f"quantity {short_repr(name)} is not accepted: an identifier that no quantity or "
                "column of recordings has"
            )


def checked_functions(functions: Mapping[str, object]) -> dict[str, Callable[[Any], Any]]:
    """Check a user's functions before a run, and return them by name."""
    check_names(functions, "functions")
    checked: dict[str, Callable[[Any], Any]] = {}
    for name, function in functions.items():
        if not callable(function):
            raise ParameterError(
                f"quantity {name!r} = {short_repr(function)} is not accepted: a function of a "
                "recording"
            )
        checked[name] = function
    return checked


def user_series(
    functions: Mapping[str, Callable[[Any], object]], recording: object
) -> dict[str, NDArray[np.float64]]:
    """Return the series of a user's quantities of a recording, by name."""
    checked = checked_functions(functions)
    return {name: _series(name, function, recording) for name, function in checked.items()}


def _series(name: str, function: Callable[[Any], object], recording: object) -> NDArray[np.float64]:
    """Return a function's values as float64, NaN for masked values; refuse too large numbers."""
    try:
        values = function(recording)
    except Exception as error:  # The user's function may raise anything.
        raise ParameterError(
            f"quantity {name!r} failed: {type(error).__name__}: {error}"
        ) from error
    numbers = real_numbers(values, f"quantity {name!r}")
    with np.errstate(over="ignore"):
        doubles = np.ma.asarray(numbers.astype(np.float64))
    series = np.ma.filled(doubles, np.nan).copy()
    if (np.isinf(series) & np.isfinite(np.ma.filled(numbers, 0))).any():
        raise ParameterError(f"quantity {name!r} is not accepted: numbers that fit float64")
    return series


def check_quantities(quantities: Mapping[str, object], times: tuple[int, ...]) -> None:
    """Refuse a user's quantities that are not float64 series, and names that are taken."""
    check_names(quantities, "arrays")
    for name, values in quantities.items():
        if not isinstance(values, np.ndarray) or values.dtype != np.float64:
            raise ParameterError(f"quantity {name!r} must be an array of float64")
        if values.shape != times:
            raise ParameterError(f"quantity {name!r} has shape {values.shape}, expected {times}")


def read_only(recording_fields: Mapping[str, Any]) -> dict[str, Any]:
    """Return those fields of a recording that hold arrays, as read-only views."""
    present = (name for name in (*ARRAYS, *OPTIONAL) if recording_fields[name] is not None)
    views: dict[str, Any] = {name: _read_only_view(recording_fields[name]) for name in present}
    if (contacts := recording_fields["contacts"]) is not None:
        columns = (_read_only_view(getattr(contacts, column.name)) for column in fields(contacts))
        views["contacts"] = type(contacts)(*columns)
    views["order"] = OrderSeries(*map(_read_only_view, recording_fields["order"].columns()))
    quantities = recording_fields["quantities"].items()
    views["quantities"] = {name: _read_only_view(values) for name, values in quantities}
    return views


def _read_only_view(array: NDArray[Any]) -> NDArray[Any]:
    view = array.view()
    view.flags.writeable = False
    return view
