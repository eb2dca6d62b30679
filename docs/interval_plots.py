"""Draw the plots of the pages from committed CSV files: `make tables`.

A plot shows means with 95 % intervals, a policy always in one color. It carries the SHA-256 of the
files that it was drawn from; tests/docs/test_plots.py fails where these have changed since.
"""

import hashlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import matplotlib as mpl
from committed_data import DOCS, Row
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flockenv.comparison.episodes import NO_LEADERS
from flockenv.comparison.figure import OWN_COLORS, policy_colors

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


@dataclass(frozen=True)
class Plot:
    """A picture of a page.

    Attributes
    ----------
    data
        CSV files below docs that it is drawn from.
    draw
        Draws into an empty figure.
    size
        Width and height in inches, at 150 dots each.
    """

    data: Sequence[str]
    draw: Callable[[Figure], None]
    size: tuple[float, float] = (6.8, 4.2)

    def digest(self) -> str:
        """Return the SHA-256 of the data."""
        return hashlib.sha256(
            b"".join((DOCS / file).read_bytes() for file in self.data)
        ).hexdigest()

    def save(self, name: str) -> None:
        """Draw into docs/NAME."""
        with mpl.rc_context(_STYLE):
            figure = Figure(figsize=self.size, layout="constrained")
            self.draw(figure)
            stamp = {"Software": None, DATA: self.digest()}
            figure.savefig(DOCS / name, format="png", dpi=150, metadata=stamp)


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
