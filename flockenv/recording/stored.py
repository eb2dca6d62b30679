"""The file of a recording: its arrays by name.

Files of other builds can be read even if they have more or fewer quantities, parameters or arrays.
A missing quantity is computed from the poses; without poses it is NaN, with a warning. An unknown
array is dropped with a warning.
"""

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import fields as dataclass_fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.toml import read_toml
from flockenv.errors import ParameterError
from flockenv.flock import ContactSeries, StepStatistics
from flockenv.order import ORDER, OrderSeries, order_series
from flockenv.parameters import FlockParameters
from flockenv.recording.checks import CONTACTS, ORIGIN, PRECISIONS, TIMES, check_array

ARRAYS = (*TIMES, "pose", "velocity")
OPTIONAL = ("rudder", "ids")
"""Arrays that a recording may lack."""

FORMAT = "flockenv recording 1"
"""The format named in a recording's file."""

_QUANTITY_PREFIX = "quantity_"
_STATISTIC_PREFIX = "statistics_"
"""Prefixes of the names of arrays that hold user-defined quantities and step statistics."""

_TEXTS = ("format", "version", "parameters", "policy")
_DROPPED = "has {} that this flockenv does not know, and does not keep"
_UNDEFINED = "has no poses, from which these quantities would be computed, and they are NaN"


class RecordingWarning(UserWarning):
    """A recording's file has more or fewer arrays than this flockenv knows; it was read anyway."""


class LayoutError(ParameterError):
    """An undamaged recording lacks an array that cannot be computed, or has another format."""


def arrays_of(fields: Mapping[str, Any]) -> dict[str, NDArray[Any]]:
    """Return the arrays by name that a recording's file holds for the recording's fields."""
    arrays = {name: fields[name] for name in ARRAYS}
    arrays |= {f"order_{name}": getattr(fields["order"], name) for name in ORDER}
    arrays |= {f"{_QUANTITY_PREFIX}{name}": values for name, values in fields["quantities"].items()}
    arrays |= {name: fields[name] for name in OPTIONAL if fields[name] is not None}
    if fields["contacts"] is not None:
        arrays |= {f"contacts_{name}": getattr(fields["contacts"], name) for name in CONTACTS}
    if (statistics := fields["statistics"]) is not None:
        arrays |= {
            f"{_STATISTIC_PREFIX}{name}": np.array(value)
            for name, value in vars(statistics).items()
        }
    texts = {
        "format": FORMAT,
        "version": fields["version"],
        "parameters": fields["parameters"].to_toml(),
        "policy": fields["policy"] or "",
    }
    arrays |= {name: np.array(text) for name, text in texts.items()}
    present = {name: dtype for name, dtype in ORIGIN.items() if fields[name] is not None}
    arrays |= {name: np.array(fields[name], dtype) for name, dtype in present.items()}
    arrays["seed"] = np.array(fields["seed"], np.uint64)
    arrays["duration_s"] = np.array(fields["duration_s"], np.float64)
    return arrays


