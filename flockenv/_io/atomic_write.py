"""Files that are written whole or not at all."""

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

_NAME = re.compile(r"\.[0-9a-f]{16}\.tmp")

# A name is registered before its file exists, so that no file is missed.
_temporary: set[Path] = set()


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a temporary file for writing bytes, renamed to the path if all goes well.

    It is removed when the block ends or, at the latest, when Python ends, unless the process is
    killed. The new file keeps the old one's mode. A link stays a link, and the file that it names
    is replaced. If the file cannot be written, an OSError is raised and the old file is still
    there. Raises ParameterError if the path is a device, a pipe or a socket.
    """
    check_writable(path)
    target = Path(os.path.realpath(path))
    try:
        temporary, file = _locked_file(target.parent)
    except OSError as error:  # The temporary file's name would tell a reader nothing.
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
    """Return a new temporary file, locked so that no process removes it as a leftover."""
    while True:
        temporary = folder / f".{secrets.token_hex(8)}.tmp"
        _temporary.add(temporary)
        try:
            file = temporary.open("xb")
        except BaseException:
            temporary.unlink(missing_ok=True)
            _temporary.discard(temporary)
            raise
        if _is_locked(file) is not False and os.fstat(file.fileno()).st_nlink > 0:
            return temporary, file
        # Before the file was locked, another process removed it as a leftover.
        file.close()
        _temporary.discard(temporary)


def _copy_mode(target: Path, file: IO[bytes]) -> None:
    """Give a new, empty file the mode of the one that it will replace."""
    if fcntl is None or not target.exists():
        return
    before, now = target.stat(), os.fstat(file.fileno())
    if (before.st_uid, before.st_gid) != (now.st_uid, now.st_gid):
        with suppress(OSError):  # Only root gives files away.
            os.fchown(file.fileno(), before.st_uid, before.st_gid)
    os.fchmod(file.fileno(), stat.S_IMODE(before.st_mode))


def _is_locked(file: IO[bytes]) -> bool | None:
    """Lock a file until it is closed; False if another process has the lock, None without locks."""
    if fcntl is None:
        return None
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True


def remove_leftovers(folder: str | os.PathLike[str], *, within: bool = False) -> None:
    """Remove the temporary files of killed processes from a folder, and from those within it.

    Files that a process still writes are kept.
    """
    found = Path(folder).rglob(".*.tmp") if within else Path(folder).glob(".*.tmp")
    for path in found:
        if _NAME.fullmatch(path.name) is None:
            continue
        try:
            with path.open("rb") as file:
                if _is_locked(file):
                    path.unlink(missing_ok=True)
        except OSError:
            continue  # It has just been renamed to its final name, or is not ours to remove.


@atexit.register
def remove_temporary_files() -> None:
    """Remove what unfinished writing left, before the process ends."""
    for path in tuple(_temporary):
        with suppress(OSError):  # If one cannot be removed, the others still are.
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
