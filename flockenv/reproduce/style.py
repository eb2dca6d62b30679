"""Style of reproduced figures: legible at a column's width, also without color vision."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl
from cycler import cycler
from matplotlib.figure import Figure

from flockenv.comparison.figure import COLORS

__all__ = ["COLORS", "COLUMN_CM", "DENSITY_COLORS", "column_figure", "paper_style"]

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
