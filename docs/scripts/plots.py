"""Committed tables and their plots: means with 95 % intervals, a policy always in one color.

A plot carries the SHA-256 of the files that it was drawn from. A test fails if these have changed
since. Pictures of pages, studies and benchmarks have the letters and lines of `page_style`. They
carry the size of their smallest letters, which a test compares with the widths of pages.
"""

import csv
import hashlib
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import matplotlib as mpl
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

from flockenv.comparison.figure import policy_colors
from flockenv.rendering.palette import OKABE_ITO

REPOSITORY = Path(__file__).parents[2]
DOCS, STUDIES = REPOSITORY / "docs", REPOSITORY / "studies"

Row = dict[str, str]

Interval = tuple[float, float, float]
"""A mean and the ends of its interval."""

DATA = "Data"
"""The key of a picture's metadata for the digest of its data."""

LETTERS = "Letters"
"""The key of a picture's metadata for the size of its smallest letters in pixels."""

LEAST_LETTERS_PX = 9.0
"""Least size in pixels of a picture's letters on a page."""
DESK_PX, PHONE_PX, SCROLLED_PX = 736, 358, 544
"""Widths of the site's pictures on a desk, on a phone of 390 pixels, and of those that a phone
scrolls (`docs/static/phones.css`)."""


_LABELED = ("axes", "figure", "xtick", "ytick")
_TITLED = ("axes.titlesize", "figure.titlesize", "legend.fontsize", "legend.title_fontsize")


def page_style(letters_pt: float = 11.0) -> dict[str, Any]:
    """Return Matplotlib's settings for every picture of the pages, with letters of one size."""
    return {
        "font.size": letters_pt,
        **dict.fromkeys((*(f"{part}.labelsize" for part in _LABELED), *_TITLED), letters_pt),
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.linewidth": 0.6,
        "axes.grid": True,
        "axes.axisbelow": True,
        "axes.prop_cycle": cycler(color=OKABE_ITO.values()),
        "grid.alpha": 0.25,
        "legend.frameon": False,
        "lines.linewidth": 1.2,
        "lines.markersize": 4,
    }


def write_png(figure: Figure, file: Path | IO[bytes], dpi: float, **stamp: str) -> None:
    """Write a picture with the size of its smallest letters and `stamp` as its metadata."""
    metadata = {"Software": None, LETTERS: smallest_letters(figure, dpi), **stamp}
    figure.savefig(file, format="png", dpi=dpi, metadata=metadata)


def letters_px(path: Path, shown_px: float) -> float:
    """Return the size of a picture's smallest letters on a page that shows at most `shown_px`."""
    with Image.open(path) as picture:
        return float(picture.info[LETTERS]) * min(shown_px / picture.width, 1.0)


def is_scrolled(path: Path) -> bool:
    """Return whether a phone scrolls a picture, since its letters would be too small otherwise."""
    return letters_px(path, PHONE_PX) < LEAST_LETTERS_PX


def smallest_letters(figure: Figure, dpi: float) -> str:
    """Return the size in pixels of a figure's smallest letters at these dots per inch, as text.

    It is `inf` without letters.
    """
    figure.draw_without_rendering()  # It gives ticks their text.
    texts = figure.findobj(
        lambda artist: isinstance(artist, Text) and bool(artist.get_text().strip())
    )
    sizes = (text.get_fontsize() for text in texts)
    return f"{min(sizes, default=math.inf) * dpi / 72:.1f}"


class TableError(Exception):
    """A committed table that is missing, or lacks the requested rows."""


def rows(file: Path, **wanted: str) -> list[Row]:
    """Return the rows of a CSV file that have these values; TableError if there are none."""
    _check_exists(file)
    with file.open(encoding="utf-8", newline="") as lines:
        matching = [
            row
            for row in csv.DictReader(lines)
            if all(row[name] == value for name, value in wanted.items())
        ]
    if not matching:
        raise TableError(f"{file} holds no row with {wanted}")
    return matching


def _check_exists(file: Path) -> None:
    if not file.exists():
        raise TableError(f"{file} is missing: its folder's README.md has the command that makes it")


def one(file: Path, **wanted: str) -> Row:
    """Return the only row that has these values."""
    (row,) = rows(file, **wanted)
    return row


@dataclass(frozen=True)
class Plot:
    """A picture of a page.

    Attributes
    ----------
    data
        CSV files from which it is drawn.
    draw
        Draws into an empty figure.
    size
        Width and height in inches, at 150 dots each, or a function that gives them from the data.
    """

    data: Sequence[Path]
    draw: Callable[[Figure], None]
    size: tuple[float, float] | Callable[[], tuple[float, float]] = (6.8, 4.2)

    def digest(self) -> str:
        """Return the SHA-256 of the data; TableError if a file is missing."""
        for file in self.data:
            _check_exists(file)
        return hashlib.sha256(b"".join(file.read_bytes() for file in self.data)).hexdigest()

    def is_drawn(self, path: Path) -> bool:
        """Return whether a picture was drawn from the present data."""
        if not path.is_file():
            return False
        with Image.open(path) as picture:
            return picture.info.get(DATA) == self.digest()

    def save(self, path: Path) -> None:
        """Draw into a file."""
        with mpl.rc_context(page_style()):
            digest = self.digest()  # Fails first if a table is missing.
            size = self.size() if callable(self.size) else self.size
            figure = Figure(figsize=size, layout="constrained")
            self.draw(figure)
            path.parent.mkdir(parents=True, exist_ok=True)
            write_png(figure, path, 150, **{DATA: digest})


def listed(
    axes: Axes,
    intervals: Mapping[str, Interval],
    colors: Mapping[str, str] | None = None,
    reference: float | None = None,
) -> None:
    """Draw a mean with its interval (mean, low, high) on a line for each name, the first on top.

    A vertical line marks the reference.
    """
    if reference is not None:
        axes.axvline(reference, color="0.4", lw=1)
    colors = policy_colors(intervals) if colors is None else colors
    for line, (name, interval) in enumerate(intervals.items()):
        draw_intervals(axes, [line], [interval], color=colors[name])
    name_heights(axes, intervals)


def draw_intervals(
    axes: Axes, at: Sequence[float], intervals: Sequence[Interval], color: str, label: str = ""
) -> None:
    """Draw means with horizontal intervals at these heights."""
    mean, low, high = zip(*intervals, strict=True)
    style = {"fmt": "o", "ms": 5, "lw": 1.5, "capsize": 3, "color": color, "label": label}
    axes.errorbar(mean, at, xerr=bar_lengths(mean, low, high), **style)


def name_heights(axes: Axes, names: Iterable[str]) -> None:
    """Name the heights 0, 1, 2 and so on, from the top down."""
    words = [*names]
    axes.set_yticks(range(len(words)), words)
    axes.set_ylim(len(words) - 0.5, -0.5)


def bar_lengths(
    mean: Sequence[float], low: Sequence[float], high: Sequence[float]
) -> tuple[list[float], list[float]]:
    """Return the lengths of intervals below and above their means, as Matplotlib takes them."""
    below = [middle - end for middle, end in zip(mean, low, strict=True)]
    above = [end - middle for middle, end in zip(mean, high, strict=True)]
    return below, above
