"""What commands do with files they are given and asked for."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from flockenv import ParameterError, Recording

__all__ = ["load_recording", "writable"]


def load_recording(path: Path) -> Recording:
    """Return a recording.

    Raises
    ------
    ParameterError
        If the file cannot be read, is damaged, or no recording; the message names it.
    """
    try:
        return Recording.load(path)
    except OSError as error:
        raise ParameterError(f"{path} cannot be read: {error.strerror}") from error


@contextmanager
def writable(path: Path) -> Iterator[Path]:
    """Make a file's folder, and turn failures to write it into a named error.

    Raises
    ------
    ParameterError
        If the file or its folder cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield path
    except OSError as error:
        raise ParameterError(f"{path} cannot be written: {error.strerror}") from error
