"""Named arrays in an ``.npz`` file, written completely or not at all, and checked when read."""

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

_MOST_BYTES = 16 << 30
_MOST_HEADER_BYTES = 256  # NumPy writes 128 bytes before an array of a plain dtype.
_MOST_EXPANSION, _FREE_BYTES = 100, 64 << 20


def most_content(size: int) -> int:
    """Return the largest accepted size of a file's decompressed content, given the file's size.

    Sizes are in bytes. Compression shrinks the numbers of a run tenfold at most, so a file that
    expands much more was made to fill the memory, or holds little but zeros.
    """
    return min(_MOST_BYTES, max(_FREE_BYTES, _MOST_EXPANSION * size))


def write_arrays(
    path: str | os.PathLike[str], arrays: Mapping[str, NDArray[Any]], *, compressed: bool = False
) -> None:
    """Write arrays to a file, as `atomic_write` does.

    If compression would make the file so small that `read_arrays` would refuse it, the arrays are
    not compressed.
    """
    content_bytes = sum(array.nbytes + _MOST_HEADER_BYTES for array in arrays.values())
    with atomic_write(path) as file:
        if compressed:
            np.savez_compressed(file, allow_pickle=False, **dict(arrays))
        if not compressed or content_bytes > most_content(file.tell()):
            file.seek(0)
            file.truncate()
            np.savez(file, allow_pickle=False, **dict(arrays))


def read_arrays(
    path: str | os.PathLike[str], most_bytes: int | None = None
) -> dict[str, NDArray[Any]]:
    """Read all arrays of a file; nothing in it is ever executed.

    Raises ParameterError, which names the file, if it is not an ``.npz`` file of plain numbers and
    strings, if it is cut off or damaged, or if its arrays hold more than `most_bytes` together. The
    default is a hundred times the file's size, but at least 64 MiB and at most 16 GiB.
    """
    with open_plain(path) as file:
        most = most_bytes or most_content(os.fstat(file.fileno()).st_size)
        try:
            with zipfile.ZipFile(file) as archive:
                content_bytes = sum(entry.file_size for entry in archive.infolist())
                if content_bytes > most:
                    raise ValueError(f"it holds {content_bytes} bytes of {most} that are accepted")
                return _arrays_in(archive)
        except Exception as error:
            # zipfile, zlib and NumPy raise errors of unrelated classes for damaged bytes.
            reason = str(error) or type(error).__name__
            raise ParameterError(
                f"{path} is not a complete, undamaged .npz file: {reason}"
            ) from error


def _arrays_in(archive: zipfile.ZipFile) -> dict[str, NDArray[Any]]:
    """Return the arrays of an archive by name; raise ValueError for a wrong or repeated array."""
    arrays: dict[str, NDArray[Any]] = {}
    for entry in archive.infolist():
        name = entry.filename.removesuffix(".npy")
        if name in arrays:
            raise ValueError(f"it holds {name!r} twice")
        # The entry is read to its end, since only then zipfile compares the checksum. The limit to
        # its declared size keeps a false declaration from filling the memory.
        with archive.open(entry) as stream:
            data = stream.read(entry.file_size)
        arrays[name] = np.lib.format.read_array(io.BytesIO(data), allow_pickle=False)
        if arrays[name].dtype.kind not in "biufU":
            raise ValueError(f"{name} must not hold {arrays[name].dtype}")
    return arrays
