"""What `transition-order` measures: runs at one density from two starts, and loops."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flockenv.recording import Recording
from flockenv.reproduce.order_statistics import block_length_s
from flockenv.reproduce.transition.design import STARTED, Growth, TransitionDesign
from flockenv.runs.protocols.hysteresis import loop_position
from flockenv.statistics.block_bootstrap import block_sums, block_sums_resampled
from flockenv.statistics.dwell_times import DwellTimes, dwell_times
from flockenv.statistics.intervals import RESAMPLES, mean_replicates, student_interval
from flockenv.statistics.structure import jam_sizes

__all__ = [
    "CENTERS",
    "C_V_EDGES",
    "FEWEST_CHANGES",
    "JAMMED_ABOVE",
    "MANY_BOATS",
    "M_EDGES",
    "NUCLEUS",
    "ROTATING_BELOW",
    "STATES",
    "Jams",
    "Lifetime",
    "Loops",
    "Measured",
    "Stationary",
    "binder",
    "hysteresis",
    "lifetime",
    "states",
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


STATES = ("rotating", "jammed")
"""States of a whole flock."""

JAMMED_ABOVE, ROTATING_BELOW = 0.6, 0.3
"""Ψ_o cos φ_o of a flock that has jammed and of one that has left the jam, averaged over 30 s."""

_SMOOTHED_S = 30.0

FEWEST_CHANGES = 3
"""Changes out of each state from which a lifetime counts."""


def states(time_s: NDArray[np.float64], outward: NDArray[np.float64]) -> NDArray[np.str_]:
    """Return the state of each sample, one of `STATES`.

    A flock jams when Ψ_o cos φ_o, averaged over the last 30 s, exceeds `JAMMED_ABOVE`, and rotates
    again when it is below `ROTATING_BELOW`. The first state is the one that is nearer.
    """
    sums = np.append(0.0, np.cumsum(outward))
    last = np.arange(1, len(outward) + 1)
    first = np.searchsorted(time_s, time_s - _SMOOTHED_S, "right")
    smooth = (sums[last] - sums[first]) / (last - first)
    jams = np.where(smooth > JAMMED_ABOVE, 1, np.where(smooth < ROTATING_BELOW, 0, -1))
    if jams[0] < 0:
        jams[0] = smooth[0] > (JAMMED_ABOVE + ROTATING_BELOW) / 2
    known = np.maximum.accumulate(np.where(jams >= 0, np.arange(len(jams)), 0))
    return np.array(STATES)[jams[known]]


def binder(m2: NDArray[np.float64], m4: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return Binder's cumulant 1 - <m⁴>/(3<m²>²); NaN where <m²> is 0."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(1.0 - m4 / (3.0 * m2**2))


MANY_BOATS = 200
"""Boats from which a flock has room for several jams, at the densities of the study."""


NUCLEUS = 10
"""Fewest boats of a first jam."""


class Jams:
    """Jams of runs at one density, shares and sizes in their second halves.

    See `statistics.structure.jam_sizes`.

    Attributes
    ----------
    first_s : float64 array, shape (runs,)
        When a run has a jam of at least `NUCLEUS` boats for the first time; NaN if it never has.
    dissolved_s : float64 array, shape (runs,)
        When a run's largest jam has fewer than half of its boats for the first time; NaN if it
        always has more.
    share : float64 array, shape (runs,)
        Part of the boats in jams.
    mean_size : float64 array, shape (runs,)
        Boats of the jam that a boat in a jam is in, on average; 0 without jams.
    largest : float64 array, shape (runs,)
        Boats of the largest jam of a frame, on average.
    """

    def __init__(self, runs: Sequence[Recording]) -> None:
        rows, firsts, lasts = [], [], []
        for run in runs:
            every = jam_sizes(run.parameters, run.pose)
            most = np.array([sizes.max(initial=0) for sizes in every])
            firsts.append(_first_s(run, most >= NUCLEUS))
            lasts.append(_first_s(run, most < run.parameters.n_boats / 2))
            used = run.analyzed(after=0.5)
            frames = [every[place] for place in np.searchsorted(run.time_s, used.time_s)]
            boats = sum(int(sizes.sum()) for sizes in frames)
            pairs = sum(int((sizes**2).sum()) for sizes in frames)
            largest = np.mean([sizes.max(initial=0) for sizes in frames])
            share = boats / (len(frames) * used.parameters.n_boats)
            rows.append((share, pairs / max(boats, 1), largest))
        self.first_s, self.dissolved_s = np.array([firsts, lasts], np.float64)
        self.share, self.mean_size, self.largest = np.array(rows, np.float64).T


def _first_s(run: Recording, when: NDArray[np.bool_]) -> float:
    return float(run.time_s[when.argmax()]) if when.any() else math.nan


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
    dwell : DwellTimes
        Stays in `states`, over all samples and not the second halves alone.
    jams : Jams
        Jams of the runs.
    """

    def __init__(self, runs: Sequence[Recording], draws_seed: int) -> None:
        outward, blocks, ms, c_vs = [], [], [], []
        series = [states(run.time_s, run.order.outward()) for run in runs]
        times = runs[0].time_s
        self.dwell = dwell_times(series, STATES, float((times[-1] - times[0]) / (len(times) - 1)))
        self.jams = Jams(runs)
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


@dataclass(frozen=True, slots=True)
class Lifetime:
    """How long flocks stay in both states at the density where they leave both most alike.

    Attributes
    ----------
    density : int
        That density.
    dwell : DwellTimes
        Stays of the runs from both starts there.
    log_s : float64 array, shape (RESAMPLES + 1,)
        Logarithm of the geometric mean of both mean dwell times in s: as measured, with half a
        change added to each count, and drawn from the Gamma distribution of each rate.
    """

    density: int
    dwell: DwellTimes
    log_s: NDArray[np.float64]


