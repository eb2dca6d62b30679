"""Learned policies in ``.npz`` files: a header that describes them, and plain arrays."""

import hashlib
import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.array_file import write_arrays
from flockenv._io.npz_header import read_headed
from flockenv.envs.observation import OBSERVATION_VERSION
from flockenv.errors import ParameterError

__all__ = ["digest", "read_policy", "write_policy"]

FORMAT = "flockenv policy 1"
"""First entry of every policy file."""

_LARGEST_FILE = 5 << 20


def write_policy(
    path: str | os.PathLike[str], header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]
) -> None:
    """Write a policy's file, whole or not at all.

    Raises
    ------
    OSError
        If the file cannot be written; what was there before is still there.
    """
    whole = {"format": FORMAT, "observation_version": OBSERVATION_VERSION, **header}
    write_arrays(path, {"header": np.array(json.dumps(whole, sort_keys=True)), **arrays})


def digest(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> str:
    """Return the first digits of a policy's SHA-256, whatever its file says of its making."""
    plain = {name: value for name, value in header.items() if name != "made"}
    whole = hashlib.sha256(json.dumps(plain, sort_keys=True).encode())
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        whole.update(f"{name} {array.shape} {array.dtype.str}".encode() + array.tobytes())
    return f"sha256:{whole.hexdigest()[:12]}"


def read_policy(path: str | os.PathLike[str]) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return the header and the arrays of a policy's file; nothing in it is ever executed.

    Raises
    ------
    OSError
        If the file cannot be opened.
    ParameterError
        If it is no policy file, is damaged, or was made for another version of the observation.
    """
    if os.path.getsize(path) > _LARGEST_FILE:
        raise ParameterError(f"{path} is no policy: it is larger than {_LARGEST_FILE} bytes")
    return read_headed(path, "policy", FORMAT, most_bytes=_LARGEST_FILE)
