"""What `transition-order` runs: growing flocks from two starts, and loops, in two ways of growing.

Scaling the whole pool also lowers the length of wall for each boat; growing the circumference at
fixed width does not. Both are run. How much is run follows from a budget of computing time.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from flockenv.parameters import FlockParameters
from flockenv.reproduce.reproduction import Settings, within_budget
from flockenv.runs.protocols.hysteresis import resized
from flockenv.runs.protocols.initial_state import STARTS
from flockenv.runs.spec import RunSpec

__all__ = [
    "DESIGNS",
    "FULL",
    "LOOPS",
    "LOOP_BW_S",
    "SLOWER",
    "WAYS",
    "Growth",
    "TransitionDesign",
    "within",
]

WAYS = {"whole pool": False, "circumference": True}
"""Ways of growing: whether the channel keeps its width."""

LOOPS = ("density", "slow density", "noise")
"""Kinds of loops; a slow one takes `SLOWER` times as long."""

SLOWER = 3.0
"""How many times as long a slow loop takes."""

_CORE_S = 0.035
"""Seconds of one core that an hour of a boat takes: 0.01 in rotation to 0.13 in a dense jam."""

_POOL = "500-boats"
_DT_S = 0.05
"""Of the leapfrog, whose statistics with white noise are the same from 0.005 to 0.1 s."""

# Poses are not stored, but pass through memory: 1600 boats at 10 Hz would take 1.4 GB per run.
_SAMPLE_HZ = 1.0
LOOP_BW_S = 0.6
"""Highest noise of loops in noise."""


@dataclass(frozen=True, slots=True)
class Growth:
    """One size in one way of growing."""

    way: str
    n_boats: int

    def parameters(self, density: float, bw_s: float = 0.0) -> FlockParameters:
        """Return them; `density` counts boats for each free area of the pool `500-boats`."""
        pool = resized(_POOL, self.n_boats / density, WAYS[self.way])
        base = FlockParameters.preset("simulation").replace(dt_s=_DT_S)
        return base.replace(n_boats=self.n_boats, n_leaders=0, bw_s=bw_s, pool=pool)


@dataclass(frozen=True, slots=True)
class TransitionDesign:
    """Sizes, densities and seeds.

    Attributes
    ----------
    sizes : tuple of int
        Numbers of boats, increasing.
    densities : mapping of tuples of int
        By way of growing: boats for each free area of the pool `500-boats`, increasing. Pilot runs
        of other seeds put them where rotation gives way to the jam.
    runs : int
        Seeds for each point and loop.
    stationary_minutes, loop_minutes : float
        Length of a run at one density, and of a loop that is not slow.
    """

    sizes: tuple[int, ...]
    densities: Mapping[str, tuple[int, ...]]
    runs: int
    stationary_minutes: float
    loop_minutes: float

    def stationary(
        self, settings: Settings, growth: Growth, density: int, start: str
    ) -> tuple[RunSpec, ...]:
        """Return the runs at one density without noise, from one of `STARTS`."""
        length = settings.duration_s(self.stationary_minutes)
        return self._seeded(length, settings.seed, growth.parameters(density), start, "window")

    def loop(self, settings: Settings, growth: Growth, kind: str) -> tuple[RunSpec, ...]:
        """Return the loops of a kind in `LOOPS`.

        They go from the lowest density to `protocols.hysteresis.DENSITY_RATIO` times that and back,
        or from no noise to bw = 0.6 s and back at the lowest density.
        """
        length = settings.duration_s(self.loop_minutes)
        lowest = self.densities[growth.way][0]
        if kind == "noise":
            parameters, protocol = growth.parameters(lowest, LOOP_BW_S), "rotating-noise-loop"
        else:
            parameters = growth.parameters(lowest)
            protocol = f"rotating-{'length' if WAYS[growth.way] else 'density'}-loop"
            length *= SLOWER if kind == "slow density" else 1.0
        return self._seeded(length, settings.seed, parameters, protocol, "order")

    def growths(self) -> list[Growth]:
        """Return all sizes in all ways."""
        return [Growth(way, n) for way in WAYS for n in self.sizes]

    def all_runs(self, settings: Settings) -> list[RunSpec]:
        """Return every run."""
        specs: list[RunSpec] = []
        for growth in self.growths():
            for density in self.densities[growth.way]:
                for start in STARTS:
                    specs += self.stationary(settings, growth, density, start)
            for kind in LOOPS:
                specs += self.loop(settings, growth, kind)
        return specs

    def core_minutes(self, settings: Settings) -> float:
        """Return about how long one core takes for all runs, in minutes."""
        hours = sum(s.parameters.n_boats * s.duration_s / 3600 for s in self.all_runs(settings))
        return _CORE_S * hours / 60

    def _seeded(
        self, length_s: float, first: int, parameters: FlockParameters, protocol: str, keep: str
    ) -> tuple[RunSpec, ...]:
        return tuple(
            RunSpec(
                parameters=parameters,
                seed=seed,
                duration_s=length_s,
                sample_hz=_SAMPLE_HZ,
                protocol=protocol,
                keep=keep,
            )
            for seed in range(first, first + self.runs)
        )


_DENSITIES = {"whole pool": (6, 12, 24), "circumference": (20, 40, 80)}

FULL = TransitionDesign(
    sizes=(50, 100, 200, 400, 800, 1600),
    densities={"whole pool": (4, 6, 10, 16, 24), "circumference": (16, 24, 36, 54, 80)},
    runs=4,
    stationary_minutes=30.0,
    loop_minutes=20.0,
)

DESIGNS = (
    TransitionDesign(
        sizes=(100, 400, 1600),
        densities=_DENSITIES,
        runs=3,
        stationary_minutes=6.0,
        loop_minutes=4.0,
    ),
    TransitionDesign(
        sizes=(100, 400, 1600),
        densities=_DENSITIES,
        runs=3,
        stationary_minutes=12.0,
        loop_minutes=9.0,
    ),
    FULL,
)
"""By the time they take: some 7, 14 and 98 minutes of one core."""


def within(settings: Settings) -> TransitionDesign:
    """Return the largest of `DESIGNS` that the budget allows; errors as for `within_budget`."""
    return within_budget("transition-order", DESIGNS, settings)
