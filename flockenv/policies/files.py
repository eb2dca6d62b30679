"""Learned policies in ``.npz`` files: a header that describes them, and plain arrays."""

import hashlib
import json
import os
from abc import abstractmethod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.array_file import write_arrays
from flockenv._io.npz_header import read_headed
from flockenv.envs.observation import observation_version
from flockenv.errors import ParameterError
from flockenv.policies.base import RowPolicy

__all__ = ["StoredPolicy", "read_policy"]

FORMAT = "flockenv policy 1"
"""First entry of every policy file."""

PROVENANCE = "made"
"""Key of the provenance in the header of a file."""

_LARGEST_FILE = 5 << 20


class StoredPolicy(RowPolicy):
    """A policy of rows that a file holds: a header and plain arrays."""

    @abstractmethod
    def _contents(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Return the header and the arrays."""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the policy to an ``.npz`` file, whole or not at all.

        Raises
        ------
        OSError
            If the file cannot be written; what was there before is still there.
        """
        header, arrays = self._contents()
        version = observation_version(header["observation"])
        whole = {"format": FORMAT, "observation_version": version, **header}
        write_arrays(path, {"header": np.array(json.dumps(whole, sort_keys=True)), **arrays})

    @property
    def digest(self) -> str:
        """The first digits of the SHA-256 of layout and numbers, whatever made them."""
        header, arrays = self._contents()
        plain = {name: value for name, value in header.items() if name != PROVENANCE}
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
