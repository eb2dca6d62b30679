"""Files that are written completely or not at all."""

import atexit
import importlib
import os
import re
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import ModuleType
from typing import IO, TYPE_CHECKING

from flockenv._io.plain_file import check_writable

if TYPE_CHECKING:
    import pandas as pd

fcntl: ModuleType | None
try:
    fcntl = importlib.import_module("fcntl")
except ImportError:  # On Windows an open file can be neither renamed nor removed.
    fcntl = None

_TEMPORARY_NAME = re.compile(r"\.[0-9a-f]{16}\.tmp")

_temporary: set[Path] = set()
"""Temporary files of this process; each is listed before it is created."""


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a temporary file for writing bytes, and rename it to the path if the block succeeds.

    Otherwise the temporary file is removed when the block ends, or when Python ends; only a killed
    process leaves it behind. The new file gets the mode of the old one. A link stays a link, and
    the file that it names is replaced. Raises OSError if the file cannot be written; the old file
    is then unchanged. Raises ParameterError if the path is a device, a pipe or a socket.
    """
    check_writable(path)
    target = Path(os.path.realpath(path))
    try:
        temporary, file = _locked_file(target.parent)
    except OSError as error:  # The user knows the path, but not the temporary file.
        error.filename = os.fspath(path)
        raise
    try:
        with file:
            _copy_mode(target, file)
            yield file
            file.flush()
            os.fsync(file.fileno())
            if fcntl is not None:
                temporary.replace(target)
        if fcntl is None:
            temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)
        _temporary.discard(temporary)


def _locked_file(folder: Path) -> tuple[Path, IO[bytes]]:
    """Return the path of a new temporary file, and the file.

    It is locked, so that no other process removes it as a leftover.
    """
    while True:
        temporary = folder / f".{secrets.token_hex(8)}.tmp"
        _temporary.add(temporary)
        try:
            file = temporary.open("xb")
        except BaseException:
            temporary.unlink(missing_ok=True)
            _temporary.discard(temporary)
            raise
        has_lock = _try_lock(file)
        still_exists = os.fstat(file.fileno()).st_nlink > 0
        if has_lock is not False and still_exists:
            return temporary, file
        # Another process removed the file as a leftover before it was locked.
        file.close()
        _temporary.discard(temporary)


def _copy_mode(target: Path, file: IO[bytes]) -> None:
    """Give a new, empty file the mode of the one that it will replace."""
    if fcntl is None or not target.exists():
        return
    old, new = target.stat(), os.fstat(file.fileno())
    if (old.st_uid, old.st_gid) != (new.st_uid, new.st_gid):
        with suppress(OSError):  # Only root may change a file's owner.
            os.fchown(file.fileno(), old.st_uid, old.st_gid)
    os.fchmod(file.fileno(), stat.S_IMODE(old.st_mode))


def _try_lock(file: IO[bytes]) -> bool | None:
    """Try to lock a file until it is closed, and return whether that succeeded.

    False means that another process has the lock, None that the system has no locks.
    """
    if fcntl is None:
        return None
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True


def remove_leftovers(folder: str | os.PathLike[str], *, recursive: bool = False) -> None:
    """Remove the temporary files of killed processes from a folder.

    With `recursive` its subfolders are searched, too. Files that a process still writes are kept.
    """
    paths = Path(folder).rglob(".*.tmp") if recursive else Path(folder).glob(".*.tmp")
    for path in paths:
        if _TEMPORARY_NAME.fullmatch(path.name) is None:
            continue
        try:
            with path.open("rb") as file:
                if _try_lock(file):  # No process writes it any more.
                    path.unlink(missing_ok=True)
        except OSError:
            continue  # It was just renamed to its final name, or belongs to another user.


@atexit.register
def remove_temporary_files() -> None:
    """Remove the temporary files of unfinished writing before the process ends."""
    for path in tuple(_temporary):
        with suppress(OSError):  # If one cannot be removed, go on with the next.
            path.unlink(missing_ok=True)


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text to a file as UTF-8, as `atomic_write` does."""
    with atomic_write(path) as file:
        file.write(text.encode())


def write_csv(
    path: str | os.PathLike[str], table: "pd.DataFrame", *, float_format: str | None = None
) -> None:
    """Write a table without its index to a CSV file, with the same bytes on every system.

    `float_format` is that of ``to_csv``. The file is written as `atomic_write` does.
    """
    text = table.to_csv(index=False, lineterminator="\n", float_format=float_format)
    write_text(path, text)
