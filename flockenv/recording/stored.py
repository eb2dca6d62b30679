"""The file of a recording: its arrays, and the formats that earlier versions wrote."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv.errors import ParameterError
from flockenv.flock import ContactSeries, OrderSeries
from flockenv.parameters import FlockParameters
from flockenv.recording.checks import CONTACTS, PRECISIONS, check_array
from flockenv.recording.order import ORDER

__all__ = ["ARRAYS", "FORMAT", "OPTIONAL", "TIMES", "arrays_of", "fields_from"]

TIMES = ("time_s", "phase", "in_analysis_window")
ARRAYS = (*TIMES, "pose", "velocity")
OPTIONAL = ("rudder", "ids")
"""Arrays that a recording may lack."""

FORMAT = "flockenv recording 3"
"""What the file of a recording says that it is."""

# Format 1 held Section 3.2's six order parameters, and neither the policy nor the duration; later
# files hold the quantities that were recorded at the time. Format 2 held no rudders.
_FIRST_FORMAT = "flockenv recording 1"
_SECOND_FORMAT = "flockenv recording 2"
_FIRST_ORDER = ("psi_o", "phi_o", "c_o", "psi_v", "phi_v", "c_v")


def arrays_of(fields: Mapping[str, Any]) -> dict[str, NDArray[Any]]:
    """Return the arrays of the file of a recording with these fields, by name."""
    arrays = {name: fields[name] for name in ARRAYS}
    arrays |= {f"order_{name}": getattr(fields["order"], name) for name in ORDER}
    arrays |= {name: fields[name] for name in OPTIONAL if fields[name] is not None}
    if fields["contacts"] is not None:
        arrays |= {f"contacts_{name}": getattr(fields["contacts"], name) for name in CONTACTS}
    texts = {
        "format": FORMAT,
        "version": fields["version"],
        "parameters": fields["parameters"].to_toml(),
        "policy": fields["policy"] or "",
    }
    arrays |= {name: np.array(text) for name, text in texts.items()}
    arrays["seed"] = np.array(fields["seed"], np.uint64)
    arrays["duration_s"] = np.array(fields["duration_s"], np.float64)
    return arrays


def fields_from(arrays: dict[str, NDArray[Any]]) -> dict[str, Any]:
    """Return the fields of the recording that a file's arrays hold, of this version or before.

    Raises
    ------
    ParameterError
        For arrays that are missing, unknown or of another format.
    """
    if str(arrays.get("format")) == _FIRST_FORMAT:
        last = arrays.get("time_s", np.zeros(1))[-1:].astype(np.float64).sum()
        added = {"policy": np.array(""), "duration_s": np.array(last)}
        arrays = {**added, **arrays, "format": np.array(_SECOND_FORMAT)}
    texts = ("format", "version", "parameters", "policy")
    order = [name for name in ORDER if name in _FIRST_ORDER or f"order_{name}" in arrays]
    expected = {*ARRAYS, *(f"order_{name}" for name in order), *texts, "seed", "duration_s"}
    expected |= {*OPTIONAL} & arrays.keys()
    with_contacts = {f"contacts_{name}" for name in CONTACTS}
    has_contacts = not with_contacts.isdisjoint(arrays)
    expected |= with_contacts if has_contacts else set()
    if arrays.keys() != expected:
        different = ", ".join(sorted(arrays.keys() ^ expected))
        raise ParameterError(f"these arrays are missing or unknown: {different}")
    if any(arrays[name].ndim or arrays[name].dtype.kind != "U" for name in texts):
        raise ParameterError(f"{', '.join(texts)} must each be one string")
    check_array("seed", arrays["seed"], (), (np.dtype(np.uint64),))
    check_array("duration_s", arrays["duration_s"], (), PRECISIONS[:1])
    form, version, stored, policy = (str(arrays[name]) for name in texts)
    if form not in (_SECOND_FORMAT, FORMAT):
        raise ParameterError(f"format = {form!r} is not accepted: {FORMAT!r} or an earlier one")
    held = {name: arrays[f"order_{name}"] for name in order}
    parameters = FlockParameters.from_toml(stored)
    whole_order = _whole_order(held, [arrays["pose"], arrays["velocity"]], parameters)
    contacts = (arrays[f"contacts_{name}"] for name in CONTACTS) if has_contacts else None
    return {
        **{name: arrays[name] for name in ARRAYS},
        "order": whole_order,
        "parameters": parameters,
        "seed": int(arrays["seed"]),
        "version": version,
        "policy": policy or None,
        "duration_s": float(arrays["duration_s"]),
        **{name: arrays.get(name) for name in OPTIONAL},
        "contacts": None if contacts is None else ContactSeries(*contacts),
    }


def _whole_order(
    held: dict[str, NDArray[Any]],
    states: Sequence[NDArray[Any]],
    parameters: FlockParameters,
) -> OrderSeries:
    """Return the quantities that a file holds, and from its poses those that it lacks."""
    n = parameters.n_boats
    are_states = all(each.dtype in PRECISIONS and each.shape[1:] == (n, 3) for each in states)
    is_whole = len(held) == len(ORDER) or parameters.n_leaders == n
    if is_whole or not are_states or len(states[0]) != len(states[1]):
        return OrderSeries(**held)
    normal = slice(parameters.n_leaders, None)
    series = _core.order_series(*(each[:, normal].astype(np.float64) for each in states))
    return OrderSeries(**{name: held.get(name, getattr(series, name)) for name in ORDER})
