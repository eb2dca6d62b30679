"""Input and output files of the commands, and the line that sums up a recording."""

import os
import sys
import webbrowser
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING

import numpy as np

from flockenv._io.plain_file import check_writable
from flockenv.cli.console import echo, errors
from flockenv.errors import ParameterError
from flockenv.order import QUANTITIES
from flockenv.recording import Recording
from flockenv.runs.sweep import summary

if TYPE_CHECKING:
    from flockenv.tracks import TrackReport


def printable(name: str | os.PathLike[str]) -> str:
    """Return the name of a file or policy; bytes that are not UTF-8 become replacement characters.

    A name with such bytes opens its file, but cannot be printed in a page, table or picture.
    """
    return os.fspath(name).encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def load_recording(
    path: Path,
    layout: Path | None = None,
    *,
    quiet: bool = False,
    report: Callable[["TrackReport"], object] = lambda track_report: None,
) -> Recording:
    """Return a recording, or one made of a table of tracks.

    For tracks, `report` gets the report on the rows that were left out. It is also printed, unless
    `quiet`.

    The layout of tracks is read from the file `layout`, by default the TOML file beside the table.
    If that does not exist, a layout is guessed from the columns, and the lines to check are
    printed. Raises ParameterError for a file that cannot be read, is damaged, or is neither a
    recording nor a table.
    """
    from flockenv.tracks import check_ending, description_of, guess_layout, read_layout, read_tracks

    if layout is None and path.suffix.lower() == ".npz":
        try:
            return Recording.load(path)
        except OSError as error:
            raise ParameterError(f"{path} cannot be read: {error.strerror}") from error
    check_ending(path)
    description = description_of(path)
    if layout is None and not description.exists():
        lines_to_check = guess_layout(path)
        echo(
            f"{printable(path)} has no description; {printable(description)} is a guess. "
            "Its doubts:",
            errors,
        )
        for line in lines_to_check:
            echo(f"  {line}", errors)

    def print_and_report(track_report: "TrackReport") -> None:
        if not quiet:
            echo(f"{printable(path)}: {track_report}", errors)
        report(track_report)

    return read_tracks(path, None if layout is None else read_layout(layout), print_and_report)


def prepare(*paths: Path, overwrites: bool = True) -> None:
    """Check, before long work, that files can be written; make their folders.

    Raises ParameterError for a file that cannot be written, and, unless `overwrites`, for one that
    exists.
    """
    for path in paths:
        try:
            if path.is_dir():
                raise ParameterError(f"{path} cannot be written: it is a folder")
            check_writable(path)
            if path.exists() and not overwrites:
                raise ParameterError(f"{path} already exists: --force overwrites it")
            path.parent.mkdir(parents=True, exist_ok=True)
            with TemporaryFile(dir=path.parent):
                pass
        except OSError as error:
            raise ParameterError(f"{path} cannot be written: {error.strerror}") from error


def open_page(page: Path) -> None:
    """Open a page in a browser, or print its address if no graphical browser is found."""
    address = page.resolve().as_uri()
    # Without a display, a text browser would take over the terminal and run no script of the page.
    displays = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")
    has_display = sys.platform != "linux" or any(map(os.environ.get, displays))
    if not (has_display and webbrowser.open(address)):
        echo(f"No browser was found here. Open this page in one: {address}", errors)


def summary_of(recording: Recording) -> dict[str, float | None]:
    """Return a run's quantities as in the table of a sweep; None for undefined values."""
    values = summary(recording)
    return {name: None if np.isnan(value) else value for name, value in values.items()}


def in_words(recording: Recording) -> str:
    """Return in one line the means of those quantities of a recording that have no unit."""
    means, parts = summary_of(recording), []
    has_target = recording.parameters.common_target is not None
    for quantity in QUANTITIES:
        if not quantity.is_averaged or quantity.unit:
            continue
        if quantity.name == "signed_order" and not has_target:
            continue
        mean = means[f"{quantity.name}_mean"]
        # Only symbols with an index, such as Ψ_o, say enough by themselves.
        has_index = "_" in quantity.symbol
        label = f"mean {quantity.symbol}" if has_index else quantity.label.partition(",")[0]
        parts.append(f"{label} {'undefined' if mean is None else f'{mean:.3f}'}")
    return ", ".join(parts)
