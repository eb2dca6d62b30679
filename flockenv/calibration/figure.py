"""The picture of a fit's Pareto front: misfits with and without leaders, jamming as color."""

from collections.abc import Sequence
from typing import IO, TYPE_CHECKING

import numpy as np

from flockenv._io.extras import require
from flockenv.calibration.surrogate import front_ranks
from flockenv.calibration.targets import GROUPS, MISFITS
from flockenv.calibration.tradeoffs import Landscape

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["save_front"]

_WORST = 8.0
"""The end of axes and colors: a target that is undefined has this penalty."""


def save_front(file: IO[bytes], views: Sequence[Landscape], finals: "pd.DataFrame") -> None:
    """Draw the trials of each pool by the surrogate, their front, and the finalists as measured.

    Parameters
    ----------
    file
        Where to write the picture, as PNG.
    views
        One panel each.
    finals
        The finalists, with columns ``pool`` and those of `MISFITS`.
    """
    picture = require("matplotlib.figure", "fit").Figure((7.0, 3.4), dpi=150, layout="constrained")
    panels = picture.subplots(1, len(views), sharex=True, sharey=True, squeeze=False)[0]
    without, led, jamming = GROUPS
    for axes, view in zip(panels, views, strict=True):
        costs = np.minimum(view.costs[: view.trials], _WORST)
        front = front_ranks(view.costs[: view.trials], 1) == 0
        style = {"vmin": 0.0, "vmax": _WORST / 2, "cmap": "viridis"}
        axes.scatter(costs[:, 0], costs[:, 1], c=costs[:, 2], s=4, alpha=0.5, lw=0, **style)
        points = axes.scatter(
            costs[front, 0],
            costs[front, 1],
            c=costs[front, 2],
            s=22,
            edgecolors="black",
            linewidths=0.6,
            label="front",
            **style,
        )
        own = finals[finals["pool"] == view.pool]
        axes.scatter(
            own[MISFITS[0]].clip(upper=_WORST),
            own[MISFITS[1]].clip(upper=_WORST),
            c=own[MISFITS[2]],
            s=70,
            marker="*",
            edgecolors="red",
            linewidths=0.8,
            label="finalists, as measured",
            **style,
        )
        axes.set(title=view.pool, xlabel=f"misfit, {without}", xlim=(0, None), ylim=(0, None))
    panels[0].set_ylabel(f"misfit, {led}")
    panels[0].legend(loc="upper right", fontsize=7)
    picture.colorbar(points, ax=panels, label=f"misfit, {jamming}")
    # Without the version of matplotlib, the same picture is the same bytes.
    picture.savefig(file, format="png", metadata={"Software": None})
