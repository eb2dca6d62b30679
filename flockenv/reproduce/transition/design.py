"""What `transition-order` runs: growing flocks from two starts, and loops, in two ways of growing.

Scaling the whole pool also lowers the length of wall for each boat; growing the circumference at
fixed width does not. Both are run. How much is run follows from a budget of computing time.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from flockenv.parameters import FlockParameters
from flockenv.reproduce.reproduction import Settings, within_budget
from flockenv.runs.protocols.hysteresis import resized
from flockenv.runs.spec import RunSpec

__all__ = [
    "DESIGNS",
    "FULL",
    "LONGER_ABOVE",
    "LOOPS",
    "LOOP_BW_S",
    "SLOWER",
    "STARTED",
    "WAYS",
    "WIDTH_EXPONENTS",
    "Growth",
    "TransitionDesign",
    "within",
]

WAYS = {"whole pool": False, "circumference": True}
"""Ways of growing: whether the channel keeps its width."""

WIDTH_EXPONENTS = {way: 0.0 if keeps else 0.5 for way, keeps in WAYS.items()}
"""By way of growing: the power of the number of boats that the channel's width is proportional to,
at one density."""

LONGER_ABOVE = 400
"""Boats from which runs at one density are longer in proportion to the flock, since one jam of all
boats takes longer to dissolve from its ends."""

STARTED: Mapping[str, str] = {"rotating": "started rotating", "one-jam": "started in one jam"}
"""What each start, of `runs.protocols.initial_state.STARTS`, is called in texts and pictures."""

SLOWER = 3.0
LOOPS: Mapping[str, float] = {
    "density": 1.0,
    "slow density": SLOWER,
    "slowest density": SLOWER**2,
    "noise": 1.0,
}
"""Kinds of loops, and how many times as long as the fastest they take."""

_CORE_S = 0.02
"""Seconds of one core that an hour of a boat takes in flocks of 800; smaller ones take less."""

_POOL = "500-boats"
_DT_S = 0.1
FINE_DT_S = 0.02
"""Substep of the few runs that show what the longer one of all others does."""

_LOOP_HZ = 1.0
_POSES_HZ = 0.1
"""Samples per second of loops, and of runs at one density, which store all poses."""

LOOP_BW_S = 0.6
"""Highest noise of loops in noise."""


@dataclass(frozen=True, slots=True)
class Growth:
    """One size in one way of growing."""

    way: str
    n_boats: int

    def parameters(self, density: float, bw_s: float = 0.0, dt_s: float = _DT_S) -> FlockParameters:
        """Return them; `density` counts boats for each free area of the pool `500-boats`."""
        pool = resized(_POOL, self.n_boats / density, WAYS[self.way])
        base = FlockParameters.preset("simulation").replace(dt_s=dt_s)
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
    largest_loop : int
        Number of boats up to which loops are run.
    runs : int
        Seeds for each point and loop.
    stationary_minutes, loop_minutes : float
        Length of a run at one density, of up to `LONGER_ABOVE` boats, and of the fastest loop.
    """

    sizes: tuple[int, ...]
    densities: Mapping[str, tuple[int, ...]]
    largest_loop: int
    runs: int
    stationary_minutes: float
    loop_minutes: float

    def stationary(
        self, settings: Settings, growth: Growth, density: int, start: str, dt_s: float = _DT_S
    ) -> tuple[RunSpec, ...]:
        """Return the runs at one density without noise, from one of `STARTED`."""
        longer = max(1.0, growth.n_boats / LONGER_ABOVE)
        length = settings.duration_s(self.stationary_minutes) * longer
        parameters = growth.parameters(density, dt_s=dt_s)
        return self._seeded(settings.seed, parameters, start, length, _POSES_HZ, "poses")

    def loop(self, settings: Settings, growth: Growth, kind: str) -> tuple[RunSpec, ...]:
        """Return the loops of a kind in `LOOPS`.

        They go from the lowest density to `protocols.hysteresis.DENSITY_RATIO` times that and back,
        or from no noise to bw = 0.6 s and back at the lowest density.
        """
        lowest = self.densities[growth.way][0]
        if kind == "noise":
            parameters, protocol = growth.parameters(lowest, LOOP_BW_S), "rotating-noise-loop"
        else:
            parameters = growth.parameters(lowest)
            protocol = f"rotating-{'length' if WAYS[growth.way] else 'density'}-loop"
        length = settings.duration_s(self.loop_minutes) * LOOPS[kind]
        return self._seeded(settings.seed, parameters, protocol, length, _LOOP_HZ, "order")

    def growths(self, *ways: str) -> list[Growth]:
        """Return all sizes in these ways, by default in all."""
        return [Growth(way, n) for way in ways or WAYS for n in self.sizes]

    def looped(self) -> list[Growth]:
        """Return the sizes that go through loops, in all ways."""
        return [growth for growth in self.growths() if growth.n_boats <= self.largest_loop]

    def points(self) -> list[tuple[Growth, int, str]]:
        """Return every size, density and start."""
        return [
            (growth, density, start)
            for growth in self.growths()
            for density in self.densities[growth.way]
            for start in STARTED
        ]

    def fine_points(self) -> list[tuple[Growth, int, str]]:
        """Return the points that run at `FINE_DT_S` too: a middling size at the middle density."""
        n_boats = self.sizes[(len(self.sizes) - 1) // 2]
        return [
            (growth, density, start)
            for growth, density, start in self.points()
            if growth.n_boats == n_boats and density == self.middle(growth.way)
        ]

    def middle(self, way: str) -> int:
        """Return the middle density of a way of growing."""
        return self.densities[way][len(self.densities[way]) // 2]

    def all_runs(self, settings: Settings) -> list[RunSpec]:
        """Return every run."""
        specs: list[RunSpec] = []
        for point in self.points():
            specs += self.stationary(settings, *point)
        for point in self.fine_points():
            specs += self.stationary(settings, *point, FINE_DT_S)
        for growth in self.looped():
            for kind in LOOPS:
                specs += self.loop(settings, growth, kind)
        return specs

    def core_minutes(self, settings: Settings) -> float:
        """Return about how long one core takes for all runs, in minutes."""
        boat_s = sum(spec.parameters.n_boats * spec.duration_s for spec in self.all_runs(settings))
        return _CORE_S * float(boat_s) / 3600 / 60

    def _seeded(
        self,
        first: int,
        parameters: FlockParameters,
        protocol: str,
        length_s: float,
        sample_hz: float,
        keep: str,
    ) -> tuple[RunSpec, ...]:
        return tuple(
            RunSpec(
                parameters=parameters,
                seed=seed,
                duration_s=length_s,
                sample_hz=sample_hz,
                protocol=protocol,
                keep=keep,
            )
            for seed in range(first, first + self.runs)
        )


_DENSITIES = {"whole pool": (6, 10, 16), "circumference": (24, 36, 54)}

_TO_800 = TransitionDesign(
    sizes=(50, 100, 200, 400, 800),
    densities=_DENSITIES,
    largest_loop=400,
    runs=8,
    stationary_minutes=40.0,
    loop_minutes=10.0,
)

FULL = replace(_TO_800, sizes=(*_TO_800.sizes, 1600), largest_loop=800)

DESIGNS = (
    TransitionDesign(
        sizes=(50, 200, 400, 800),
        densities=_DENSITIES,
        largest_loop=200,
        runs=4,
        stationary_minutes=20.0,
        loop_minutes=3.0,
    ),
    _TO_800,
    FULL,
)
"""By the time they take."""


def within(settings: Settings) -> TransitionDesign:
    """Return the largest of `DESIGNS` that the budget allows; errors as for `within_budget`."""
    return within_budget("transition-order", DESIGNS, settings)
