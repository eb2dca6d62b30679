"""The runs of figures 8 to 11: 27 boats of the preset `experiment`, none or three of them lead."""

from typing import Any

import numpy as np
import pandas as pd

from studies.order import order_row
from studies.study import SEEDS, Row, Study, simulated

LEVELS_S = tuple(round(0.2 * place, 1) for place in range(15))
"""Backward durations from 0 to 2.8 s; the paper's begin at 0.4 s."""

FREE, CCW, CW = "no leaders", "3 leaders, CCW", "3 leaders, CW"
LOST_S = {FREE: 1.4, CCW: 2.0, CW: 2.0}
"""Backward durations at which the paper's flocks lose their order (caption of figure 9)."""
SETUPS: dict[str, tuple[int, str]] = {FREE: (0, "cw"), CCW: (3, "ccw"), CW: (3, "cw")}
READING = "experiment (leapfrog, white), narrow, n = 27"
LOW_S, MEDIUM_S, HIGH_S = (0.0, 0.8), (1.0, 1.6), (1.8, 2.8)
"""Ranges of noise of every statement that names low, medium or high noise; none is left out."""
VERY_LOW_S = (0.0, 0.4)
"""Very low noise; the paper's noises begin at 0.4 s."""


def words(ends: tuple[float, float]) -> str:
    """Return a range of noises in words."""
    return f"bw {ends[0]:g} to {ends[1]:g} s"


def design() -> list[Row]:
    """Return runs of 8 minutes, the length of the paper's, those without leaders first."""
    return [
        {"preset": "experiment", "n_leaders": leaders, "target": target, "bw_s": bw_s}
        | {"minutes": 8.0, "seed": seed}
        for leaders, target in (SETUPS[name] for name in (FREE, CW, CCW))
        for seed in range(SEEDS)
        for bw_s in LEVELS_S
    ]


def measure(row: Row) -> Row:
    """Return the order of a run, and when it orders by eq. (7), at the printed angle and at π/4."""
    run = simulated(row)
    late = run.analyzed(0.5).order
    return {
        **order_row(run),
        "psi_o_late": late.psi_o.mean(),
        "ordered_s": run.order.ordering_time(run.time_s),
        "ordered_quarter_s": run.order.ordering_time(run.time_s, within=np.pi / 4),
    }


STUDY = Study("section4/section4", design, measure)


def setup(table: pd.DataFrame, name: str) -> pd.DataFrame:
    """Return the runs of a setup, of the seeds that have been run at every noise."""
    leaders, target = SETUPS[name]
    found = table[(table["n_leaders"] == leaders) & (table["target"] == target)]
    noises = found.groupby("seed")["bw_s"].transform("size")
    return found[noises == noises.max()]


def within(runs: pd.DataFrame, least: float, most: float = 9.0) -> pd.DataFrame:
    """Return the runs at noises of a range."""
    return runs[runs["bw_s"].between(least - 1e-9, most + 1e-9)]


def at(runs: pd.DataFrame, *columns: str) -> list[Any]:
    """Return arrays of shape (runs, columns), one per noise."""
    return [each[list(columns)].to_numpy(float) for _, each in runs.groupby("bw_s")]


def over(runs: pd.DataFrame, column: str, least: float, most: float = 9.0) -> Any:
    """Return the mean of a column over the noises of a range, one value per seed.

    A seed's runs at several noises share their random streams, so that the seed counts once.
    """
    return within(runs, least, most).groupby("seed")[column].mean().to_numpy()
