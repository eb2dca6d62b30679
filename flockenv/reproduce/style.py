"""Style of reproduced figures: legible at a column's width, also without color vision."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl
from cycler import cycler
from matplotlib.figure import Figure

from flockenv.comparison.episodes import NO_LEADERS
from flockenv.comparison.figure import COLORS, POLICY_COLORS

__all__ = [
    "COLORS",
    "COLUMN_CM",
    "DENSITY_COLORS",
    "LED_COLOR",
    "NOT_LED_COLOR",
    "column_figure",
    "mark_short",
    "paper_style",
]

NOT_LED_COLOR = POLICY_COLORS[NO_LEADERS]
LED_COLOR = POLICY_COLORS["steering law"]
"""Colors of flocks without leaders and of those that the paper's law leads."""

COLUMN_CM = 8.5
"""Width of a figure: a column of a journal page."""

DENSITY_COLORS = "cividis"
"""Color map of densities: even in lightness, and the same for the color-blind."""

_STYLE: dict[Any, Any] = {
    "font.size": 7,
    "axes.titlesize": 7,
    "axes.labelsize": 7,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "legend.fontsize": 6.5,
    "legend.frameon": False,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "lines.linewidth": 1.0,
    "lines.markersize": 2.5,
    "axes.prop_cycle": cycler(color=COLORS),
    # The same picture, the same file.
    "svg.hashsalt": "flockenv",
    "svg.fonttype": "none",
}


@contextmanager
def paper_style() -> Iterator[None]:
    """Draw and save in this style within a `with` block."""
    with mpl.rc_context(_STYLE):
        yield


def column_figure(height_cm: float, width_cm: float = COLUMN_CM) -> Figure:
    """Return an empty figure, its panels laid out without overlaps."""
    return Figure(figsize=(width_cm / 2.54, height_cm / 2.54), layout="constrained")


def mark_short(figure: Figure, minutes: float, full: str) -> None:
    """Write below a figure that its runs are shorter than full ones: it may show other states."""
    below = 0.35 / 2.54 / figure.get_figheight()
    layout = figure.get_layout_engine()
    if layout is not None:
        layout.set(rect=(0.0, below, 1.0, 1.0 - below))  # type: ignore[call-arg]
    figure.text(
        0.5,
        0.3 * below,
        f"short runs: {minutes:.3g} min, {full}",
        ha="center",
        va="bottom",
        fontsize=6.5,
        color=COLORS[1],
        weight="bold",
    )
