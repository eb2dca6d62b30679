"""A file that one process holds at a time; the system lets go of it when the process ends."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

from flockenv.errors import InUseError

__all__ = ["held"]

if sys.platform == "win32":
    import msvcrt

    # A byte beyond every file's end: what others read stays readable.
    _FAR = 1 << 30

    def _lock(file: IO[Any]) -> None:
        file.seek(_FAR)
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _lock(file: IO[Any]) -> None:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


@contextmanager
def held(path: Path, what: str) -> Iterator[None]:
    """Hold a file within a `with` block; it is gone afterwards, unless the process was killed.

    Parameters
    ----------
    path
        The file; its folder must be there.
    what
        What errors say is in use.

    Raises
    ------
    InUseError
        If another process, or another thread, holds it.
    OSError
        If the file cannot be opened.
    """
    with open(os.open(path, os.O_RDWR | os.O_CREAT, 0o666), "r+b") as file:
        try:
            _lock(file)
        except (BlockingIOError, PermissionError) as error:
            raise InUseError(
                f"{what} is in use by another process: name another, or wait"
            ) from error
        except OSError:  # Without locks everybody looks after their own folder.
            pass
        try:
            yield
        finally:
            # Still held here; Windows keeps a file that is open.
            with suppress(OSError):
                path.unlink()
