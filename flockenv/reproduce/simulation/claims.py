"""The claims of Section 5.2, each with the rule that judges it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binomtest

from flockenv.reproduce.claim import CheckedClaim, Claim
from flockenv.reproduce.order_statistics import OrderStatistics
from flockenv.reproduce.reproduction import Results, Settings
from flockenv.reproduce.simulation.design import Design, Model
from flockenv.runs.spec import RunSpec
from flockenv.statistics.intervals import CONFIDENCE, interval

__all__ = ["CLAIMS", "Evidence", "check", "critical_noise", "runs_needed"]

LOW_NOISE_S = 0.2
"""Levels of bw up to this are what claims about low noise are judged by."""

HIGH_NOISE_S = 1.0
"""Levels of bw from this on count as disordered."""

_NEAR = 3
_CRITICAL_RANGE = (0.6, 0.8)
_LEAST_FALL = 0.3

Replicates = NDArray[np.float64]


class Evidence:
    """The series of a model, each read when a claim first needs it."""

    def __init__(self, settings: Settings, results: Results, model: Model, design: Design) -> None:
        self._settings, self._results = settings, results
        self.model, self.design = model, design
        self._noise: dict[tuple[int, bool], OrderStatistics] = {}

    def noise(self, n_boats: int, with_leaders: bool) -> OrderStatistics:
        """Return the statistics against noise."""
        key = (n_boats, with_leaders)
        if key not in self._noise:
            points = self.design.noise_series(self._settings, self.model, *key)
            levels = self.design.levels_s
            self._noise[key] = OrderStatistics.of(self._results, levels, points)
        return self._noise[key]

    @cached_property
    def density(self) -> OrderStatistics:
        """The statistics against the number of boats at bw = 0."""
        points = self.design.density_series(self._settings, self.model)
        return OrderStatistics.of(self._results, self.design.densities, points)


def runs_needed(settings: Settings, model: Model, design: Design) -> list[RunSpec]:
    """Return all runs that `Evidence` may need."""
    series = [design.noise_series(settings, model, n, k) for n in (20, 50) for k in (False, True)]
    points = [point for each in (*series, design.density_series(settings, model)) for point in each]
    return [spec for point in points for spec in point]


@dataclass(frozen=True, slots=True)
class _Rule:
    figure: str
    claim: Claim
    measure: Callable[[Evidence], tuple[float, float, float]]


def check(evidence: Evidence, figures: Iterable[str]) -> list[CheckedClaim]:
    """Judge the claims about some figures for a model."""
    model = evidence.model
    scope = f"{model.name}, {model.pool}"
    figures = tuple(figures)
    return [
        rule.claim.check(*rule.measure(evidence), scope=scope)
        for rule in CLAIMS
        if rule.figure in figures
    ]


def _low(series: OrderStatistics) -> NDArray[np.bool_]:
    return series.x <= LOW_NOISE_S + 1e-9


def _high(series: OrderStatistics) -> NDArray[np.bool_]:
    return series.x >= HIGH_NOISE_S - 1e-9


def critical_noise(
    x: NDArray[np.float64], y: Replicates, disordered_s: float = HIGH_NOISE_S
) -> Replicates:
    """Where curves last fall through the middle between highest and disordered level.

    Parameters
    ----------
    x
        Backward durations in s, shape (p,).
    y
        Mean Ψ_o at each level, shape (p, r).
    disordered_s
        Levels from this on are taken for disordered.

    Returns
    -------
    float64 array, shape (r,)
        In s, by linear interpolation; NaN for curves that fall by less than 0.3.
    """
    top, bottom = y.max(axis=0), y[x >= disordered_s - 1e-9].mean(axis=0)
    middle = (top + bottom) / 2
    above = y > middle
    last = len(x) - 1 - above[::-1].argmax(axis=0)
    found = np.full(y.shape[1], np.nan)
    for place in np.flatnonzero((last < len(x) - 1) & (top - bottom > _LEAST_FALL)):
        i = last[place]
        share = (y[i, place] - middle[place]) / (y[i, place] - y[i + 1, place])
        found[place] = x[i] + share * (x[i + 1] - x[i])
    return found


def _critical(n_boats: int, with_leaders: bool) -> Callable[[Evidence], tuple[float, float, float]]:
    def measure(evidence: Evidence) -> tuple[float, float, float]:
        series = evidence.noise(n_boats, with_leaders)
        return interval(critical_noise(series.x, series.mean("psi_o")))

    return measure


def _low_noise_share(name: str, n_boats: int) -> Callable[[Evidence], tuple[float, float, float]]:
    def measure(evidence: Evidence) -> tuple[float, float, float]:
        series = evidence.noise(n_boats, False)
        return interval(series.share(name, "frames", _low(series)))

    return measure


def _directions(evidence: Evidence) -> tuple[float, float, float]:
    cw, steady = evidence.noise(20, False).runs_by_direction()
    if steady == 0:
        return float("nan"), float("nan"), float("nan")
    ends = binomtest(cw, steady).proportion_ci(CONFIDENCE, method="exact")
    return cw / steady, float(ends.low), float(ends.high)


def _led(n_boats: int) -> Callable[[Evidence], tuple[float, float, float]]:
    def measure(evidence: Evidence) -> tuple[float, float, float]:
        series = evidence.noise(n_boats, True)
        return interval(series.share("cw", "rotating", np.full(len(series.x), True)))

    return measure


def _peak_at_zero(evidence: Evidence) -> tuple[float, float, float]:
    value, low, high = _low_noise_share("near_zero", 50)(evidence)
    # The bin |φ_o| < π/12 is a twelfth of the circle.
    return 12 * value, 12 * low, 12 * high


def _fall(evidence: Evidence) -> tuple[float, float, float]:
    series = evidence.noise(20, False)
    mean = series.mean("psi_o")
    return interval(mean[_low(series)].mean(axis=0) - mean[_high(series)].mean(axis=0))


def _steepest(evidence: Evidence) -> tuple[float, float, float]:
    series = evidence.noise(20, False)
    mean = series.mean("psi_o")
    step = int(np.argmin(abs(series.x - 0.1)))
    steepest = (mean[:-step] - mean[step:]).max(axis=0)
    total = mean.max(axis=0) - mean.min(axis=0)
    return interval(np.where(total > _LEAST_FALL, steepest / total, np.nan))


def _best(name: str) -> Callable[[Evidence], tuple[float, float, float]]:
    def measure(evidence: Evidence) -> tuple[float, float, float]:
        dense, sparse = (evidence.noise(n, False).mean(name).max(axis=0) for n in (50, 20))
        return interval(dense - sparse)

    return measure


def _low_noise_c_v(evidence: Evidence) -> tuple[float, float, float]:
    dense, sparse = evidence.noise(50, False), evidence.noise(20, False)
    low = dense.mean("c_v")[_low(dense)].mean(axis=0)
    return interval(low / sparse.mean("c_v").max(axis=0))


def _leaders_raise_c_v(evidence: Evidence) -> tuple[float, float, float]:
    led, free = evidence.noise(50, True), evidence.noise(50, False)
    means = (series.mean("c_v")[_low(series)].mean(axis=0) for series in (led, free))
    return interval(next(means) - next(means))


def _jam_grows(evidence: Evidence) -> tuple[float, float, float]:
    series = evidence.density
    dense, sparse = series.x >= series.x.max() - _NEAR, series.x <= series.x.min() + _NEAR
    jammed = [series.share("jammed", "frames", where) for where in (dense, sparse)]
    return interval(jammed[0] - jammed[1])


def _bistable(evidence: Evidence) -> tuple[float, float, float]:
    series = evidence.density
    lesser = []
    for n in series.x:
        near = abs(series.x - n) <= _NEAR
        both = [series.share(name, "frames", near) for name in ("jammed", "rotating")]
        lesser.append(np.minimum(*both))
    # The densities are chosen once, by the data as measured: a maximum of each draw is too high.
    return interval(lesser[int(np.argmax([each[0] for each in lesser]))])


def _neither(evidence: Evidence) -> tuple[float, float, float]:
    series = evidence.density
    everywhere = np.full(len(series.x), True)
    states = (series.share(name, "frames", everywhere) for name in ("jammed", "rotating"))
    return interval(1 - next(states) - next(states))


def _claim(text: str, quantity: str, low: float = -np.inf, high: float = np.inf) -> Claim:
    return Claim(text=text, section="5.2", quantity=quantity, low=low, high=high)


_TRANSITION = "Order is lost at a backward motion time of about 0.6–0.8 s"
_LOW = f"bw ≤ {LOW_NOISE_S:g} s"

CLAIMS: tuple[_Rule, ...] = (
    _Rule(
        "fig14",
        _claim(
            "Ordered motion at low noise",
            f"share of frames in ordered rotation, n = 20, k = 0, {_LOW}",
            low=0.5,
        ),
        _low_noise_share("rotating", 20),
    ),
    _Rule(
        "fig14",
        _claim(
            "Without leaders order comes in both directions",
            "share of clockwise runs among those that mostly rotate, n = 20, k = 0",
            0.05,
            0.95,
        ),
        _directions,
    ),
    *(
        _Rule(
            "fig14",
            _claim(
                f"With leaders order has their direction only, n = {n}",
                f"share of clockwise frames among rotating ones, k = 0.2 n, n = {n}",
                low=0.95,
            ),
            _led(n),
        )
        for n in (20, 50)
    ),
    _Rule(
        "fig14",
        _claim(
            "20 boats are not jammed often enough to leave a mark",
            f"share of jammed frames, n = 20, k = 0, {_LOW}",
            high=0.05,
        ),
        _low_noise_share("jammed", 20),
    ),
    _Rule(
        "fig14",
        _claim(
            "50 boats at low noise have a peak of φ_o at zero",
            f"density of φ_o within π/12 of 0 over a uniform one, n = 50, k = 0, {_LOW}",
            low=2.0,
        ),
        _peak_at_zero,
    ),
    *(
        _Rule(
            "fig15",
            _claim(
                f"{_TRANSITION}, n = {n}, {'with' if led else 'without'} leaders",
                "bw in s at which mean Ψ_o falls through the middle of its range",
                *_CRITICAL_RANGE,
            ),
            _critical(n, led),
        )
        for n in (20, 50)
        for led in (False, True)
    ),
    _Rule(
        "fig15",
        _claim(
            "The degree of order drops as bw grows",
            f"mean Ψ_o at {_LOW} minus that at bw ≥ {HIGH_NOISE_S:g} s, n = 20, k = 0",
            low=0.2,
        ),
        _fall,
    ),
    _Rule(
        "fig15",
        _claim(
            "The transition from order to disorder is smooth in bw",
            "largest fall of mean Ψ_o within 0.1 s over its whole fall, n = 20, k = 0",
            high=0.5,
        ),
        _steepest,
    ),
    _Rule(
        "fig15",
        _claim(
            "The best order that noise can give falls with density, by Ψ_o",
            "highest mean Ψ_o of any bw, n = 50 minus n = 20, k = 0",
            high=0.0,
        ),
        _best("psi_o"),
    ),
    _Rule(
        "fig16",
        _claim(
            "The best order that noise can give falls with density, by C_v",
            "highest mean C_v of any bw in cm²/s², n = 50 minus n = 20, k = 0",
            high=0.0,
        ),
        _best("c_v"),
    ),
    _Rule(
        "fig16",
        _claim(
            "50 boats have low C_v at low noise",
            f"mean C_v at n = 50, {_LOW}, over the highest at n = 20, k = 0",
            high=0.5,
        ),
        _low_noise_c_v,
    ),
    _Rule(
        "fig16",
        _claim(
            "50 boats have low C_v at low noise most so without leaders",
            f"mean C_v in cm²/s² with 10 leaders minus without, n = 50, {_LOW}",
            low=0.0,
        ),
        _leaders_raise_c_v,
    ),
    _Rule(
        "fig17",
        _claim(
            "Between 20 and 50 boats order gives way to jamming",
            "share of jammed frames at n ≥ 47 minus that at n ≤ 23, bw = 0",
            low=0.3,
        ),
        _jam_grows,
    ),
    _Rule(
        "fig17",
        _claim(
            "The jamming–order transition is bistable",
            "lesser of the shares of jammed and rotating frames, n within 3 of where it is largest",
            low=0.1,
        ),
        _bistable,
    ),
    _Rule(
        "fig17",
        _claim(
            "The jamming–order transition is sharp: little lies between the two states",
            "share of frames neither jammed nor rotating, n = 20 to 50, bw = 0",
            high=0.2,
        ),
        _neither,
    ),
)
"""Every claim with its rule, fixed before the runs of the figures were made."""