def fields_from(arrays: dict[str, NDArray[Any]]) -> dict[str, Any]:
    """Return a recording's fields from the arrays of its file."""
    file_format = arrays.get("format")
    if file_format is not None and str(file_format) != FORMAT:
        raise LayoutError(f"format = {str(file_format)!r} is not accepted: {FORMAT!r}")
    needed = [*ARRAYS, *_TEXTS, "seed", "duration_s"]
    contact_names = [f"contacts_{name}" for name in CONTACTS]
    has_contacts = not arrays.keys().isdisjoint(contact_names)
    needed += contact_names if has_contacts else []
    if missing := [name for name in needed if name not in arrays]:
        raise LayoutError(f"these arrays are missing: {', '.join(missing)}")
    quantities = [name for name in arrays if name.startswith(_QUANTITY_PREFIX)]
    statistics = {
        statistic.name: f"{_STATISTIC_PREFIX}{statistic.name}"
        for statistic in dataclass_fields(StepStatistics)
    }
    orders = [f"order_{name}" for name in ORDER]
    known = {*needed, *orders, *OPTIONAL, *quantities, *statistics.values(), *ORIGIN}
    _warn_of(_DROPPED.format("arrays"), arrays.keys() - known)
    if any(arrays[name].ndim or arrays[name].dtype.kind != "U" for name in _TEXTS):
        raise ParameterError(f"{', '.join(_TEXTS)} must each be one string")
    check_array("seed", arrays["seed"], (), (np.dtype(np.uint64),))
    check_array("duration_s", arrays["duration_s"], (), PRECISIONS[:1])
    version, stored, policy = (str(arrays[name]) for name in _TEXTS[1:])
    parameters = _parameters(stored)
    contacts = (arrays[name] for name in contact_names) if has_contacts else None
    return {
        **{name: arrays[name] for name in ARRAYS},
        "order": _order(arrays, parameters),
        "parameters": parameters,
        "seed": int(arrays["seed"]),
        **_origin(arrays),
        "version": version,
        "policy": policy or None,
        "quantities": {name.removeprefix(_QUANTITY_PREFIX): arrays[name] for name in quantities},
        "duration_s": float(arrays["duration_s"]),
        **{name: arrays.get(name) for name in OPTIONAL},
        "contacts": None if contacts is None else ContactSeries(*contacts),
        "statistics": _statistics(arrays, statistics),
    }


def _origin(arrays: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
    """Return the noise seed, the rate and the digests of a run; None for each that is missing."""
    origin: dict[str, Any] = dict.fromkeys(ORIGIN)
    for name in ORIGIN.keys() & arrays.keys():
        array, dtype = arrays[name], ORIGIN[name]
        if array.ndim or array.dtype.kind != dtype.kind:
            raise ParameterError(f"{name} must be one {dtype.type.__name__.rstrip('_')}")
        origin[name] = array.item()
    return origin


def _statistics(
    arrays: Mapping[str, NDArray[Any]], names: Mapping[str, str]
) -> StepStatistics | None:
    """Return the run's step statistics; None if the file lacks one of them.

    `names` holds the name of the array by field of `StepStatistics`.
    """
    if not all(name in arrays for name in names.values()):
        return None
    for name in names.values():
        if arrays[name].ndim or arrays[name].dtype.kind not in "iuf":
            raise ParameterError(f"{name} must be one number")
    return StepStatistics(**{field: arrays[name].item() for field, name in names.items()})


def _warn_of(problem: str, names: Iterable[str]) -> None:
    """Warn that a recording has a problem with the named arrays or parameters, if there are any."""
    # Python prints the same text only once, and a sweep may read thousands of such files.
    if listed := ", ".join(sorted(names)):
        warnings.warn(f"the recording {problem}: {listed}", RecordingWarning, stacklevel=5)


def _parameters(toml: str) -> FlockParameters:
    """Return the parameters in a text; unknown ones are dropped with a warning."""
    values = read_toml(toml, "the text of parameters")
    known = FlockParameters.__dataclass_fields__
    _warn_of(_DROPPED.format("parameters"), values.keys() - known.keys())
    return FlockParameters(**{name: value for name, value in values.items() if name in known})


def _order(arrays: Mapping[str, NDArray[Any]], parameters: FlockParameters) -> OrderSeries:
    """Return the order parameters; those that the file lacks follow from poses, or are NaN."""
    stored = {name: arrays[f"order_{name}"] for name in ORDER if f"order_{name}" in arrays}
    if missing := [name for name in ORDER if name not in stored]:
        pose, velocity = arrays["pose"], arrays["velocity"]
        n_leaders, undefined = parameters.n_leaders, np.full(arrays["time_s"].size, np.nan)
        # Poses of other shapes are refused later, by the recording.
        if pose.ndim == 3 and pose.shape == velocity.shape and pose.shape[1] > n_leaders:
            computed = order_series(pose[:, n_leaders:], velocity[:, n_leaders:])
            stored |= {name: getattr(computed, name) for name in missing}
        else:
            _warn_of(_UNDEFINED, (f"order_{name}" for name in missing))
            stored |= dict.fromkeys(missing, undefined)
    return OrderSeries(**stored)
