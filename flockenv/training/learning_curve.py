"""The picture of a learning curve."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flockenv._io.atomic_write import atomic_write
from flockenv._io.extras import require

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


def draw_curve(
    curve: "pd.DataFrame | Mapping[str, NDArray[np.float64]]",
    laws: Mapping[str, float],
    path: Path,
) -> None:
    """Draw a learning curve, with a horizontal line at the order of each law.

    Parameters
    ----------
    curve
        The columns ``flock_hours`` and ``signed_order``.
    laws
        Mean signed order by the name of a law.
    path
        The PNG file to write.
    """
    figure: Figure = require("matplotlib.figure", "plot").Figure((6.4, 3.6), layout="constrained")
    axes = figure.subplots()
    axes.plot(curve["flock_hours"], curve["signed_order"], label="leaders that explore")
    for (name, order), style in zip(laws.items(), ("--", ":", "-.", "-"), strict=False):
        axes.axhline(order, color="0.4", lw=1, ls=style, label=name)
    axes.set(xlabel="simulated time of all flocks (hours)", ylabel="mean signed order")
    axes.legend(frameon=False, fontsize=8)
    with atomic_write(path) as file:
        figure.savefig(file, dpi=150, format="png")
