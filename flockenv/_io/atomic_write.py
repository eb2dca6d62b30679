"""Files that are written whole or not at all."""

import glob
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from flockenv._io.locks import hold

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["atomic_write", "write_csv", "write_text"]

# File systems take names of 255 bytes; the temporary one is longer by its marks.
_LONGEST_STEM = 200


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a file for writing bytes: a temporary one beside it, renamed where all went well.

    Temporary files of writers that were killed are removed; those that a living writer holds stay.

    Raises
    ------
    OSError
        If the file cannot be written; what was there before is still there.
    """
    target = Path(path)
    stem = os.fsdecode(os.fsencode(f".{target.name}")[:_LONGEST_STEM])
    _remove_abandoned(target.parent, stem)
    file, temporary = _opened(target.parent, stem)
    try:
        with file:
            yield file
            file.flush()
            os.fsync(file.fileno())
            if os.name == "posix":  # While it is held: once it is closed it looks abandoned.
                temporary.replace(target)
        if os.name != "posix":
            temporary.replace(target)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _opened(folder: Path, stem: str) -> tuple[IO[bytes], Path]:
    """Open a new temporary file and hold it, so that nobody takes it for abandoned."""
    while True:
        temporary = folder / f"{stem}.{secrets.token_hex(4)}.tmp"
        file = temporary.open("xb")
        with suppress(OSError):  # Some file systems have no locks.
            hold(file)
        # Between the two steps above another writer may have removed it.
        if temporary.exists():
            return file, temporary
        file.close()


def _remove_abandoned(folder: Path, stem: str) -> None:
    marks = "[0-9a-f]" * 8
    for abandoned in folder.glob(f"{glob.escape(stem)}.{marks}.tmp"):
        # What cannot be opened or removed does not keep this file from being written.
        with suppress(OSError), abandoned.open("rb+") as file:
            if hold(file):
                abandoned.unlink()


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text to a file as UTF-8, whole or not at all.

    Raises
    ------
    OSError
        If the file cannot be written; what was there before is still there.
    """
    with atomic_write(path) as file:
        file.write(text.encode())


def write_csv(path: str | os.PathLike[str], table: "pd.DataFrame", **options: Any) -> None:
    """Write a table without its index to a CSV file, with the same bytes on every system.

    Parameters
    ----------
    path
        The file, written whole or not at all.
    table
        What to write.
    options
        As of ``to_csv``.

    Raises
    ------
    OSError
        If the file cannot be written; what was there before is still there.
    """
    write_text(path, table.to_csv(index=False, lineterminator="\n", **options))
