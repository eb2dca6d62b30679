"""What a recording's arrays must be."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from flockenv import _core
from flockenv.errors import ParameterError, shown
from flockenv.flock import ContactSeries
from flockenv.order import QUANTITIES
from flockenv.parameters import FlockParameters

PHASES = np.array(_core.PHASES)
TIMES = ("time_s", "phase", "in_analysis_window")
PRECISIONS = (np.dtype(np.float64), np.dtype(np.float32))
CONTACTS = ("count", "i", "j", "normal", "force", "point_cm", "along_cm")
"""The arrays of a `ContactSeries`, in its order."""


def check_array(
    name: str,
    array: Any,
    shape: tuple[int, ...],
    dtypes: tuple[np.dtype[Any], ...],
    *,
    all_nan: bool = False,
    gaps: bool = False,
) -> None:
    """Refuse anything else than an array of a shape and dtype, finite, all NaN or with gaps."""
    if not isinstance(array, np.ndarray) or array.dtype not in dtypes:
        found = array.dtype if isinstance(array, np.ndarray) else type(array).__name__
        raise ParameterError(f"{name} is of {found}, expected an array of {dtypes[0]}")
    if array.shape != shape:
        raise ParameterError(f"{name} has shape {array.shape}, expected {shape}")
    if gaps:
        absent = np.isnan(array)
        rows = absent.any(axis=-1) != absent.all(axis=-1) if array.ndim == 3 else np.zeros(1, bool)
        if np.isinf(array).any() or rows.any():
            raise ParameterError(f"{name} must be finite, but for boats that are not there")
    elif array.dtype.kind == "f" and not (np.isnan if all_nan else np.isfinite)(array).all():
        raise ParameterError(f"{name} must be {'undefined (NaN)' if all_nan else 'finite'}")


def check_ids(ids: Any, boats: int) -> None:
    """Refuse names that are not as many as boats, or not different."""
    if not isinstance(ids, np.ndarray) or ids.dtype.kind != "U" or ids.shape != (boats,):
        raise ParameterError(f"ids must be an array of str of shape ({boats},)")
    if len(set(ids.tolist())) != boats:
        raise ParameterError("ids must differ from each other")


def check_quantities(quantities: Any, times: tuple[int, ...]) -> None:
    """Refuse quantities of a user's own that are no series, or whose names are taken."""
    if not isinstance(quantities, Mapping):
        raise ParameterError(f"quantities = {shown(quantities)} is not accepted: arrays by name")
    taken = {each.name for each in QUANTITIES} | {*TIMES, "boat", "id", "is_leader"}
    for name, values in quantities.items():
        if not isinstance(name, str) or not name.isidentifier() or name in taken:
            raise ParameterError(
                f"quantity {shown(name)} is not accepted: an identifier that no quantity or column "
                "of recordings has"
            )
        if not isinstance(values, np.ndarray) or values.dtype != np.float64:
            raise ParameterError(f"quantity {name!r} must be an array of float64")
        if values.shape != times:
            raise ParameterError(f"quantity {name!r} has shape {values.shape}, expected {times}")


def check_contacts(contacts: ContactSeries, samples: int, parameters: FlockParameters) -> None:
    """Refuse contacts that are not those of so many samples of a flock with these parameters."""
    c = len(contacts.i) if np.ndim(contacts.i) else 0
    shapes = {"count": (samples,), "normal": (c, 2), "point_cm": (c, 2)}
    dtypes = {"count": np.int64, "i": np.int32, "j": np.int32}
    for name in CONTACTS:
        array: Any = getattr(contacts, name)
        shape, dtype = shapes.get(name, (c,)), dtypes.get(name, np.float32)
        if not isinstance(array, np.ndarray) or array.dtype != dtype or array.shape != shape:
            raise ParameterError(
                f"contacts.{name} must be an array of {np.dtype(dtype)}, shape {shape}"
            )
        if not np.isfinite(array).all():
            raise ParameterError(f"contacts.{name} must be finite")
    count = contacts.count
    if (count < 0).any() or (count > c).any() or count.sum() != c:
        raise ParameterError(f"contacts.count must add up to the {c} contacts there are")
    boats, obstacles = parameters.n_boats, len(parameters.discs) + len(parameters.walls)
    pairs = np.concatenate([contacts.i, contacts.j])
    if c and (contacts.i.min() < 0 or pairs.min() < -2 - obstacles or pairs.max() >= boats):
        raise ParameterError(f"contacts.i and contacts.j must be among {boats} boats")
    if not (contacts.force > 0).all():
        raise ParameterError("contacts.force must be positive")
