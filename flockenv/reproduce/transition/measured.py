"""What `transition-order` measures: runs at one density from two starts, and loops."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flockenv.recording import Recording
from flockenv.reproduce.order_statistics import block_length_s
from flockenv.reproduce.transition.design import Growth, TransitionDesign
from flockenv.runs.protocols.hysteresis import loop_position
from flockenv.runs.protocols.initial_state import STARTS
from flockenv.statistics.intervals import block_sums, block_sums_resampled, student_interval

__all__ = [
    "CENTERS",
    "C_V_EDGES",
    "M_EDGES",
    "Loops",
    "Measured",
    "Stationary",
    "binder",
    "hysteresis",
]

Ends = tuple[float, float, float]
"""A value and the ends of its interval."""

M_EDGES = np.linspace(-1.0, 1.0, 42)
"""Edges of the bins of m."""

C_V_EDGES = np.linspace(-50.0, 225.0, 45)
"""Edges of the bins of C_v in cm²/s²."""

_LOOP_BINS = 12
CENTERS = (np.arange(_LOOP_BINS) + 0.5) / _LOOP_BINS
"""Positions in a loop at which its branches are averaged."""


def binder(m2: NDArray[np.float64], m4: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return Binder's cumulant 1 - <m⁴>/(3<m²>²); NaN where <m²> is 0."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(1.0 - m4 / (3.0 * m2**2))


class Stationary:
    """Runs at one density from one start, over the second half of each.

    Attributes
    ----------
    outward : float64 array, shape (runs,)
        Mean Ψ_o cos φ_o of each run.
    binder_m, binder_c_v : float64 array, shape (resamples + 1,)
        Binder's cumulants of m and C_v over all runs, as measured and as resampled.
    m_density, c_v_density : float64 array
        Histograms over `M_EDGES` and `C_V_EDGES`.
    """

    def __init__(self, runs: Sequence[Recording], draws_seed: int) -> None:
        outward, blocks, ms, c_vs = [], [], [], []
        for run in runs:
            used = run.analyzed(after=0.5)
            m, c_v = used.order.rotation(), used.order.c_v
            outward.append(used.order.outward().mean())
            powers = np.stack([np.ones(len(m)), m**2, m**4, c_v**2, c_v**4], axis=1)
            length = block_length_s(run.duration_s)
            blocks.append(block_sums(used.time_s, powers, length))
            ms.append(m)
            c_vs.append(c_v)
        sums = block_sums_resampled(blocks, draws_seed)
        means = (sums[:, 1:] / sums[:, :1]).T
        self.outward = np.array(outward)
        self.binder_m, self.binder_c_v = binder(means[0], means[1]), binder(means[2], means[3])
        self.m_density = _density(np.concatenate(ms), M_EDGES)
        self.c_v_density = _density(np.concatenate(c_vs), C_V_EDGES)


def _density(values: NDArray[np.float64], edges: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.histogram(values, edges)[0] / len(values) / np.diff(edges))


def hysteresis(run: Recording) -> NDArray[np.float64]:
    """Return mean Ψ_o cos φ_o on the way there and on the way back, by position in the loop.

    Returns
    -------
    float64 array, shape (2, 12)
        Of analyzed frames, from the loop's first parameters to its last; NaN in bins without any.
    """
    used = run.analyzed(after=0.0)
    position = loop_position(used.time_s, used.duration_s)
    place = np.minimum((position * _LOOP_BINS).astype(int), _LOOP_BINS - 1)
    there = used.time_s < used.duration_s / 2
    outward = used.order.outward()
    ways = []
    for way in (there, ~there):
        count = np.bincount(place[way], minlength=_LOOP_BINS)
        total = np.bincount(place[way], outward[way], minlength=_LOOP_BINS)
        with np.errstate(invalid="ignore"):
            ways.append(total / count)
    return np.array(ways)


class Loops:
    """Loops of some seeds.

    Attributes
    ----------
    there, back : float64 array, shape (12,)
        Mean branches.
    bands : float64 array, shape (2, 2, 12)
        By way there and back: lowest and highest of the runs.
    openings : float64 array, shape (runs,)
        By how much Ψ_o cos φ_o on the way back exceeds that on the way there, over the loop.
    at_turn : float64 array, shape (runs,)
        Mean Ψ_o cos φ_o around the loop's last parameters, on both ways.
    """

    def __init__(self, runs: Sequence[Recording]) -> None:
        branches = np.array([hysteresis(run) for run in runs])
        self.there, self.back = _known_mean(branches, 0)
        self.bands = np.stack([branches.min(axis=0), branches.max(axis=0)], axis=1)
        self.openings = _known_mean(branches[:, 1] - branches[:, 0], 1)
        self.at_turn = _known_mean(branches[:, :, -1], 1)


def _known_mean(values: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    """Mean without the undefined values; NaN where all are."""
    known = np.isfinite(values)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(known, values, 0.0).sum(axis) / known.sum(axis))


@dataclass(frozen=True, slots=True)
class Measured:
    """What was measured of a design.

    Attributes
    ----------
    design : TransitionDesign
        What was run.
    stationary : dict of Stationary
        By size, density and start.
    loops : dict of Loops
        By size and kind.
    """

    design: TransitionDesign
    stationary: dict[tuple[Growth, int, str], Stationary]
    loops: dict[tuple[Growth, str], Loops]

    def gap(self, growth: Growth, density: int) -> Ends:
        """Return the difference of Ψ_o cos φ_o between the two starts, seed by seed."""
        rotating, jammed = (self.stationary[growth, density, start].outward for start in STARTS)
        return student_interval(jammed - rotating)
