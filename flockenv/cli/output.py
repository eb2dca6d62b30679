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
    """Return the name of a file or policy with bytes that are not UTF-8 replaced by a sign.

    Such a name opens its file, but cannot be printed in a page, table or picture.
    """
    return os.fspath(name).encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def load_recording(
    path: Path,
    layout: Path | None = None,
    *,
    quiet: bool = False,
    report: Callable[["TrackReport"], object] = lambda found: None,
) -> Recording:
    """Return a recording, or one made of a table of tracks.

    Rows that were left out are printed, unless `quiet`, and passed to `report`.

    The layout of tracks is read from the TOML file beside them unless one is given. If there is
    none, a layout is guessed from the columns, and the lines to check are printed. Raises
    ParameterError for a file that cannot be read, is damaged, or is neither a recording nor a
    table.
    """
    from flockenv.tracks import check_ending, description_of, guess_layout, read_layout, read_tracks

    if layout is None and path.suffix.lower() == ".npz":
        try:
            return Recording.load(path)
        except OSError as error:
            raise ParameterError(f"{path} cannot be read: {error.strerror}") from error
    check_ending(path)
    if layout is None and not (beside := description_of(path)).exists():
        checks = guess_layout(path)
        echo(
            f"{printable(path)} has no description; {printable(beside)} is a guess. Its doubts:",
            errors,
        )
        for line in checks:
            echo(f"  {line}", errors)

    def print_and_report(found: "TrackReport") -> None:
        if not quiet:
            echo(f"{printable(path)}: {found}", errors)
        report(found)

    return read_tracks(path, None if layout is None else read_layout(layout), print_and_report)


def prepare(*paths: Path, overwrites: bool = True) -> None:
    """Make the folders of files that will be written, before long work.

    Raises ParameterError for a file that cannot be written, or that exists and may not be
    overwritten.
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
    """Open a page in a browser; without one that can show it, print its path."""
    address = page.resolve().as_uri()
    # A text browser would take over the terminal, and run none of the page's scripts.
    displays = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")
    has_display = sys.platform != "linux" or any(map(os.environ.get, displays))
    if not (has_display and webbrowser.open(address)):
        echo(f"No browser was found here. Open this page in one: {address}", errors)


def summary_of(recording: Recording) -> dict[str, float | None]:
    """Return a run's row of a sweep's table; None for undefined values."""
    return {name: None if np.isnan(n) else n for name, n in summary(recording).items()}


def in_words(recording: Recording) -> str:
    """Return the means of a recording's quantities without a unit, in one line."""
    means, words = summary_of(recording), []
    has_target = recording.parameters.common_target is not None
    for quantity in QUANTITIES:
        if (
            quantity.is_averaged
            and not quantity.unit
            and (has_target or quantity.name != "signed_order")
        ):
            mean = means[f"{quantity.name}_mean"]
            called = (
                f"mean {quantity.symbol}"
                if "_" in quantity.symbol
                else quantity.label.partition(",")[0]
            )
            words.append(f"{called} {'undefined' if mean is None else f'{mean:.3f}'}")
    return ", ".join(words)
