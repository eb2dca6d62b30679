"""Loops for hysteresis: a run in which the noise or the density goes slowly up and down again.

The loop starts with all boats circulating (a big flock that starts at random would not get there),
and goes from its first parameters to its last and back, in equal steps and equal times; boats keep
their poses and velocities. In a loop of the density it is the pool that changes, and boats move
with it: each keeps its share of the way between the walls and its angle about the center. What
little overlap that makes as the pool shrinks, the contact solver takes out again.
"""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv.errors import ParameterError
from flockenv.parameters import FlockParameters
from flockenv.recording import Recording
from flockenv.runs.protocols.initial_state import initial_flock
from flockenv.simulation import Change, recorded

__all__ = [
    "DENSITY_RATIO",
    "LOOPS",
    "density_steps",
    "loop_position",
    "noise_steps",
    "radii_cm",
    "resized",
    "simulate_loop",
    "simulate_prepared",
]

LOOPS = ("rotating-noise-loop", "rotating-density-loop", "rotating-length-loop")
"""A loop of bw from 0 to that given and back; of the density from that given to `DENSITY_RATIO`
times that and back, the whole pool scaled; the same, its circumference alone at fixed width."""

DENSITY_RATIO = 4.0
"""Highest over lowest density of a loop."""

_NOISE_STEPS = 20
_DENSITY_STEPS = 240


def radii_cm(pool: str | tuple[float, float]) -> tuple[float, float]:
    """Return outer and inner radius of a pool in cm.

    Raises
    ------
    ParameterError
        For an unknown pool.
    """
    return _core.pool_radii_cm(pool)


def resized(
    pool: str | tuple[float, float], area_ratio: float, fixed_width: bool
) -> tuple[float, float]:
    """Return the radii of a pool of `area_ratio` times the free area.

    Parameters
    ----------
    pool
        A name, or (outer_radius_cm, inner_radius_cm).
    area_ratio
        New over old free area.
    fixed_width
        False: both radii grow; True: the channel keeps its width, and its circumference grows.

    Raises
    ------
    ParameterError
        For open water, and where the inner wall would vanish.
    """
    outer, inner = radii_cm(pool)
    if math.isinf(outer):
        raise ParameterError("pool: open water has no size")
    if not fixed_width:
        factor = math.sqrt(area_ratio)
        return outer * factor, inner * factor
    width, total = outer - inner, (outer + inner) * area_ratio
    if total <= width:
        raise ParameterError(f"pool {pool!r} of {area_ratio:g} times the area has no inner wall")
    return (total + width) / 2, (total - width) / 2


def noise_steps(parameters: FlockParameters) -> list[FlockParameters]:
    """Return the parameters of half a loop of the noise, from bw = 0 to those given."""
    steps = np.linspace(0.0, parameters.bw_s, _NOISE_STEPS + 1)
    return [parameters.replace(bw_s=float(bw_s)) for bw_s in steps]


def density_steps(parameters: FlockParameters, fixed_width: bool) -> list[FlockParameters]:
    """Return the parameters of half a loop of the density, from those given up."""
    ratios = np.geomspace(1.0, 1 / DENSITY_RATIO, _DENSITY_STEPS + 1)
    return [
        parameters.replace(pool=resized(parameters.pool, float(ratio), fixed_width))
        for ratio in ratios
    ]


def loop_position(time_s: NDArray[np.float64], duration_s: float) -> NDArray[np.float64]:
    """Return how far a loop is at each time: 0 at its ends, 1 in its middle."""
    return np.asarray(1.0 - abs(2.0 * time_s / duration_s - 1.0))


def simulate_loop(
    parameters: FlockParameters, seed: int, duration_s: float, sample_hz: float, kind: str
) -> Recording:
    """Run a loop that starts with all boats circulating: a pure function of its arguments.

    Parameters
    ----------
    parameters
        Of the flock; see `LOOPS` for what of it changes.
    seed
        Seed of all random streams.
    duration_s
        Length of the whole loop in s.
    sample_hz
        Samples per second.
    kind
        One of `LOOPS`.

    Returns
    -------
    Recording
        With the first parameters; `loop_position` returns where a sample lies.

    Raises
    ------
    ParameterError
        For arguments out of range and boats that do not fit the smallest pool.
    """
    if kind == "rotating-noise-loop":
        half = noise_steps(parameters)
    else:
        half = density_steps(parameters, fixed_width=kind == "rotating-length-loop")
    steps = [*half, *half[-2::-1]]
    flock = initial_flock(steps[0], seed, "rotating")
    changes = _changes(steps, duration_s, sample_hz)
    return recorded(flock, parameters, duration_s, sample_hz, changes=changes)


def simulate_prepared(
    parameters: FlockParameters, seed: int, duration_s: float, sample_hz: float, start: str
) -> Recording:
    """Run one flock from an initial state: a pure function of its arguments.

    Parameters and errors are those of `simulate_loop`, except for `start`, one of
    `flockenv.runs.protocols.initial_state.STARTS`.
    """
    flock = initial_flock(parameters, seed, start)
    return recorded(flock, parameters, duration_s, sample_hz)


def _changes(steps: Sequence[FlockParameters], duration_s: float, sample_hz: float) -> list[Change]:
    """Return when each of the steps starts, at samples; the first has started already."""
    count = math.floor(duration_s * sample_hz * (1 + 1e-12))
    turns = [place * len(steps) // max(count, 1) for place in range(count)]
    return [
        (place / sample_hz, steps[turn])
        for place, (before, turn) in enumerate(pairwise([0, *turns]))
        if turn != before
    ]
