"""Named arrays in an ``.npz`` file, written whole or not at all, and read without trust.

NumPy's own reader allocates what a file's headers claim before it reads the data, and raises
some ten kinds of exceptions for damaged files. Here sizes are checked first and there is one kind.
"""

import math
import os
import stat
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from flockenv._io.atomic_write import atomic_write
from flockenv._io.interrupts import held_interrupts
from flockenv.errors import ParameterError

__all__ = ["is_special", "read_arrays", "write_arrays"]

_MOST_BYTES = 16 << 30
# What is compressed better than anything measured may not fill the memory with it.
_MOST_INFLATED_BYTES, _INFLATED_RATIO = 1 << 28, 20
# Deflate cannot do better; an entry that claims more is a lie that would fill the memory.
_HIGHEST_RATIO = 1100


def write_arrays(
    path: str | os.PathLike[str], arrays: Mapping[str, NDArray[Any]], *, compressed: bool = False
) -> None:
    """Write arrays to a file, by way of a temporary file beside it that is then renamed.

    A Ctrl-C acts when the file is written.

    Raises
    ------
    OSError
        If the file cannot be written; what was there before is still there.
    """
    save = np.savez_compressed if compressed else np.savez
    with held_interrupts(), atomic_write(path) as file:
        save(file, allow_pickle=False, **dict(arrays))
        if compressed and _inflates(sum(array.nbytes for array in arrays.values()), file.tell()):
            # Constants compress beyond what is read again.
            file.seek(0)
            file.truncate()
            np.savez(file, allow_pickle=False, **dict(arrays))


def is_special(path: str | os.PathLike[str]) -> bool:
    """Return whether a path is a device, a pipe or a socket, which may be without end.

    Raises
    ------
    OSError
        If there is no such file.
    """
    mode = os.stat(path).st_mode
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def read_arrays(
    path: str | os.PathLike[str], most_bytes: int = _MOST_BYTES
) -> dict[str, NDArray[Any]]:
    """Read all arrays of a file; nothing in it is ever executed.

    Parameters
    ----------
    path
        The file.
    most_bytes
        What all arrays together may hold.

    Raises
    ------
    OSError
        If the file cannot be opened.
    ParameterError
        If it is no ``.npz`` file of plain numbers and strings, cut off, damaged or too large.
    """
    if is_special(path):
        raise ParameterError(f"{path} is no .npz file but a device, a pipe or a socket")
    with Path(path).open("rb") as file:
        try:
            return _read(file, most_bytes)
        except Exception as error:
            # zipfile, zlib and NumPy's header parser raise very different things for damaged bytes.
            reason = str(error) or type(error).__name__
            raise ParameterError(f"{path} is no whole, unharmed .npz file: {reason}") from error


def _read(file: IO[bytes], most_bytes: int) -> dict[str, NDArray[Any]]:
    arrays: dict[str, NDArray[Any]] = {}
    with zipfile.ZipFile(file) as archive:
        claimed = sum(entry.file_size for entry in archive.infolist())
        size = file.seek(0, os.SEEK_END)
        if claimed > most_bytes or _inflates(claimed, size):
            raise ValueError(f"its {size} bytes claim to hold {claimed} bytes of data")
        for entry in archive.infolist():
            name = entry.filename.removesuffix(".npy")
            if name in arrays:
                raise ValueError(f"{name} is there twice")
            arrays[name] = _read_entry(archive, entry)
    return arrays


def _inflates(held: int, size: int) -> bool:
    """Return whether a file of this size holds too many bytes for what it takes."""
    return held > max(_MOST_INFLATED_BYTES, _INFLATED_RATIO * size)


def _read_entry(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> NDArray[Any]:
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ValueError(f"{entry.filename} is compressed in an unknown way")
    if entry.file_size > _HIGHEST_RATIO * (entry.compress_size + 1):
        raise ValueError(f"{entry.filename} claims more data than it can hold")
    with archive.open(entry) as data:
        shape, fortran_order, dtype = _read_header(data)
        size = entry.file_size - data.tell()
        if math.prod(shape) * dtype.itemsize != size:
            raise ValueError(f"{entry.filename} has a shape that does not match its size")
        numbers = data.read()
    array = np.frombuffer(numbers, dtype).reshape(shape, order="F" if fortran_order else "C")
    return array.astype(dtype.newbyteorder("="), order="C")


def _read_header(data: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    version = npy.read_magic(data)
    readers = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
    shape, fortran_order, dtype = readers[version](data)
    if dtype.kind not in "biufU" or min(shape, default=0) < 0:
        raise ValueError(f"an array of {dtype} and shape {shape} is not accepted")
    return shape, fortran_order, dtype
