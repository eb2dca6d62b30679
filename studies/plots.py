"""Pictures of studies, from their committed tables."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from docs.scripts.plots import (
    Interval,
    Plot,
    Row,
    TableError,
    bar_lengths,
    draw_intervals,
    name_heights,
)
from flockenv.comparison.episodes import NO_LEADERS
from flockenv.comparison.figure import policy_colors
from studies.store import StudyError
from studies.study import Options


def drawing(name: str, plots: Mapping[str, Plot]) -> Callable[[Options], None]:
    """Return the script of a module, by its name, that draws pictures whose data have changed."""

    def script(options: Options) -> None:
        for picture, plot in plots.items():
            path = options.folder / "pictures" / f"{picture}.png"
            try:
                if not plot.is_drawn(path):
                    plot.save(path)
            except TableError as error:
                raise StudyError(str(error)) from error

    script.__module__ = name
    return script


def interval(row: Row, mean: str = "mean", low: str = "low", high: str = "high") -> Interval:
    """Return a mean and the ends of its interval, from the columns of a row."""
    return float(row[mean]), float(row[low]), float(row[high])


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
    colors = policy_colors(lines)
    colors.update({name: "0.4" for name in lines if name == NO_LEADERS})
    for place, name in enumerate(lines):
        at, mean, low, high = zip(*sorted(lines[name]), strict=True)
        axes.errorbar(
            [each + shift * (place - (len(lines) - 1) / 2) for each in at],
            mean,
            bar_lengths(mean, low, high),
            fmt="o-",
            ms=5,
            lw=1.5,
            capsize=3,
            color=colors[name],
            label=name,
        )


def grouped(
    axes: Axes,
    series: Mapping[str, Mapping[str, Interval]],
    colors: Mapping[str, str] | None = None,
    reference: float | None = None,
    shift: float = 0.2,
) -> None:
    """Draw means with intervals on a line for each name, those of a series in one color.

    On a line the series stand `shift` apart, or less so that many leave the next line free, the
    first on top. A vertical line marks the reference.
    """
    shift = min(shift, 0.9 / len(series))
    if reference is not None:
        axes.axvline(reference, color="0.4", lw=1)
    colors = policy_colors(series) if colors is None else colors
    names = [*dict.fromkeys(name for intervals in series.values() for name in intervals)]
    for place, (own, intervals) in enumerate(series.items()):
        off = shift * (place - (len(series) - 1) / 2)
        at = [names.index(name) + off for name in intervals]
        draw_intervals(axes, at, [*intervals.values()], color=colors[own], label=own)
    name_heights(axes, names)


COLORS = policy_colors(["mine", "damped law", "paper's law", "tuned law"])
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
    """Draw what laws reach as bands as high as their intervals, their names at the left.

    Names are in ink: colors of lines are too pale for letters, on light ground or on dark.
    """
    for row in laws:
        name, (mean, low, high) = row["policy"], numbers(row)
        axes.axhspan(low, high, color=COLORS[name], alpha=0.2, lw=0)
        axes.axhline(mean, color=COLORS[name], lw=1.5)
        axes.annotate(name, (0.0, mean), (4, 3), axes.get_yaxis_transform(), "offset points")
