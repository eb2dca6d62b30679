"""Pictures that a study draws of its runs."""

import io
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from docs.scripts.plots import page_style, write_png
from flockenv.rendering.palette import OKABE_ITO
from studies.store import write
from studies.study import Options

COLORS = (*OKABE_ITO.values(),)

PAPERS_LINE: dict[str, Any] = {
    "color": "0.1",
    "linestyle": "--",
    "path_effects": [withStroke(linewidth=3.0, foreground="w")],
}
"""How a picture marks what the paper says, visible on every ground."""

DENSITIES = "YlGnBu"
"""The map of densities: nothing is the color of the ground, so that `docs.scripts.dark` and the
site's style sheet, which turn lightness around, make a map of it that begins at dark ground."""


@contextmanager
def picture(
    options: Options, name: str, width_cm: float = 17.0, height_cm: float = 7.0
) -> Iterator[Figure]:
    """Yield an empty figure, and write it to ``pictures/<name>.png``."""
    with mpl.rc_context(page_style(9.0)):
        figure = Figure(figsize=(width_cm / 2.54, height_cm / 2.54), layout="constrained")
        yield figure
        write_png(figure, file := io.BytesIO(), 130)
    write(path := options.folder / "pictures" / f"{name}.png", file.getvalue())
    print(f"Drawn: {path}")


def curve(
    axes: Any, x: Iterable[float], intervals: Iterable[tuple[float, float, float]], **style: Any
) -> None:
    """Draw means with their intervals."""
    value, low, high = np.array(list(intervals)).T
    bars = np.nan_to_num(np.maximum([value - low, high - value], 0.0))
    axes.errorbar(list(x), value, bars, elinewidth=0.7, **{"marker": "o", **style})


def density_map(
    axes: Any, x: Sequence[float], edges: NDArray[np.float64], shares: Sequence[Any], most: float
) -> Any:
    """Draw histograms side by side, as densities over a uniform one."""
    centers = np.asarray(x, float)
    step = np.diff(centers).min() / 2
    sides = np.array([*(centers - step), centers[-1] + step])
    density = (len(edges) - 1) * np.array(shares).T
    axes.grid(visible=False)
    return axes.pcolormesh(
        sides, edges, density, cmap=DENSITIES, vmin=0.0, vmax=most, rasterized=True
    )
