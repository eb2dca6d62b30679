"""Input and output files of the commands."""

import os
import sys
import webbrowser
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from shutil import rmtree
from tempfile import TemporaryFile, gettempdir, mkdtemp

from flockenv.cli.console import errors, say
from flockenv.errors import ParameterError
from flockenv.recording import Recording

__all__ = [
    "check_file",
    "check_folder",
    "keep",
    "load_recording",
    "open_page",
    "printable",
    "refuse_overwriting",
    "refuse_present",
    "writable",
]


def printable(name: str | os.PathLike[str]) -> str:
    """Return the name of a file or policy with a sign in place of bytes that are no UTF-8.

    Such a name opens its file, but stands in no page, table or picture.
    """
    return os.fspath(name).encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def load_recording(path: Path, layout: Path | None = None, *, quiet: bool = False) -> Recording:
    """Return a recording, or one made of tracks; what of these was left out is printed.

    Parameters
    ----------
    path
        An ``.npz`` file of a recording; or tracks: a table, or with `layout` also arrays.
    layout
        How tracks lie in the file; by default as the TOML file beside it says. A table without one
        gets one that is guessed from its columns, and what is to be checked in it is printed.
    quiet
        Whether to print nothing.

    Raises
    ------
    ParameterError
        If the file cannot be read, is damaged, or neither; the message names it.
    """
    from flockenv.tracks import SUFFIXES, load_tracks, read_layout

    if layout is not None or path.suffix.lower() in SUFFIXES:
        beside = path.with_suffix(".toml")
        if layout is None and path.exists() and not beside.exists():
            _guess(path, beside)
        tracks = load_tracks(path, None if layout is None else read_layout(layout))
        if not quiet:
            say(f"{printable(path)}: {tracks.report}", errors)
        return tracks.to_recording()
    try:
        return Recording.load(path)
    except OSError as error:
        raise ParameterError(f"{path} cannot be read: {error.strerror}") from error


def _guess(path: Path, beside: Path) -> None:
    """Write a description of tracks that have none, and say what in it to check."""
    from flockenv.tracks import guess_layout

    _, doubts = guess_layout(path)
    say(f"{printable(path)} has no description; {printable(beside)} is a guess. Check:", errors)
    for name, meaning in doubts.items():
        say(f"  {name}: {meaning}", errors)


def check_folder(folder: Path, option: str = "--out") -> None:
    """Check, before long work, that files can be written into a folder, or where it will be made.

    Nothing is made and nothing removed: other commands may be at work in the same folder.

    Raises
    ------
    ParameterError
        If the folder cannot be made, or no file in it.
    """
    try:
        with TemporaryFile(dir=_nearest(folder)):
            pass
    except OSError as error:
        raise ParameterError(f"{option} {folder} cannot be written: {error.strerror}") from error


def _nearest(folder: Path) -> Path:
    """Return the folder, or the nearest one above it that is there."""
    for each in (folder, *folder.parents):
        try:
            each.lstat()
        except FileNotFoundError:
            continue
        return each
    return folder


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


def refuse_overwriting(
    given: str | os.PathLike[str] | None, option: str, written: Iterable[Path]
) -> None:
    """Check that a file which the user has given is none of those that will be written.

    Raises
    ------
    ParameterError
        If it is one of them; the message names `option`, by which it was given.
    """
    if given is None or not os.path.exists(given):
        return
    for path in written:
        if path.exists() and path.samefile(given):
            raise ParameterError(
                f"{option} {given} is where results would be written: name another --out"
            )


def refuse_present(written: Iterable[Path], force: bool) -> None:
    """Refuse to write over files that are there, unless that was asked for.

    Raises
    ------
    ParameterError
        For the first of them.
    """
    for path in written:
        if path.exists() and not force:
            raise ParameterError(f"{path} is there already: --force overwrites it")


def keep(path: Path, write: Callable[[Path], object]) -> None:
    """Write the results of finished work; where that cannot be done, somewhere else.

    A full disk or a folder that was taken away costs no run: results go into a new folder of the
    current one, of the system's for temporary files, or of the user's home.

    Parameters
    ----------
    path
        Where they should go; folders above it are made.
    write
        Writes them to a path: the file or folder itself, and what lies beside it.

    Raises
    ------
    ParameterError
        If they had to be written somewhere else, or could not be written at all; the message says
        where they are.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write(path)
    except OSError as error:
        failed = f"{path} cannot be written: {error.strerror or error}"
        for folder in (Path(), Path(gettempdir()), Path(os.path.expanduser("~"))):
            refuge = _written_in(folder, path.name, write)
            if refuge is not None:
                raise ParameterError(f"{failed}; the results are stored in {refuge}") from error
        raise ParameterError(
            f"{failed}, and no other folder can be written; nothing is stored"
        ) from error


def _written_in(folder: Path, name: str, write: Callable[[Path], object]) -> Path | None:
    """Write results into a new folder of another one; return where they are, or None."""
    try:
        aside = mkdtemp(prefix="flockenv-", dir=folder)
    except OSError:
        return None
    try:
        write(Path(aside, name))
    except OSError:
        rmtree(aside, ignore_errors=True)
        return None
    return Path(aside, name).absolute()


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


def open_page(page: Path) -> None:
    """Open a page in a browser; where there is none that can show it, say where the page is."""
    displays = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")
    # A browser in the terminal would take it over, and run none of the page's scripts.
    has_display = not sys.platform.startswith("linux") or any(map(os.environ.get, displays))
    address = page.resolve().as_uri()
    try:
        is_open = has_display and webbrowser.open(address)
    except webbrowser.Error:
        is_open = False
    if not is_open:
        say(f"No browser was found here. Open this page in one: {address}", errors)