def lifetime(dwells: Mapping[int, DwellTimes], draws_seed: int) -> Lifetime:
    """Return the lifetime at coexistence, given the stays at each density.

    The counts of changes are Poisson's, and the prior of the rates is that of Jeffreys.
    """

    def unlike(density: int) -> float:
        rates = _changes(dwells[density]) / np.maximum(dwells[density].time_s, 1.0)
        return float(abs(np.log(rates[0] / rates[1])))

    density = min(dwells, key=unlike)
    dwell = dwells[density]
    rng = np.random.default_rng(draws_seed)
    drawn = rng.gamma(_changes(dwell), size=(RESAMPLES, 2))
    rates = np.vstack([_changes(dwell), drawn]) / np.maximum(dwell.time_s, 1.0)
    return Lifetime(density, dwell, -np.log(rates).mean(axis=1))


def _changes(dwell: DwellTimes) -> NDArray[np.float64]:
    return np.asarray(dwell.changes.sum(axis=1) + 0.5)


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
    fine : dict of Jams
        Of the runs at `FINE_DT_S`, by size, density and start.
    """

    design: TransitionDesign
    stationary: dict[tuple[Growth, int, str], Stationary]
    loops: dict[tuple[Growth, str], Loops]
    fine: dict[tuple[Growth, int, str], Jams]

    def gap(self, growth: Growth, density: int) -> Ends:
        """Return the difference of Ψ_o cos φ_o between the two starts, seed by seed."""
        rotating, jammed = (self.stationary[growth, density, start].outward for start in STARTED)
        return student_interval(jammed - rotating)

    def lifetime(self, growth: Growth) -> Lifetime:
        """Return how long flocks of a size stay in both states at coexistence."""
        dwells = {}
        for density in self.design.densities[growth.way]:
            first, second = (self.stationary[growth, density, start].dwell for start in STARTED)
            dwells[density] = first + second
        return lifetime(dwells, growth.n_boats)

    def lifetime_growth(self, way: str) -> tuple[NDArray[np.float64], list[int]]:
        """Return by how much the logarithm of the lifetime grows per doubling of the flock.

        Returns
        -------
        slope : float64 array, shape (RESAMPLES + 1,)
            Of a straight line, with its replicates; NaN for less than three sizes.
        sizes : list of int
            Those with at least `FEWEST_CHANGES` out of each state, which the line is through.
        """
        found = {each.n_boats: self.lifetime(each) for each in self.design.growths(way)}
        known = {
            n: each
            for n, each in found.items()
            if each.dwell.changes.sum(axis=1).min() >= FEWEST_CHANGES
        }
        return _slope(np.log2(list(known)), [each.log_s for each in known.values()]), list(known)

    def jam_growth(self, way: str, density: int) -> NDArray[np.float64]:
        """Return the exponent b of the mean size of jams, proportional to n^b.

        Returns
        -------
        float64 array, shape (RESAMPLES + 1,)
            Slope of a straight line through the logarithms at sizes of at least `MANY_BOATS`, of
            the runs from both starts, with its replicates over runs; NaN for less than three sizes.
        """
        growths = [each for each in self.design.growths(way) if each.n_boats >= MANY_BOATS]
        logs = []
        for growth in growths:
            sizes = self._jam_size(growth, density, *STARTED)
            logs.append(np.log(np.where(sizes > 0.0, sizes, math.nan)))
        return _slope(np.log([growth.n_boats for growth in growths]), logs)

    def dissolution_growth(self, way: str, density: int) -> NDArray[np.float64]:
        """Return the exponent of the time until one jam has lost half of its boats.

        Returns
        -------
        float64 array, shape (RESAMPLES + 1,)
            As of `jam_growth`, of geometric means; NaN where a jam did not dissolve in every run.
        """
        growths = [each for each in self.design.growths(way) if each.n_boats >= MANY_BOATS]
        runs = [self.stationary[growth, density, "one-jam"].jams for growth in growths]
        logs = [
            mean_replicates(np.log(jams.dissolved_s), growth.n_boats)
            for growth, jams in zip(growths, runs, strict=True)
        ]
        return _slope(np.log([growth.n_boats for growth in growths]), logs)

    def memory(self, growth: Growth, density: int) -> NDArray[np.float64]:
        """Return the mean size of jams from rotation over that from one jam.

        Returns
        -------
        float64 array, shape (RESAMPLES + 1,)
            With its replicates over seeds, which are drawn alike for both starts; 0 without jams
            from rotation, NaN without any from one.
        """
        rotating, one_jam = (self._jam_size(growth, density, start) for start in STARTED)
        return rotating / np.where(one_jam > 0.0, one_jam, math.nan)

    def _jam_size(self, growth: Growth, density: int, *starts: str) -> NDArray[np.float64]:
        """Return the mean size of jams of all runs, with replicates; 0 without jams."""
        boats, pairs = np.zeros((2, RESAMPLES + 1))
        for place, start in enumerate(starts):
            jams = self.stationary[growth, density, start].jams
            # The same seed draws the same runs for both.
            boats += mean_replicates(jams.share, growth.n_boats + place)
            pairs += mean_replicates(jams.share * jams.mean_size, growth.n_boats + place)
        return np.asarray(pairs / np.where(boats > 0.0, boats, 1.0))


def _slope(
    x: NDArray[np.float64], replicates: Sequence[NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Return the slopes of straight lines through at least three points."""
    if len(x) < 3:
        return np.full(RESAMPLES + 1, math.nan)
    x = x - x.mean()
    return np.asarray(x @ np.array(replicates) / (x @ x))
