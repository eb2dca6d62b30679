"""User-defined quantities: functions of a recording, and their series by name."""

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


def check_names(quantities: object, of: str) -> None:
    """Refuse a user's quantities that are not a dictionary, and names that are taken."""
    if not isinstance(quantities, Mapping):
        raise ParameterError(f"quantities = {short_repr(quantities)} is not accepted: {of} by name")
    taken = {quantity.name for quantity in QUANTITIES} | {
        *TIMES,
        *MOTION,
        "boat",
        "id",
        "is_leader",
    }
    for name in quantities:
        if not isinstance(name, str) or not name.isidentifier() or name in taken:
            raise ParameterError(
                f"quantity {short_repr(name)} is not accepted: an identifier that no quantity or "
                "column of recordings has"
            )


def checked_functions(functions: Mapping[str, object]) -> dict[str, Callable[[Any], Any]]:
    """Return a user's functions by name, checked before the run that they are for."""
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


def own_series(
    functions: Mapping[str, Callable[[Any], object]], recording: object
) -> dict[str, NDArray[np.float64]]:
    """Evaluate a user's own quantities of a recording; each is an array, a number per sample."""
    checked = checked_functions(functions)
    return {name: _series(name, function, recording) for name, function in checked.items()}


def _series(name: str, function: Callable[[Any], object], recording: object) -> NDArray[np.float64]:
    try:
        values = function(recording)
    except Exception as error:  # The user's function may raise anything.
        raise ParameterError(
            f"quantity {name!r} failed: {type(error).__name__}: {error}"
        ) from error
    found = real_numbers(values, f"quantity {name!r}")
    with np.errstate(over="ignore"):
        doubles = np.ma.asarray(found.astype(np.float64))
    # Masked values are missing.
    series = np.ma.filled(doubles, np.nan).copy()
    if (np.isinf(series) & np.isfinite(np.ma.filled(found, 0))).any():
        raise ParameterError(f"quantity {name!r} is not accepted: numbers that fit float64")
    return series


def check_quantities(quantities: Mapping[str, object], times: tuple[int, ...]) -> None:
    """Refuse a user's quantities that are not series, and names that are taken."""
    check_names(quantities, "arrays")
    for name, values in quantities.items():
        if not isinstance(values, np.ndarray) or values.dtype != np.float64:
            raise ParameterError(f"quantity {name!r} must be an array of float64")
        if values.shape != times:
            raise ParameterError(f"quantity {name!r} has shape {values.shape}, expected {times}")


def read_only(of_recording: Mapping[str, Any]) -> dict[str, Any]:
    """Return a recording's fields that hold arrays, with their arrays made read-only."""
    present = (name for name in (*ARRAYS, *OPTIONAL) if of_recording[name] is not None)
    sealed: dict[str, Any] = {name: _sealed(of_recording[name]) for name in present}
    if (contacts := of_recording["contacts"]) is not None:
        columns = (_sealed(getattr(contacts, column.name)) for column in fields(contacts))
        sealed["contacts"] = type(contacts)(*columns)
    sealed["order"] = OrderSeries(*map(_sealed, of_recording["order"].columns()))
    own = of_recording["quantities"].items()
    return {**sealed, "quantities": {name: _sealed(values) for name, values in own}}


def _sealed(array: NDArray[Any]) -> NDArray[Any]:
    view = array.view()
    view.flags.writeable = False
    return view
