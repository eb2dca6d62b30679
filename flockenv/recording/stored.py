"""The file of a recording: its arrays."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv.errors import ParameterError
from flockenv.flock import ContactSeries
from flockenv.order import ORDER, OrderSeries
from flockenv.parameters import FlockParameters
from flockenv.recording.checks import CONTACTS, PRECISIONS, TIMES, check_array

ARRAYS = (*TIMES, "pose", "velocity")
OPTIONAL = ("rudder", "ids")
"""Arrays that a recording may lack."""

FORMAT = "flockenv recording 1"
"""What the file of a recording says that it is."""

_OWN = "quantity_"


def arrays_of(fields: Mapping[str, Any]) -> dict[str, NDArray[Any]]:
    """Return the arrays of the file of a recording with these fields, by name."""
    arrays = {name: fields[name] for name in ARRAYS}
    arrays |= {f"order_{name}": getattr(fields["order"], name) for name in ORDER}
    arrays |= {f"{_OWN}{name}": values for name, values in fields["quantities"].items()}
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
    """Return the fields of a recording from all arrays of its file."""
    texts = ("format", "version", "parameters", "policy")
    expected = {*ARRAYS, *(f"order_{name}" for name in ORDER), *texts, "seed", "duration_s"}
    own = [name for name in arrays if name.startswith(_OWN)]
    expected |= ({*OPTIONAL} & arrays.keys()) | {*own}
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
    if form != FORMAT:
        raise ParameterError(f"format = {form!r} is not accepted: {FORMAT!r}")
    contacts = (arrays[f"contacts_{name}"] for name in CONTACTS) if has_contacts else None
    return {
        **{name: arrays[name] for name in ARRAYS},
        "order": OrderSeries(*(arrays[f"order_{name}"] for name in ORDER)),
        "parameters": FlockParameters.from_toml(stored),
        "seed": int(arrays["seed"]),
        "version": version,
        "policy": policy or None,
        "quantities": {name.removeprefix(_OWN): arrays[name] for name in own},
        "duration_s": float(arrays["duration_s"]),
        **{name: arrays.get(name) for name in OPTIONAL},
        "contacts": None if contacts is None else ContactSeries(*contacts),
    }
