"""Runs of a single boat and of 27 boats, and the quantities that calibration targets read off."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flockenv.parameters import FlockParameters
from flockenv.policies.base import LeaderPolicy
from flockenv.recording import Recording
from flockenv.runs.executors import in_order
from flockenv.runs.protocols.target_switching import PERIOD_S, second_halves, simulate_alternating
from flockenv.simulation import simulate

__all__ = [
    "GUIDED_S",
    "JUDGED",
    "QUANTITIES",
    "SEARCHED",
    "Cell",
    "Design",
    "FlockRuns",
    "run_flock",
    "run_flocks",
    "single_boat",
]

DURATION_S = 480.0
"""Length of a measurement in the experiment."""

GUIDED_S = 1.8
"""The backward duration of figures 7 and 12."""

_SAMPLE_HZ = 5.0
_MIDDLE = 0.56
"""Ψ_o in the middle between 27 boats in order (0.95) and in disorder (0.886/√27 = 0.17)."""

QUANTITIES = (
    "psi_o",
    "rotation",
    "ordered",
    "jammed",
    "off_tangent",
    "along_target",
    "c_v",
    "ordering_s",
    "following",
)
"""Measured quantities of a run; see `FlockRuns`."""


@dataclass(frozen=True, slots=True)
class Cell:
    """One kind of run: number of leaders, bw in s, and whether the leaders' direction alternates.

    A run with one direction is clockwise on even seeds and counter-clockwise on odd ones.
    """

    leaders: int
    bw_s: float
    duration_s: float = DURATION_S
    alternates: bool = False

    @property
    def name(self) -> str:
        """Of the cell, as logs have it."""
        return f"k{self.leaders}_bw{self.bw_s:g}{'_alternating' if self.alternates else ''}"


@dataclass(frozen=True, slots=True)
class Design:
    """The kinds of runs that a set of constants is judged by."""

    cells: tuple[Cell, ...]

    @property
    def flock_hours(self) -> float:
        """Simulated time of one run of each cell, in hours."""
        return sum(cell.duration_s for cell in self.cells) / 3600.0

    def seeds(self, seeds: Sequence[int]) -> Sequence[Sequence[int]]:
        """Share seeds out: one row per repetition, with a seed of its own for each cell."""
        width = len(self.cells)
        return [seeds[start : start + width] for start in range(0, len(seeds), width)]


def _design(no_leaders: Sequence[float], three: Sequence[float], counts: Iterable[int]) -> Design:
    cells = [Cell(0, bw_s) for bw_s in no_leaders] + [Cell(3, bw_s) for bw_s in three]
    return Design((*cells, *(Cell(leaders, GUIDED_S) for leaders in counts)))


def _alternating(design: Design, stretches: int) -> Design:
    return Design((*design.cells, Cell(3, GUIDED_S, stretches * PERIOD_S, True)))


SEARCHED = _alternating(_design((0.4, 1.0, 1.4, 1.8, 2.2), (1.0, 1.8, 2.2), (4,)), 2)
"""Of a trial: 4/3 flock-hours."""

JUDGED = _alternating(
    _design(
        (0.4, 0.6, 1.0, 1.2, 1.4, 1.6, 1.8, 2.2), (0.6, 1.0, 1.4, 1.8, 2.0, 2.2, 2.6), (1, 2, 4)
    ),
    4,
)
"""Of finalists and of the runs on held-out seeds; the experiment went from 0.4 to 2.8 s."""


@dataclass(frozen=True, slots=True)
class FlockRuns:
    """Quantities of many runs of 27 boats.

    Attributes
    ----------
    design : Design
        The kinds of runs.
    values : float64 array, shape (cells, repetitions, 9)
        Over the frames in the analysis window after the first tenth of a run: mean Ψ_o, mean
        |Ψ_o sin φ_o|, and the parts of the frames that are in ordered motion and jammed; over the
        ordered frames, the sum of ||φ_o| - π/2| and the number of those that go in the leaders'
        direction, both over the number of all frames; mean C_v in cm²/s². Over all frames: the
        ordering time of eq. (7) in s, NaN for a run that does not order. Of alternating runs: mean
        Ψ_o cos(φ_o − φ_target) in the second halves of their stretches, and NaN of others.
    """

    design: Design
    values: NDArray[np.float64]

    @property
    def repetitions(self) -> int:
        """How many runs of each cell there are."""
        return int(self.values.shape[1])

    def resampled(self, places: NDArray[np.int64]) -> "FlockRuns":
        """Return the runs of these repetitions, which may repeat."""
        return FlockRuns(self.design, self.values[:, places])

    def of(self, leaders: int, quantity: str, at_s: Sequence[float] = ()) -> NDArray[np.float64]:
        """Return a quantity of the runs in one direction: shape (levels, repetitions).

        Levels are the backward durations of the design, in their order; some of them, where `at_s`
        names those.
        """
        levels = [place for place, cell in self._levels(leaders) if not at_s or cell.bw_s in at_s]
        return self.values[levels, :, QUANTITIES.index(quantity)]

    def alternating(self, quantity: str) -> NDArray[np.float64]:
        """Return a quantity of the alternating runs: shape (cells, repetitions)."""
        kinds = [place for place, cell in enumerate(self.design.cells) if cell.alternates]
        return self.values[kinds, :, QUANTITIES.index(quantity)]

    def mean(self, leaders: int, quantity: str, at_s: Sequence[float] = ()) -> NDArray[np.float64]:
        """Return means over repetitions: at all backward durations, or at some."""
        return np.asarray(self.of(leaders, quantity, at_s).mean(axis=1))

    def noise_s(self, leaders: int) -> tuple[float, ...]:
        """Return the backward durations of a number of leaders."""
        return tuple(cell.bw_s for _, cell in self._levels(leaders))

    def _levels(self, leaders: int) -> list[tuple[int, Cell]]:
        return [
            (place, cell)
            for place, cell in enumerate(self.design.cells)
            if cell.leaders == leaders and not cell.alternates
        ]

    def critical_bw_s(self, leaders: int) -> float:
        """Return where mean Ψ_o falls below 0.56 for good, interpolated between backward durations.

        A curve that never exceeds the middle gets the lowest bw minus its distance from the
        middle, and a curve that always does the highest bw plus its distance, so that both can
        still be compared.
        """
        psi_o, noise_s = self.mean(leaders, "psi_o"), self.noise_s(leaders)
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

    def ordering_slope(self, leaders: int) -> float:
        """Return the slope of ordering times against bw, in s per s; NaN for a single bw."""
        times = self.of(leaders, "ordering_s")
        bw_s = np.broadcast_to(np.array(self.noise_s(leaders))[:, None], times.shape)
        return _slope(bw_s, times)

    def guided_psi_o(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return numbers of leaders and Ψ_o of the runs of figure 12, in one direction each."""
        counts = sorted({cell.leaders for cell in self.design.cells})
        psi_o = [self.of(leaders, "psi_o", [GUIDED_S]).ravel() for leaders in counts]
        leaders = np.repeat(np.array(counts, np.float64), [len(each) for each in psi_o])
        return leaders, np.concatenate(psi_o)

    def leaders_slope(self) -> float:
        """Return the slope of Ψ_o against the number of leaders at bw = 1.8 s."""
        return _slope(*self.guided_psi_o())


