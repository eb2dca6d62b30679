"""Calibration targets: numbers of the paper's experiment, and the same numbers in simulation.

Each `Target` has a value, computed from seeded runs of single boats and of 27 boats, and a range
that the paper gives for it. Where the paper's words leave the range open, `Target.statement` states
how they are read.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv._io.extras import require
from flockenv.calibration.flock_runs import GUIDED_S, FlockRuns

__all__ = [
    "BOAT_TARGETS",
    "GROUPS",
    "MISFITS",
    "SEARCHED_TARGETS",
    "TARGETS",
    "Target",
    "measure",
    "misfits",
]

GROUPS = ("no leaders", "leaders", "jamming")
"""Groups of targets whose misfits are weighed against each other."""

MISFITS = tuple(f"misfit_{group.replace(' ', '_')}" for group in GROUPS)
"""Columns of tables with those misfits."""

_MOVING = 10.0
"""C_v in cm²/s² above which a flock moves together: of 15² where all boats do."""

_SETS = 1000
_SET_RUNS = 4

Value = Callable[[FlockRuns], float]


@dataclass(frozen=True, slots=True)
class Target:
    """A number of the experiment with its accepted range.

    Attributes
    ----------
    key, name, source, statement : str
        Short name, full name, place in the paper, and reading of the paper's words.
    group : str
        "boat", for a boat alone, or one of `GROUPS`.
    low, high : float
        The accepted range.
    aim : float
        The value with residual 0.
    tolerance : float
        Unit of the residual.
    value : callable
        Computes the value from flock runs; None where it is a number of a single boat.
    is_searched : bool
        Whether the runs of a trial determine it.
    """

    key: str
    name: str
    source: str
    statement: str
    group: str
    low: float
    high: float
    aim: float
    tolerance: float
    value: Value | None
    is_searched: bool = True

    def residual(self, values: ArrayLike) -> NDArray[np.float64]:
        """Return distances from the aim in tolerances; 3 for an undefined value.

        The residual of a one-sided target (whose aim is an end of its range) is 0 in its range.
        """
        values = np.asarray(values, np.float64)
        if self.aim in (self.low, self.high):
            away = np.maximum(np.maximum(self.low - values, values - self.high), 0.0)
        else:
            away = abs(values - self.aim)
        return np.where(np.isnan(values), 3.0, away / self.tolerance)

    def penalty(self, values: ArrayLike) -> NDArray[np.float64]:
        """Return ρ(residual): r² up to 2 tolerances and 4r - 4 beyond.

        One distant target then does not dominate a misfit.
        """
        away = self.residual(values)
        return np.where(away < 2.0, away**2, 4.0 * away - 4.0)

    def is_in_range(self, value: float) -> bool:
        """Return whether a value lies in the range; an undefined one does not."""
        return bool(self.low <= value <= self.high)


def _level(leaders: int, quantity: str, *at_s: float) -> Value:
    return lambda runs: _mean(runs.mean(leaders, quantity, at_s))


def _critical(leaders: int) -> Value:
    return lambda runs: runs.critical_bw_s(leaders)


def _ordered(leaders: int, quantity: str, *at_s: float) -> Value:
    return lambda runs: runs.of_ordered_frames(leaders, quantity, at_s)


def _ordering_slope(leaders: int) -> Value:
    return lambda runs: runs.ordering_slope(leaders)


def _gained(runs: FlockRuns) -> float:
    at_s = [GUIDED_S]
    return _mean(runs.mean(3, "psi_o", at_s)) - _mean(runs.mean(0, "psi_o", at_s))


def _dip(runs: FlockRuns) -> float:
    c_v = runs.mean(0, "c_v")
    return float(c_v[0] / c_v.max()) if c_v.max() > _MOVING else math.nan


def _mean(values: NDArray[np.float64]) -> float:
    return float(values.mean()) if len(values) else math.nan


def _passed(runs: FlockRuns) -> float:
    """Return the share of sets of 20 runs whose line rises with p ≤ 0.01; NaN without 0 to 4."""
    leaders, psi_o = runs.guided_psi_o()
    counts = np.unique(leaders)
    if len(counts) < 5:
        return math.nan
    rng = np.random.default_rng(0)
    drawn = np.hstack([rng.choice(psi_o[leaders == k], (_SETS, _SET_RUNS)) for k in counts])
    x = np.repeat(counts, _SET_RUNS)
    stats = require("scipy.stats", "fit")
    correlation = stats.pearsonr(np.broadcast_to(x, drawn.shape), drawn, axis=1)
    passed = (correlation.pvalue <= 0.01) & (correlation.statistic > 0.0)
    return float(passed.mean())


def _targets() -> Iterator[Target]:
    inf = math.inf
    yield Target(
        "forward_cm_s",
        "forward speed [cm/s]",
        "Table 1",
        "a boat in open water, motor forward: 15 ± 5",
        "boat",
        *(10.0, 20.0, 15.0, 5.0),
        None,
    )
    yield Target(
        "forward_turn_rad_s",
        "forward turn [rad/s]",
        "Section 4.5",
        "a slight bias, counter-clockwise: a boat in open water, motor forward, turns at most in a "
        "circle of 150 cm at 15 cm/s",
        "boat",
        *(-0.1, 0.1, 0.0, 0.1),
        None,
    )
    yield Target(
        "backing_turn_rad_s",
        "backing turn [rad/s]",
        "Table 1",
        "mean |turning rate| of a boat in open water, motor backward: 1 ± 0.2",
        "boat",
        *(0.8, 1.2, 1.0, 0.2),
        None,
    )
    yield Target(
        "backing_over_forward",
        "backing speed / forward speed",
        "Section 3.2",
        "«much smaller» velocities in bw, read as at most a half (peaks, bw = 1.4 s)",
        "boat",
        *(0.0, 0.5, 0.5, 0.1),
        None,
    )
    for leaders, aim, group in ((0, 1.4, "no leaders"), (3, 2.0, "leaders")):
        yield Target(
            f"critical_bw_{leaders}",
            f"critical bw, {leaders} leaders [s]",
            "Figure 9",
            f"mean Ψ_o falls through 0.56 near {aim} s, read as ± 0.1",
            group,
            *(aim - 0.1, aim + 0.1, aim, 0.1),
            _critical(leaders),
        )
        yield Target(
            f"low_noise_{leaders}",
            f"Ψ_o at low noise, {leaders} leaders",
            "Figure 10",
            "«Ψ_o ≈ 1», read as mean Ψ_o ≥ 0.9 at bw = 0.6 and 1.0 s",
            group,
            *(0.9, 1.0, 0.9, 0.1),
            _level(leaders, "psi_o", 0.6, 1.0),
        )
    for leaders, bw_s, group in ((0, 2.2, "no leaders"), (3, 2.6, "leaders")):
        yield Target(
            f"high_noise_{leaders}",
            f"Ψ_o at high noise, {leaders} leaders",
            "Figure 10, Section 4.3",
            f"disorder above 2 s, Ψ_o < 0.3: mean Ψ_o at bw = {bw_s} s",
            group,
            *(0.0, 0.3, 0.3, 0.1),
            _level(leaders, "psi_o", bw_s),
            is_searched=leaders == 0,
        )
    yield Target(
        "off_tangent",
        "φ_o off the tangent when ordered [rad]",
        "Eq. (7), figure 9",
        "mean ||φ_o| - π/2| ≤ π/20 over the ordered frames at bw = 0.6 to 1.4 s, no leaders",
        "no leaders",
        *(0.0, math.pi / 20, math.pi / 20, math.pi / 40),
        _ordered(0, "off_tangent", 0.6, 1.0, 1.2, 1.4),
    )
    yield Target(
        "ordered",
        "ordered motion regular, no leaders",
        "Table 2",
        "«regular» at low to middle noise: ordered in at least half of the frames at 1.0 and 1.2 s",
        "no leaders",
        *(0.5, 1.0, 0.5, 0.1),
        _level(0, "ordered", 1.0, 1.2),
    )
    yield Target(
        "jamming",
        "jamming, no leaders",
        "Table 2, figure 9",
        "occasional at low noise: of the frames at bw = 0.4 and 0.6 s, read as 0.5 % to 30 %",
        "jamming",
        *(0.005, 0.3, 0.1, 0.1),
        _level(0, "jammed", 0.4, 0.6),
    )
    yield Target(
        "velocity_dip",
        "C_v at bw = 0.4 s over its maximum, no leaders",
        "Figure 11",
        "low velocity correlation at very low noise, read as at most half of the maximum",
        "jamming",
        *(0.0, 0.5, 0.5, 0.1),
        _dip,
    )
    for leaders in (0, 3):
        yield Target(
            f"ordering_slope_{leaders}",
            f"slope of the ordering time, {leaders} leaders [s/s]",
            "Figure 8",
            "the ordering time of eq. (7) falls with bw",
            "jamming",
            *(-inf, 0.0, 0.0, 50.0),
            _ordering_slope(leaders),
        )
    yield Target(
        "leaders_direction",
        "ordered in the leaders' direction",
        "Section 4.2, figure 9",
        "«only CW in the CW-guided experiments»: ≥ 0.95 of the ordered frames at 1.4 and 1.8 s",
        "leaders",
        *(0.95, 1.0, 0.95, 0.1),
        _ordered(3, "along_target", 1.4, 1.8),
    )
    yield Target(
        "leaders_gain",
        "gain of Ψ_o by 3 leaders at 1.8 s",
        "Figure 12",
        "more leaders, more order: mean Ψ_o with three leaders minus that without, above 0",
        "leaders",
        *(0.0, inf, 0.0, 0.1),
        _gained,
    )
    yield Target(
        "following",
        "signed order with alternating leaders",
        "Figure 7",
        "«with high efficiency»: mean Ψ_o cos(φ_o − φ_target) ≥ 0.5 in the second halves of the "
        "stretches, 3 leaders, bw = 1.8 s",
        "leaders",
        *(0.5, 1.0, 0.5, 0.1),
        lambda runs: _mean(runs.alternating("following").ravel()),
    )
    yield Target(
        "leaders_slope",
        "Ψ_o per leader at 1.8 s",
        "Figure 12",
        "F = 13.5 over 20 runs is a slope of 0.58 standard deviations of a run's Ψ_o; read with "
        "0.12 as that deviation: at least 0.07 per leader",
        "leaders",
        *(0.07, inf, 0.07, 0.03),
        lambda runs: runs.leaders_slope(),
    )
    yield Target(
        "leaders_test",
        "sets of 20 runs with p ≤ 0.01",
        "Figure 12",
        "p = 0.002 in the paper: the line of Ψ_o against 0 to 4 leaders rises with p ≤ 0.01 in at "
        "least 80 % of sets of 20 eight-minute runs, four per number of leaders, at 1.8 s",
        "leaders",
        *(0.8, 1.0, 0.8, 0.2),
        _passed,
        is_searched=False,
    )


TARGETS = tuple(_targets())
"""All calibration targets."""

BOAT_TARGETS = tuple(target for target in TARGETS if target.value is None)
"""Those of a boat alone."""

SEARCHED_TARGETS = tuple(target for target in TARGETS if target.value and target.is_searched)
"""Those that the flocks of a trial determine."""


def measure(boat: Mapping[str, float], runs: FlockRuns) -> dict[str, float]:
    """Return the value of every target by its key."""
    return {
        target.key: boat[target.key] if target.value is None else target.value(runs)
        for target in TARGETS
    }


def misfits(
    values: Mapping[str, ArrayLike], targets: Sequence[Target] = TARGETS
) -> NDArray[np.float64]:
    """Return the mean penalty of each of `GROUPS`, of values or of arrays of them: last axis 3."""
    means = []
    for group in GROUPS:
        own = [each.penalty(values[each.key]) for each in targets if each.group == group]
        means.append(np.mean(own, axis=0))
    return np.stack(means, axis=-1)
