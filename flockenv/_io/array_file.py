"""Named arrays in an ``.npz`` file, written whole or not at all, and read without trust."""

import io
import os
import zipfile
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.atomic_write import atomic_write
from flockenv._io.plain_file import open_plain
from flockenv.errors import ParameterError

MOST_BYTES = 16 << 30
"""What all arrays of a file may hold together, if nothing else is said."""


def write_arrays(
    path: str | os.PathLike[str], arrays: Mapping[str, NDArray[Any]], *, compressed: bool = False
) -> None:
    """Write arrays to a file, as `atomic_write` does."""
    save = np.savez_compressed if compressed else np.savez
    with atomic_write(path) as file:
        save(file, allow_pickle=False, **dict(arrays))


def read_arrays(
    path: str | os.PathLike[str], most_bytes: int | None = None
) -> dict[str, NDArray[Any]]:
    """Read all arrays of a file; nothing in it is ever executed.

    A ParameterError names a file that is no ``.npz`` file of plain numbers and strings, is cut off
    or damaged, or whose arrays hold more than `most_bytes` together.
    """
    most = MOST_BYTES if most_bytes is None else most_bytes
    with open_plain(path) as file:
        try:
            with zipfile.ZipFile(file) as archive:
                held = sum(entry.file_size for entry in archive.infolist())
                if held > most:
                    raise ValueError(f"it holds {held} bytes of {most} that are accepted")
                # Whole entries, whose checksums are compared; NumPy alone may stop before the end.
                parts = [(each.filename, archive.read(each)) for each in archive.infolist()]
            arrays: dict[str, NDArray[Any]] = {}
            for path_within, data in parts:
                name = path_within.removesuffix(".npy")
                if name in arrays:
                    raise ValueError(f"it holds {name!r} twice")
                array = np.lib.format.read_array(io.BytesIO(data), allow_pickle=False)
                arrays[name] = array
                if array.dtype.kind not in "biufU":
                    raise ValueError(f"{name} must not hold {array.dtype}")
        except Exception as error:
            # zipfile, zlib and NumPy raise very different things for damaged bytes.
            reason = str(error) or type(error).__name__
            raise ParameterError(f"{path} is no whole, unharmed .npz file: {reason}") from error
    return arrays