def _slope(x: NDArray[np.float64], y: NDArray[np.float64]) -> float:
    known = np.isfinite(y)
    x, y = x[known], y[known]
    if len(x) < 2 or np.ptp(x) == 0.0:
        return math.nan
    return float(np.cov(x, y, ddof=0)[0, 1] / x.var())


def run_flock(
    parameters: FlockParameters, cell: Cell, seed: int, policy: LeaderPolicy | None = None
) -> list[float]:
    """Run one flock and measure it, in the order of `QUANTITIES`.

    Leaders follow the policy, by default the paper's law at every substep.
    """
    target = "ccw" if seed % 2 else "cw"
    flock = parameters.replace(n_leaders=cell.leaders, bw_s=cell.bw_s, target=target)
    if cell.alternates:
        run = simulate_alternating(flock, seed, cell.duration_s, _SAMPLE_HZ, policy=policy)
        following = _following(run)
    else:
        run = simulate(flock, seed, cell.duration_s, _SAMPLE_HZ, policy, dtype=np.float32)
        following = math.nan
    order = run.analyzed().order
    states = order.states(parameters.speed_cm_s)
    ordered = np.char.startswith(states, "ordered")
    values = (
        order.psi_o,
        abs(order.rotation()),
        ordered,
        states == "jamming",
        np.where(ordered, order.off_tangent(), 0.0),
        states == f"ordered {target}",
        order.c_v,
    )
    time_s = run.order.ordering_time(run.time_s)
    ordering_s = time_s if math.isfinite(time_s) else math.nan
    return [*(float(np.mean(value)) for value in values), ordering_s, following]


