"""What commands do with files they are given and asked for."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryFile

from flockenv.errors import ParameterError
from flockenv.recording import Recording

__all__ = ["check_file", "check_folder", "load_recording", "writable"]


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


def check_folder(folder: Path, option: str = "--out") -> None:
    """Check, before long work, that files can be written into a folder; leaves nothing behind.

    Raises
    ------
    ParameterError
        If the folder cannot be made, or no file in it.
    """
    made: list[Path] = []
    try:
        for each in (*reversed(folder.parents), folder):
            if not each.is_dir():
                each.mkdir()
                made.append(each)
        with TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise ParameterError(f"{option} {folder} cannot be written: {error.strerror}") from error
    finally:
        for each in reversed(made):
            each.rmdir()


def check_file(path: Path, option: str = "--out") -> None:
    """Check, before long work, that a file can be written; leaves nothing behind.

    Raises
    ------
    ParameterError
        If it is a folder, or its folder takes no files.
    """
    if path.is_dir():
        raise ParameterError(f"{option} {path} cannot be written: it is a folder")
    check_folder(path.parent, f"{option} {path}: folder")


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
