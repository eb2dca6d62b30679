"""Checks of a recording's arrays."""

import re
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv._io.arguments import number
from flockenv.errors import ParameterError, short_repr
from flockenv.flock import ContactSeries
from flockenv.order import RECORDED, OrderSeries
from flockenv.parameters import OBSTACLES, FlockParameters

PHASES = np.array(_core.PHASES)
TIMES = ("time_s", "phase", "in_analysis_window")
MOTION = {
    "x_cm": "cm",
    "y_cm": "cm",
    "heading_rad": "rad",
    "velocity_x_cm_s": "cm s-1",
    "velocity_y_cm_s": "cm s-1",
    "angular_velocity_rad_s": "rad s-1",
}
"""The columns of poses and velocities in tables, with their units."""
PRECISIONS = (np.dtype(np.float64), np.dtype(np.float32))
MOTION_BOUNDS = (-1e9, 1e9)
"""Bounds of a flock's poses and velocities."""
ORIGIN: dict[str, np.dtype[Any]] = {
    "noise_seed": np.dtype(np.uint64),
    "control_hz": np.dtype(np.float64),
    "start_sha256": np.dtype(np.str_),
    "schedule_sha256": np.dtype(np.str_),
}
"""Fields in which runs of the same parameters, seed and policy may differ; each may be None."""
CONTACTS = tuple(column.name for column in fields(ContactSeries))
"""The arrays of a `ContactSeries`, in its order."""


def check_array(
    name: str,
    array: object,
    shape: tuple[int, ...],
    dtypes: tuple[np.dtype[Any], ...],
    *,
    all_nan: bool = False,
    gaps: bool = False,
    bounds: tuple[float, float] | None = None,
) -> None:
    """Refuse a wrong shape or dtype, numbers out of bounds, and NaN where it is not allowed.

    With `gaps` NaN is allowed; in poses and velocities all three numbers of a boat must then be
    NaN. With `all_nan` every number of the array must be NaN.
    """
    if not isinstance(array, np.ndarray) or array.dtype not in dtypes:
        kind = array.dtype if isinstance(array, np.ndarray) else type(array).__name__
        raise ParameterError(f"{name} is of {kind}, expected an array of {dtypes[0]}")
    if array.shape != shape:
        raise ParameterError(f"{name} has shape {array.shape}, expected {shape}")
    if gaps:
        is_nan = np.isnan(array)
        has_partial_rows = array.ndim == 3 and (is_nan.any(axis=-1) != is_nan.all(axis=-1)).any()
        if np.isinf(array).any() or has_partial_rows:
            raise ParameterError(f"{name} must be finite, except for missing boats")
    elif array.dtype.kind == "f" and not (np.isnan if all_nan else np.isfinite)(array).all():
        raise ParameterError(f"{name} must be {'undefined (NaN)' if all_nan else 'finite'}")
    # Rounding of sums may exceed a bound slightly.
    if bounds and ((array < bounds[0] - 1e-6) | (array > bounds[1] + 1e-6)).any():
        raise ParameterError(f"{name} must be within {bounds[0]:g} and {bounds[1]:g}")


def check_times(time_s: NDArray[np.float64], duration_s: float) -> None:
    """Refuse times that do not increase from 0 s to the end of the run."""
    # Times are rounded to a nanosecond, so the last one may lie that much beyond the end.
    ascending_s = [0.0, *time_s[:1], *time_s[-1:], duration_s + 1e-9, 1e9 + 1e-3]
    if not (np.diff(time_s) > 0).all() or not (np.diff(ascending_s) >= 0).all():
        raise ParameterError(
            "time_s must increase from 0 on, not beyond duration_s, at most 1e9 s, and hold at "
            "least one time if duration_s is not given"
        )


def check_order(
    order: OrderSeries, times: tuple[int, ...], normal_boats: int, *, tracked: bool, posed: bool
) -> None:
    """Refuse series that are not finite, unless too few boats are present to define them.

    Without poses (`posed` is False) a series may be NaN at all times: the file lacked it.
    """
    for quantity in RECORDED:
        values = getattr(order, quantity.name)
        undefined = normal_boats < quantity.least_boats
        undefined |= not posed and bool(np.isnan(values).all())
        check_array(
            f"order.{quantity.name}",
            values,
            times,
            PRECISIONS[:1],
            gaps=tracked,
            all_nan=undefined,
            bounds=quantity.range,
        )


def check_seed(seed: object, name: str = "seed") -> None:
    """Refuse anything but a seed of a flock."""
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**64:
        raise ParameterError(
            f"{name} = {short_repr(seed)} is not accepted: an int from 0 to 2^64 - 1"
        )


def check_origin(origin: Mapping[str, Any]) -> None:
    """Refuse a noise seed, a rate or a digest that no run can have."""
    for name, value in origin.items():
        if value is None:
            continue
        if name == "noise_seed":
            check_seed(value, name)
        elif name == "control_hz":
            if not 0.0 < number(value, name) < np.inf:
                raise ParameterError(
                    f"{name} = {short_repr(value)} is not accepted: a positive rate"
                )
        elif not isinstance(value, str) or not re.fullmatch("[0-9a-f]{64}", value):
            raise ParameterError(
                f"{name} = {short_repr(value)} is not accepted: a SHA-256 of 64 hexadecimal digits"
            )


def check_share(after: object) -> None:
    """Refuse anything but a fraction of a run, a number from 0 to 1."""
    if not 0.0 <= number(after, "after") <= 1.0:
        raise ParameterError(f"after = {short_repr(after)} is not accepted: a share, 0 to 1")


def check_ids(ids: object, boats: int) -> None:
    """Refuse names unless each boat has its own."""
    if not isinstance(ids, np.ndarray) or ids.dtype.kind != "U" or ids.shape != (boats,):
        raise ParameterError(f"ids must be an array of str of shape ({boats},)")
    if len(set(ids.tolist())) != boats:
        raise ParameterError("ids must differ from each other")


def check_contacts(contacts: ContactSeries, samples: int, parameters: FlockParameters) -> None:
    """Refuse contacts that do not fit the number of samples or the flock's parameters."""
    total = len(contacts.i) if np.ndim(contacts.i) else 0
    shapes = {"count": (samples,), "normal": (total, 2), "point_cm": (total, 2)}
    dtypes = {"count": np.int64, "i": np.int32, "j": np.int32}
    for name in CONTACTS:
        array: object = getattr(contacts, name)
        shape, dtype = shapes.get(name, (total,)), dtypes.get(name, np.float32)
        if not isinstance(array, np.ndarray) or array.dtype != dtype or array.shape != shape:
            raise ParameterError(
                f"contacts.{name} must be an array of {np.dtype(dtype)}, shape {shape}"
            )
        if not np.isfinite(array).all():
            raise ParameterError(f"contacts.{name} must be finite")
    count = contacts.count
    if (count < 0).any() or (count > total).any() or count.sum() != total:
        raise ParameterError(f"contacts.count must add up to the {total} contacts there are")
    boats, obstacles = parameters.n_boats, sum(len(getattr(parameters, kind)) for kind in OBSTACLES)
    # Negative numbers in j stand for the two walls of the pool and the obstacles.
    bodies = np.concatenate([contacts.i, contacts.j])
    if total and (contacts.i.min() < 0 or bodies.min() < -2 - obstacles or bodies.max() >= boats):
        raise ParameterError(f"contacts.i and contacts.j must be among {boats} boats")
    if not (contacts.force > 0).all():
        raise ParameterError("contacts.force must be positive")
