"""Pictures of committed tables: means with 95 % intervals, a policy always in one color.

A picture carries the SHA-256 of the files that it was drawn from; test_plots.py fails if these have
changed since.
"""

import csv
import hashlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from flockenv.comparison.episodes import NO_LEADERS
from flockenv.comparison.figure import OWN_COLORS, policy_colors
from studies.study import Options, StudyError

Row = dict[str, str]

Interval = tuple[float, float, float]
"""A mean and the ends of its interval."""

DATA = "Data"
"""The key of a picture's metadata that holds the digest of what it was drawn from."""

# Legible where a phone shows the picture 390 pixels wide.
_STYLE = {
    "font.size": 11,
    "axes.titlesize": 11,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "legend.frameon": False,
}


def rows(file: Path, **wanted: str) -> list[Row]:
    """Return the rows of a CSV file that have these values; StudyError if there are none."""
    if not file.exists():
        raise StudyError(f"{file} is missing: its folder's README.md has the command that makes it")
    with file.open(encoding="utf-8", newline="") as lines:
        found = [
            row
            for row in csv.DictReader(lines)
            if all(row[name] == value for name, value in wanted.items())
        ]
    if not found:
        raise StudyError(f"{file} holds no row with {wanted}")
    return found


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
        CSV files that it is drawn from.
    draw
        Draws into an empty figure.
    size
        Width and height in inches, at 150 dots each.
    """

    data: Sequence[Path]
    draw: Callable[[Figure], None]
    size: tuple[float, float] = (6.8, 4.2)

    def digest(self) -> str:
        """Return the SHA-256 of the data."""
        return hashlib.sha256(b"".join(file.read_bytes() for file in self.data)).hexdigest()

    def is_drawn(self, path: Path) -> bool:
        """Return whether a picture was drawn from the data that are there."""
        if not path.is_file():
            return False
        with Image.open(path) as picture:
            return picture.info.get(DATA) == self.digest()

    def save(self, path: Path) -> None:
        """Draw into a file."""
        with mpl.rc_context(_STYLE):
            figure = Figure(figsize=self.size, layout="constrained")
            self.draw(figure)
            stamp = {"Software": None, DATA: self.digest()}
            path.parent.mkdir(parents=True, exist_ok=True)
            figure.savefig(path, format="png", dpi=150, metadata=stamp)


def drawing(name: str, plots: Mapping[str, Plot]) -> Callable[[Options], None]:
    """Return the script of a module, by its name, that draws pictures whose data have changed."""

    def script(options: Options) -> None:
        for picture, plot in plots.items():
            path = options.folder / "pictures" / f"{picture}.png"
            if not plot.is_drawn(path):
                plot.save(path)

    script.__module__ = name
    return script


def colors_of(names: Iterable[str]) -> dict[str, str]:
    """Return a color for each policy: as in every figure, and the damped law's own on the pages."""
    every = [*names]
    others = policy_colors(name for name in every if name != "damped law")
    return {name: others.get(name, OWN_COLORS[3]) for name in every}


def across(
    axes: Axes,
    rows: Iterable[Row],
    x: str,
    columns: tuple[str, str, str] = ("signed_order", "signed_order_low", "signed_order_high"),
    by: str = "policy",
    shift: float = 0.06,
) -> None:
    """Draw means with intervals against a column x, a line for each value of `by`.

    Lines stand `shift` apart, so that their bars can be told apart. `columns` name the mean and the
    ends of its interval.
    """
    lines: dict[str, list[tuple[float, ...]]] = {}
    for row in rows:
        point = (float(row[x]), *(float(row[name]) for name in columns))
        lines.setdefault(row[by], []).append(point)
    colors = colors_of(lines)
    colors.update({name: "0.4" for name in lines if name == NO_LEADERS})
    for place, name in enumerate(lines):
        at, mean, low, high = zip(*sorted(lines[name]), strict=True)
        axes.errorbar(
            [each + shift * (place - (len(lines) - 1) / 2) for each in at],
            mean,
            _lengths(mean, low, high),
            fmt="o-",
            ms=5,
            lw=1.5,
            capsize=3,
            color=colors[name],
            label=name,
        )


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
    colors = colors_of(intervals) if colors is None else colors
    for line, (name, interval) in enumerate(intervals.items()):
        _bars(axes, [line], [interval], color=colors[name])
    _lines(axes, intervals)


def grouped(
    axes: Axes,
    series: Mapping[str, Mapping[str, Interval]],
    colors: Mapping[str, str] | None = None,
    reference: float | None = None,
    shift: float = 0.2,
) -> None:
    """Draw means with intervals on a line for each name, those of a series in one color.

    On a line the series stand `shift` apart, the first on top. A vertical line marks the reference.
    """
    if reference is not None:
        axes.axvline(reference, color="0.4", lw=1)
    colors = colors_of(series) if colors is None else colors
    names = [*dict.fromkeys(name for intervals in series.values() for name in intervals)]
    for place, (own, intervals) in enumerate(series.items()):
        off = shift * (place - (len(series) - 1) / 2)
        at = [names.index(name) + off for name in intervals]
        _bars(axes, at, [*intervals.values()], color=colors[own], label=own)
    _lines(axes, names)


def _bars(
    axes: Axes, at: Sequence[float], intervals: Sequence[Interval], color: str, label: str = ""
) -> None:
    mean, low, high = zip(*intervals, strict=True)
    lengths = _lengths(mean, low, high)
    style = {"fmt": "o", "ms": 5, "lw": 1.5, "capsize": 3, "color": color, "label": label}
    axes.errorbar(mean, at, xerr=lengths, **style)


def _lines(axes: Axes, names: Iterable[str]) -> None:
    shown = [*names]
    axes.set_yticks(range(len(shown)), shown)
    axes.set_ylim(len(shown) - 0.5, -0.5)


def _lengths(
    mean: Sequence[float], low: Sequence[float], high: Sequence[float]
) -> tuple[list[float], list[float]]:
    below = [middle - end for middle, end in zip(mean, low, strict=True)]
    above = [end - middle for middle, end in zip(mean, high, strict=True)]
    return below, above


COLORS = colors_of(["mine", "damped law", "paper's law", "tuned law"])
OWN = COLORS["mine"]
"""The color of what a reader trains."""
_ENDS = ("signed_order", "low", "high")


def numbers(row: Row, *names: str) -> Interval:
    """Return a mean and the ends of its interval, by default of the signed order."""
    mean, low, high = (float(row[name]) for name in names or _ENDS)
    return mean, low, high


def seed_points(axes: Axes, found: Sequence[Row], x: str, **style: Any) -> None:
    """Draw what a seed reaches against a column x."""
    points = [(float(row[x]), *numbers(row)) for row in found]
    at, mean, low, high = np.array(points).T
    axes.errorbar(at, mean, (mean - low, high - mean), ms=5, capsize=3, color=OWN, **style)


def levels(axes: Axes, laws: Sequence[Row]) -> None:
    """Draw what laws reach as bands as high as their intervals, their names at the left."""
    for row in laws:
        name, (mean, low, high) = row["policy"], numbers(row)
        axes.axhspan(low, high, color=COLORS[name], alpha=0.2, lw=0)
        axes.axhline(mean, color=COLORS[name], lw=1.5)
        axes.annotate(
            name, (0.0, mean), (4, 3), axes.get_yaxis_transform(), "offset points",
            color=COLORS[name],
        )  # fmt: skip
