"""Statistics of whole runs, one row each: means, ordering times, lines, and their intervals."""

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from flockenv.recording import Recording
from flockenv.reproduce.reproduction import Results
from flockenv.runs.spec import RunSpec
from flockenv.statistics.intervals import Line, fit_line, grouped_replicates

__all__ = ["WIDE", "line_or_none", "resampled", "run_rows"]

WIDE = np.pi / 4
"""The wider angle that ordering times are also measured with; eq. (7) has π/20."""


def run_rows(
    results: Results,
    points: Sequence[Sequence[RunSpec]],
    x_name: str,
    x: Sequence[float],
    setup: str,
) -> pd.DataFrame:
    """Return one row per run.

    Columns: ``setup``, `x_name`, ``seed``, mean and standard deviation of Ψ_o over the analyzed
    frames, mean Ψ_o after ordering, and ordering times of eq. (7) with π/20 (``ordering_s``) and
    with π/4 (``ordering_wide_s``); times are infinite for runs that do not order.
    """
    rows = []
    for place, specs in zip(x, points, strict=True):
        for spec in specs:
            rows.append({"setup": setup, x_name: place, "seed": spec.seed, **_row(results[spec])})
    return pd.DataFrame(rows)


def _row(run: Recording) -> dict[str, float]:
    order, used = run.order, run.analyzed().order
    wide = order.ordering_time(run.time_s, WIDE)
    after = order.psi_o[run.time_s >= wide]
    return {
        "psi_o": float(used.psi_o.mean()),
        "psi_o_std": float(used.psi_o.std()),
        "ordering_s": order.ordering_time(run.time_s),
        "ordering_wide_s": wide,
        "psi_o_after": float(after.mean()) if len(after) else float("nan"),
    }


def resampled(
    runs: pd.DataFrame,
    by: str,
    statistic: Callable[[pd.DataFrame], float],
    seed: int = 0,
) -> NDArray[np.float64]:
    """Return a statistic of the runs as they are, then of runs resampled within each group.

    Returns
    -------
    float64 array, shape (RESAMPLES + 1,)
        As `flockenv.statistics.intervals.interval` takes it.
    """
    groups = [np.flatnonzero(runs[by] == value) for value in runs[by].unique()]
    return grouped_replicates(groups, lambda places: statistic(runs.iloc[places]), seed)


def line_or_none(x: "pd.Series[float]", y: "pd.Series[float]") -> Line | None:
    """Return the line through points whose y is finite, None where there are too few."""
    known = np.isfinite(y)
    try:
        return fit_line(x[known], y[known])
    except ValueError:
        return None
