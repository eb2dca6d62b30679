"""Ordinary files. Devices, pipes and sockets are refused: reading them might never end."""

import errno
import os
import stat
from pathlib import Path
from typing import BinaryIO

from flockenv.errors import ParameterError, short_repr

_WRITABLE = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH


def is_special(path: str | os.PathLike[str]) -> bool:
    """Return whether an existing path is a device, a pipe or a socket."""
    try:
        return _is_special(os.stat(path).st_mode)
    except ValueError as error:
        raise ParameterError(f"{short_repr(path)} is not the name of a file: {error}") from error


def _is_special(mode: int) -> bool:
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def open_plain(path: str | os.PathLike[str]) -> BinaryIO:
    """Open a file to read its bytes.

    Raises ParameterError for a device, a pipe or a socket, and OSError for a folder or a missing
    file.
    """
    refusal = ParameterError(f"{os.fspath(path)} is not a file but a device, a pipe or a socket")
    if is_special(path):
        raise refusal
    # O_NONBLOCK: if the path has become a pipe since the check, opening it must not wait.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    descriptor = os.open(path, flags)
    try:
        mode = os.fstat(descriptor).st_mode
        if _is_special(mode):
            raise refusal
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
        return os.fdopen(descriptor, "rb")
    except BaseException:
        os.close(descriptor)
        raise


def check_writable(path: str | os.PathLike[str]) -> None:
    """Refuse to replace a device, a pipe, a socket or a write-protected file.

    Raises ParameterError for the first three. Raises PermissionError for a write-protected file,
    even for root: renaming another file to its name would bypass the protection.
    """
    if not Path(path).exists():
        return
    if is_special(path):
        raise ParameterError(
            f"{os.fspath(path)} cannot be written: it is a device, a pipe or a socket"
        )
    is_protected = not stat.S_IMODE(os.stat(path).st_mode) & _WRITABLE
    if is_protected or not os.access(path, os.W_OK):
        reason = "it is protected against writing"
        raise PermissionError(errno.EACCES, reason, os.fspath(path))
