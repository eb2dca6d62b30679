"""Calibration targets: numbers of the paper's experiment, and the same numbers in simulation.

Each `Target` has a value, computed from seeded runs of single boats and of 27 boats, and a range
that the paper gives for it. Where the paper's words leave the range open, `Target.statement` states
how they are read.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flockenv.parameters import FlockParameters
from flockenv.simulation import simulate

__all__ = [
    "NOISE_S",
    "QUANTITIES",
    "TARGETS",
    "FlockRuns",
    "Target",
    "loss",
    "measure",
    "run_flock",
    "single_boat",
]

NOISE_S: Mapping[int, tuple[float, ...]] = {
    0: (0.6, 1.0, 1.2, 1.4, 1.6, 1.8, 2.2),
    3: (0.6, 1.0, 1.4, 1.8, 2.0, 2.2, 2.6),
}
"""Backward durations bw in s by number of leaders; the experiment went from 0.4 to 2.8 s."""

DURATION_S = 480.0
"""Length of a measurement in the experiment."""

_SAMPLE_HZ = 5.0
_MIDDLE = 0.56
"""Ψ_o in the middle between 27 boats in order (0.95) and in disorder (0.886/√27 = 0.17)."""

QUANTITIES = ("psi_o", "rotation", "ordered", "jammed", "off_tangent", "along_target")
"""Measured quantities of a run; see `FlockRuns`."""


@dataclass(frozen=True, slots=True)
class FlockRuns:
    """Quantities of many runs of 27 boats.

    Attributes
    ----------
    noise_s : mapping of tuples of float
        Backward durations bw in s, by number of leaders.
    values : mapping of float64 arrays, shape (backward durations, seeds, 6)
        By number of leaders: mean Ψ_o, mean |Ψ_o sin φ_o|, and the parts of the frames that are in
        ordered motion and jammed; over the ordered frames, the sum of ||φ_o| - π/2| and the number
        of those that go in the leaders' direction, both over the number of all frames.
    """

    noise_s: Mapping[int, tuple[float, ...]]
    values: Mapping[int, NDArray[np.float64]]

    def resampled(self, seeds: NDArray[np.int64]) -> "FlockRuns":
        """Return the runs of these seeds, which may repeat."""
        return FlockRuns(self.noise_s, {k: array[:, seeds] for k, array in self.values.items()})

    def mean(self, leaders: int, quantity: str, at_s: Sequence[float] = ()) -> NDArray[np.float64]:
        """Return means over seeds: at all backward durations, or at some."""
        levels = [self.noise_s[leaders].index(bw_s) for bw_s in at_s or self.noise_s[leaders]]
        row = self.values[leaders][levels, :, QUANTITIES.index(quantity)]
        means: NDArray[np.float64] = row.mean(axis=1)
        return means

    def critical_bw_s(self, leaders: int) -> float:
        """Return where mean Ψ_o falls below 0.56 for good, interpolated between backward durations.

        A curve that never exceeds the middle gets the lowest bw minus its distance from the
        middle, and a curve that always does the highest bw plus its distance, so that both can
        still be compared.
        """
        psi_o, noise_s = self.mean(leaders, "psi_o"), self.noise_s[leaders]
        above = np.flatnonzero(psi_o >= _MIDDLE)
        if len(above) == 0:
            return noise_s[0] - float(_MIDDLE - psi_o.max())
        last = int(above[-1])
        if last + 1 == len(psi_o):
            return noise_s[-1] + float(psi_o[-1] - _MIDDLE)
        pair = slice(last, last + 2)
        return float(np.interp(-_MIDDLE, -psi_o[pair], noise_s[pair]))

    def of_ordered_frames(self, leaders: int, quantity: str, at_s: Sequence[float]) -> float:
        """Return a mean over the ordered frames at some backward durations; NaN without any."""
        ordered = self.mean(leaders, "ordered", at_s).sum()
        if ordered == 0.0:
            return math.nan
        return float(self.mean(leaders, quantity, at_s).sum() / ordered)


def run_flock(parameters: FlockParameters, seed: int) -> list[float]:
    """Run one flock for 8 minutes and measure it, in the order of `FlockRuns.values`.

    Frames are those in the analysis window after the first tenth of the run.
    """
    run = simulate(parameters, seed, DURATION_S, _SAMPLE_HZ, dtype=np.float32)
    order = run.analyzed().order
    states = order.states(parameters.speed_cm_s)
    ordered = np.char.startswith(states, "ordered")
    values = (
        order.psi_o,
        abs(order.rotation()),
        ordered,
        states == "jamming",
        np.where(ordered, order.off_tangent(), 0.0),
        states == f"ordered {parameters.target}",
    )
    return [float(np.mean(value)) for value in values]


def single_boat(parameters: FlockParameters, seed: int = 0) -> dict[str, float]:
    """Measure one boat in open water.

    Returns
    -------
    dict of float
        ``forward_cm_s``: speed after 20 s forward. ``backing_turn_rad_s``: mean |turning rate|
        in the last 20 s of 40 s backward. ``backing_over_forward``: the largest speed in the bw
        phases over that in the fw phases, at bw = 1.4 s.
    """
    alone = parameters.replace(n_boats=1, n_leaders=0, pool=(math.inf, 0.0), current_gain=0.0)
    only = {"fw_s": 0.0, "nop1_s": 0.0, "bw_s": 0.0, "nop2_s": 0.0}
    forward = simulate(alone.replace(**{**only, "fw_s": 1.0}), seed, 20.0)
    backward = simulate(alone.replace(**{**only, "bw_s": 1.0}), seed, 40.0)
    cycles = simulate(alone.replace(bw_s=1.4), seed, 54.0)
    speed = np.hypot(cycles.velocity[:, 0, 0], cycles.velocity[:, 0, 1])
    # A sample on a switch shows the velocity at the end of the phase before.
    fastest = {phase: speed[cycles.phase == phase].max() for phase in ("nop1", "nop2")}
    return {
        "forward_cm_s": float(np.hypot(*forward.velocity[-1, 0, :2])),
        "backing_turn_rad_s": float(abs(backward.velocity[200:, 0, 2]).mean()),
        "backing_over_forward": float(fastest["nop2"] / fastest["nop1"]),
    }


Value = Callable[[Mapping[str, float], FlockRuns], float]


@dataclass(frozen=True, slots=True)
class Target:
    """A number of the experiment with its accepted range.

    Attributes
    ----------
    key, name, source, statement : str
        Short name, full name, place in the paper, and reading of the paper's words.
    low, high : float
        The accepted range.
    aim : float
        The value with residual 0.
    tolerance : float
        Unit of the residual.
    weight : float
        Weight of the squared residual in a fit's loss; 0: reported only.
    value : callable
        Computes the value from a single boat's numbers and from flock runs.
    """

    key: str
    name: str
    source: str
    statement: str
    low: float
    high: float
    aim: float
    tolerance: float
    weight: float
    value: Value

    def residual(self, value: float) -> float:
        """Return the distance from the aim in tolerances; 3 for an undefined value.

        The residual of a one-sided target (whose aim is an end of its range) is 0 in its range.
        """
        if math.isnan(value):
            return 3.0
        if self.aim in (self.low, self.high):
            return max(self.low - value, value - self.high, 0.0) / self.tolerance
        return abs(value - self.aim) / self.tolerance

    def is_in_range(self, value: float) -> bool:
        """Return whether a value lies in the range."""
        return self.low <= value <= self.high


def _single(name: str) -> Value:
    return lambda boat, runs: boat[name]


def _level(leaders: int, quantity: str, *at_s: float) -> Value:
    return lambda boat, runs: float(runs.mean(leaders, quantity, at_s).mean())


def _critical(leaders: int) -> Value:
    return lambda boat, runs: runs.critical_bw_s(leaders)


def _ordered(leaders: int, quantity: str, *at_s: float) -> Value:
    return lambda boat, runs: runs.of_ordered_frames(leaders, quantity, at_s)


def _gained(at_s: float) -> Value:
    return lambda boat, runs: float(
        (runs.mean(3, "psi_o", [at_s]) - runs.mean(0, "psi_o", [at_s]))[0]
    )


def _targets() -> Iterator[Target]:
    inf = math.inf
    yield Target(
        "forward_speed",
        "forward speed [cm/s]",
        "Table 1",
        "a boat in open water, motor forward: 15 ± 5",
        *(10.0, 20.0, 15.0, 5.0, 1.0),
        _single("forward_cm_s"),
    )
    yield Target(
        "backing_turn",
        "backing turn [rad/s]",
        "Table 1",
        "mean |turning rate| of a boat in open water, motor backward: 1 ± 0.2",
        *(0.8, 1.2, 1.0, 0.2, 1.0),
        _single("backing_turn_rad_s"),
    )
    yield Target(
        "backing_speed",
        "backing speed / forward speed",
        "Section 3.2",
        "«much smaller» velocities in bw, read as at most a half (peaks, bw = 1.4 s)",
        *(0.0, 0.5, 0.5, 0.1, 1.0),
        _single("backing_over_forward"),
    )
    for leaders, aim in ((0, 1.4), (3, 2.0)):
        yield Target(
            f"critical_bw_{leaders}",
            f"critical bw, {leaders} leaders [s]",
            "Figure 9",
            f"mean Ψ_o falls through 0.56 near {aim} s, read as ± 0.1",
            *(aim - 0.1, aim + 0.1, aim, 0.1, 1.0),
            _critical(leaders),
        )
    for leaders in NOISE_S:
        yield Target(
            f"low_noise_{leaders}",
            f"Ψ_o at low noise, {leaders} leaders",
            "Figure 10",
            "«Ψ_o ≈ 1», read as mean Ψ_o ≥ 0.9 at bw = 0.6 and 1.0 s",
            *(0.9, 1.0, 0.9, 0.1, 1.0),
            _level(leaders, "psi_o", 0.6, 1.0),
        )
    for leaders, bw_s in ((0, 2.2), (3, 2.6)):
        yield Target(
            f"high_noise_{leaders}",
            f"Ψ_o at high noise, {leaders} leaders",
            "Figure 10, Section 4.3",
            f"disorder above 2 s, Ψ_o < 0.3: mean Ψ_o at bw = {bw_s} s",
            *(0.0, 0.3, 0.3, 0.1, 1.0),
            _level(leaders, "psi_o", bw_s),
        )
    yield Target(
        "off_tangent",
        "φ_o off the tangent when ordered [rad]",
        "Eq. (7), figure 9",
        "mean ||φ_o| - π/2| ≤ π/20 over the ordered frames at bw = 0.6 to 1.4 s, no leaders",
        *(0.0, math.pi / 20, math.pi / 20, math.pi / 40, 1.0),
        _ordered(0, "off_tangent", 0.6, 1.0, 1.2, 1.4),
    )
    yield Target(
        "ordered",
        "ordered motion regular, no leaders",
        "Table 2",
        "«regular» at low to middle noise: ordered in at least half of the frames at 1.0 and 1.2 s",
        *(0.5, 1.0, 0.5, 0.1, 1.0),
        _level(0, "ordered", 1.0, 1.2),
    )
    yield Target(
        "jamming",
        "jamming, no leaders",
        "Table 2, figure 9",
        "occasional at low noise: a part of the frames at bw = 0.6 s, read as 0.5 % to 30 %",
        *(0.005, 0.3, 0.3, 0.1, 0.0),
        _level(0, "jammed", 0.6),
    )
    yield Target(
        "leaders_direction",
        "ordered in the leaders' direction",
        "Section 4.2, figure 9",
        "«only CW in the CW-guided experiments»: ≥ 0.95 of the ordered frames at 1.4 and 1.8 s",
        *(0.95, 1.0, 0.95, 0.1, 1.0),
        _ordered(3, "along_target", 1.4, 1.8),
    )
    yield Target(
        "leaders_gain",
        "gain of Ψ_o by 3 leaders at 1.8 s",
        "Figure 12",
        "more leaders, more order: mean Ψ_o with three leaders minus that without, above 0",
        *(0.0, inf, 0.0, 0.1, 0.0),
        _gained(1.8),
    )


TARGETS = tuple(_targets())
"""All calibration targets."""


def measure(boat: Mapping[str, float], runs: FlockRuns) -> dict[str, float]:
    """Return the value of every target by its key."""
    return {target.key: target.value(boat, runs) for target in TARGETS}


def loss(values: Mapping[str, float], only: Sequence[str] = ()) -> float:
    """Return Σ weight·ρ(residual) over all targets, or over some.

    ρ(r) is r² up to 2 tolerances and 4r - 4 beyond, so that one distant target does not dominate.
    """
    targets = [target for target in TARGETS if not only or target.key in only]
    distances = [target.residual(values[target.key]) for target in targets]
    return sum(
        (1.0 if only else target.weight) * (each**2 if each < 2.0 else 4.0 * each - 4.0)
        for target, each in zip(targets, distances, strict=True)
    )
