"""Series of order parameters as tables and as panels of a figure."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import PowerNorm
from numpy.typing import NDArray

from flockenv.reproduce.order_statistics import PHI_EDGES, PSI_EDGES, OrderStatistics
from flockenv.reproduce.style import DENSITY_COLORS, LED_COLOR, NOT_LED_COLOR
from flockenv.statistics.intervals import percentile_ends

__all__ = ["density_map", "density_rows", "draw_curve", "interval_ends", "series_rows"]


def interval_ends(
    replicates: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the ends of the intervals of replicates, shape (p, r): two arrays of shape (p,)."""
    return percentile_ends(replicates[:, 1:], axis=1)


def series_rows(
    series: OrderStatistics, quantities: Sequence[str], keys: dict[str, object], x_name: str
) -> pd.DataFrame:
    """Return a row for each point: means with their intervals, and spreads over frames."""
    columns: dict[str, object] = {**keys, x_name: series.x}
    for name in quantities:
        mean = series.mean(name)
        low, high = interval_ends(mean)
        columns |= {name: mean[:, 0], f"{name}_low": low, f"{name}_high": high}
        if name in ("psi_o", "c_v"):
            columns[f"{name}_std"] = series.deviation(name)[:, 0]
    return pd.DataFrame(columns)


def density_rows(
    series: OrderStatistics, name: str, keys: dict[str, object], x_name: str
) -> pd.DataFrame:
    """Return a row for each point and bin of a probability density."""
    edges = PHI_EDGES if name == "phi_o" else PSI_EDGES
    density = series.density(name)
    low, high = interval_ends(density)
    bins = len(edges) - 1
    return pd.DataFrame(
        {
            **keys,
            x_name: np.repeat(series.x, bins),
            "quantity": name,
            "bin_low": np.tile(edges[:-1], len(series.x)),
            "bin_high": np.tile(edges[1:], len(series.x)),
            "density": density[:, 0].ravel(),
            "density_low": low.ravel(),
            "density_high": high.ravel(),
        }
    )


def density_map(
    axes: Axes, series: OrderStatistics, name: str, highest: float, gamma: float = 1.0
) -> QuadMesh:
    """Draw densities as colors, each column a point of the series.

    A `gamma` below 1 spreads the colors of low densities.
    """
    edges = PHI_EDGES if name == "phi_o" else PSI_EDGES
    half = np.diff(series.x).mean() / 2
    across = np.append(series.x - half, series.x[-1] + half)
    mesh = axes.pcolormesh(
        across,
        edges,
        series.density(name)[:, 0].T,
        norm=PowerNorm(gamma, 0.0, highest),
        cmap=DENSITY_COLORS,
        rasterized=True,
    )
    if name == "phi_o":
        axes.set_yticks([-np.pi, -np.pi / 2, 0, np.pi / 2, np.pi])
        axes.set_yticklabels(["−π", "−π/2", "0", "π/2", "π"])
    return mesh


def draw_curve(axes: Axes, series: OrderStatistics, quantity: str, label: str, led: bool) -> None:
    """Draw means with their intervals, and the spread of the frames as a band."""
    color, mark = (LED_COLOR, "^--") if led else (NOT_LED_COLOR, "o-")
    mean, spread = series.mean(quantity), series.deviation(quantity)[:, 0]
    low, high = interval_ends(mean)
    value = mean[:, 0]
    axes.fill_between(series.x, value - spread, value + spread, color=color, alpha=0.15, lw=0)
    bars = np.maximum([value - low, high - value], 0.0)
    axes.errorbar(series.x, value, bars, fmt=mark, color=color, elinewidth=0.7, label=label)