def _following(run: Recording) -> float:
    used = run.analyzed(0.0)
    late, signs = second_halves(used.time_s)
    return float((used.order.rotation()[late] * signs[late]).mean())


def run_flocks(
    parameters: FlockParameters,
    design: Design,
    seeds: Sequence[int],
    jobs: int = 1,
    progress: Callable[[], None] = lambda: None,
    policy: LeaderPolicy | None = None,
) -> FlockRuns:
    """Run the cells of a design, each as often as there are rows of seeds (`Design.seeds`).

    Leaders follow the policy as for `run_flock`.
    """
    rows = design.seeds(seeds)
    items = [(cell, row[place]) for place, cell in enumerate(design.cells) for row in rows]

    def run(item: tuple[Cell, int]) -> list[float]:
        measured = run_flock(parameters, *item, policy)
        progress()
        return measured

    # Without a thread of its own for each run, a single job spares the switches.
    measured = [run(item) for item in items] if jobs == 1 else in_order(run, items, jobs)
    shape = (len(design.cells), len(rows), len(QUANTITIES))
    return FlockRuns(design, np.array(measured).reshape(shape))


def single_boat(parameters: FlockParameters, seed: int = 0) -> dict[str, float]:
    """Measure one boat of average speed in open water.

    Returns
    -------
    dict of float
        ``forward_cm_s``: speed after 20 s forward. ``forward_turn_rad_s``: turning rate in the last
        10 of these, positive counter-clockwise. ``backing_turn_rad_s``: mean |turning rate|
        in the last 20 s of 40 s backward. ``backing_over_forward``: the largest speed in the bw
        phases over that in the fw phases, at bw = 1.4 s.
    """
    alone = parameters.replace(
        n_boats=1,
        n_leaders=0,
        pool=(math.inf, 0.0),
        current_gain=0.0,
        speed_spread_cm_s=0.0,
    )
    only = {"fw_s": 0.0, "nop1_s": 0.0, "bw_s": 0.0, "nop2_s": 0.0}
    forward = simulate(alone.replace(**{**only, "fw_s": 1.0}), seed, 20.0)
    backward = simulate(alone.replace(**{**only, "bw_s": 1.0}), seed, 40.0)
    cycles = simulate(alone.replace(bw_s=1.4), seed, 54.0)
    speed = np.hypot(cycles.velocity[:, 0, 0], cycles.velocity[:, 0, 1])
    # A sample on a switch shows the velocity at the end of the phase before.
    fastest = {phase: speed[cycles.phase == phase].max() for phase in ("nop1", "nop2")}
    return {
        "forward_cm_s": float(np.hypot(*forward.velocity[-1, 0, :2])),
        "forward_turn_rad_s": float(forward.velocity[100:, 0, 2].mean()),
        "backing_turn_rad_s": float(abs(backward.velocity[200:, 0, 2]).mean()),
        "backing_over_forward": float(fastest["nop2"] / fastest["nop1"]),
    }
