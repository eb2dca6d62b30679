"""Statistics of the order parameters over runs of a series, as measured and as resampled."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flockenv.recording import Recording
from flockenv.reproduce.reproduction import Results
from flockenv.runs.spec import RunSpec
from flockenv.statistics.block_bootstrap import block_places, block_sums, block_sums_resampled

__all__ = [
    "PHI_EDGES",
    "PSI_EDGES",
    "OrderStatistics",
    "block_length_s",
]

PHI_EDGES = np.linspace(-np.pi, np.pi, 37)
"""Edges of the bins of φ_o in rad, 10° each."""

PSI_EDGES = np.linspace(0.0, 1.0, 26)
"""Edges of the bins of Ψ_o."""

_PEAK_HALF_WIDTH = np.pi / 12


def block_length_s(duration_s: float) -> float:
    """Return the length of the bootstrap's blocks: 2 minutes, a tenth of runs below 20 minutes."""
    return min(120.0, duration_s / 10)


_PLAIN = ("frames", "psi_o", "psi_o²", "c_v", "c_v²", "rotating", "cw", "jammed", "near_zero")


def _blocks(run: Recording) -> NDArray[np.float64]:
    """Sum what is counted of a run over its blocks: shape (b, q)."""
    used = run.analyzed()
    order = used.order
    psi, phi, c_v = order.psi_o, order.phi_o, order.c_v
    states = order.states(run.parameters.speed_cm_s)
    cw = states == "ordered cw"
    columns = [
        np.ones(len(psi)),
        psi,
        psi**2,
        c_v,
        c_v**2,
        cw | (states == "ordered ccw"),
        cw,
        states == "jamming",
        abs(phi) < _PEAK_HALF_WIDTH,
    ]
    times, length = used.time_s, block_length_s(run.duration_s)
    place = block_places(times, length)
    bins = [_counts(place, phi, PHI_EDGES), _counts(place, psi, PSI_EDGES)]
    return np.hstack([block_sums(times, np.stack(columns, axis=1), length), *bins])


def _counts(
    place: NDArray[np.int64], values: NDArray[np.float64], edges: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Count values by block and bin: shape (blocks, bins)."""
    bins = len(edges) - 1
    # Single precision may put φ_o or Ψ_o beyond the last edge by a rounding.
    column = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, bins - 1)
    shape = (int(place[-1]) + 1, bins)
    return np.bincount(place * bins + column, minlength=shape[0] * bins).reshape(shape)


class _Point:
    """One point of a series: sums over its runs, as they are and resampled, and over each run."""

    def __init__(self, runs: Sequence[Recording], draws_seed: int) -> None:
        blocks = [_blocks(run) for run in runs]
        self.sums = block_sums_resampled(blocks, draws_seed)
        self.run_sums = np.stack([each.sum(axis=0) for each in blocks])


@dataclass(frozen=True, slots=True, eq=False)
class OrderStatistics:
    """Sums over the analyzed frames of a series of p points, each of some runs.

    Every method's result has r replicates along axis 1: first as measured, then as resampled by
    `flockenv.statistics.intervals`, independently at each point.

    Attributes
    ----------
    x : float64 array, shape (p,)
        Where the points are: backward durations in s or numbers of boats.
    sums : float64 array, shape (p, r, q)
        Sums over the runs of a point.
    run_sums : list of float64 arrays, shape (runs, q)
        Sums over each run of each point.
    """

    x: NDArray[np.float64]
    sums: NDArray[np.float64]
    run_sums: list[NDArray[np.float64]]

    @classmethod
    def of(
        cls, results: Results, x: Sequence[float], points: Sequence[Sequence[RunSpec]]
    ) -> "OrderStatistics":
        """Return the statistics of a series."""
        found = [results.derive(_Point, tuple(specs), specs[0].draws_seed) for specs in points]
        return cls(
            np.asarray(x, float),
            np.stack([point.sums for point in found]),
            [point.run_sums for point in found],
        )

    def mean(self, name: str) -> NDArray[np.float64]:
        """Return the mean of "psi_o" or "c_v", or a share of the frames.

        Shares are those "rotating" and "jammed", the ordered and the jamming states of
        `flockenv.flock.OrderSeries.states`, and "near_zero": φ_o within π/12 of 0.
        """
        return self._sum(name) / self._sum("frames")

    def deviation(self, name: str) -> NDArray[np.float64]:
        """Return the standard deviation of "psi_o" or "c_v" over the frames."""
        return np.sqrt(np.maximum(self.mean(f"{name}²") - self.mean(name) ** 2, 0.0))

    def share(self, name: str, of: str, where: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return the share of one kind of frames among another, over points `where`: (r,)."""
        of_all = self._sum(of)[where].sum(axis=0)
        with np.errstate(invalid="ignore"):
            return np.asarray(self._sum(name)[where].sum(axis=0) / of_all)

    def density(self, name: str) -> NDArray[np.float64]:
        """Return the probability density of "phi_o" (1/rad) or "psi_o", shape (p, r, bins)."""
        first = len(_PLAIN) + (0 if name == "phi_o" else len(PHI_EDGES) - 1)
        edges = PHI_EDGES if name == "phi_o" else PSI_EDGES
        counts = self.sums[:, :, first : first + len(edges) - 1]
        return np.asarray(counts / self._sum("frames")[:, :, None] / np.diff(edges))

    def runs_by_direction(self) -> tuple[int, int]:
        """Count runs that rotate for most of their time: those mostly clockwise, and all."""
        runs = np.concatenate(self.run_sums)
        frames, rotating, cw = (
            runs[:, _PLAIN.index(name)] for name in ("frames", "rotating", "cw")
        )
        steady = rotating > frames / 2
        return int((steady & (cw > rotating / 2)).sum()), int(steady.sum())

    def _sum(self, name: str) -> NDArray[np.float64]:
        return self.sums[:, :, _PLAIN.index(name)]
