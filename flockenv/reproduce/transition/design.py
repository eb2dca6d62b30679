"""What `transition-order` runs: growing flocks from two starts, and loops, in two ways of growing.

Scaling the whole pool also lowers the length of wall for each boat; growing the circumference at
fixed width does not. Both are run. How much is run follows from a budget of computing time.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from flockenv.parameters import FlockParameters
from flockenv.reproduce.reproduction import Settings, within_budget
from flockenv.runs.protocols.hysteresis import resized
from flockenv.runs.spec import RunSpec

__all__ = [
    "DESIGNS",
    "FULL",
    "LOOPS",
    "LOOP_BW_S",
    "SLOWER",
    "STARTS",
    "WAYS",
    "Growth",
    "TransitionDesign",
    "within",
]

WAYS = {"whole pool": False, "circumference": True}
"""Ways of growing: whether the channel keeps its width."""

STARTS = ("rotating", "one-jam")
"""The two ends that runs at one density start from, of `runs.protocols.initial_state.STARTS`."""

SLOWER = 3.0
LOOPS: Mapping[str, float] = {
    "density": 1.0,
    "slow density": SLOWER,
    "slowest density": SLOWER**2,
    "noise": 1.0,
}
"""Kinds of loops, and how many times as long as the fastest they take."""

_CORE_S = 0.03
"""Seconds of one core that an hour of a boat takes in flocks of up to 200, which jam for a part of
their time; larger flocks have larger islands of contacts."""

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
    largest_throughout : int
        Number of boats up to which flocks run at all densities.
    densities_beyond : mapping of tuples of int
        By way of growing: the densities at which larger flocks run.
    largest_loop : int
        Number of boats up to which loops are run.
    runs : int
        Seeds for each point and loop.
    stationary_minutes, loop_minutes : float
        Length of a run at one density, and of the fastest loop.
    """

    sizes: tuple[int, ...]
    densities: Mapping[str, tuple[int, ...]]
    largest_throughout: int
    densities_beyond: Mapping[str, tuple[int, ...]]
    largest_loop: int
    runs: int
    stationary_minutes: float
    loop_minutes: float

    def stationary(
        self, settings: Settings, growth: Growth, density: int, start: str
    ) -> tuple[RunSpec, ...]:
        """Return the runs at one density without noise, from one of `STARTS`."""
        return self._standing(settings, growth.parameters(density), start)

    def fine(
        self, settings: Settings, way: str, density: int, start: str
    ) -> tuple[Growth, tuple[RunSpec, ...]]:
        """Return runs of flocks of a middling size as `stationary` does, at `FINE_DT_S`."""
        growth = Growth(way, self.sizes[(len(self.sizes) - 1) // 2])
        parameters = growth.parameters(density, dt_s=FINE_DT_S)
        return growth, self._standing(settings, parameters, start)

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

    def growths(self) -> list[Growth]:
        """Return all sizes that run in all ways."""
        every = (Growth(way, n) for way in WAYS for n in self.sizes)
        return [growth for growth in every if self.densities_of(growth)]

    def largest(self, way: str) -> Growth:
        """Return the largest flocks of a way of growing."""
        return [growth for growth in self.growths() if growth.way == way][-1]

    def densities_of(self, growth: Growth) -> tuple[int, ...]:
        """Return the densities that flocks of a size run at."""
        is_large = growth.n_boats > self.largest_throughout
        return (self.densities_beyond if is_large else self.densities).get(growth.way, ())

    def sizes_at(self, way: str, density: int) -> tuple[int, ...]:
        """Return the numbers of boats that run at a density, increasing."""
        return tuple(n for n in self.sizes if density in self.densities_of(Growth(way, n)))

    def looped(self) -> list[Growth]:
        """Return the sizes that go through loops, in all ways."""
        return [growth for growth in self.growths() if growth.n_boats <= self.largest_loop]

    def points(self) -> list[tuple[Growth, int, str]]:
        """Return every size, density and start."""
        return [
            (growth, density, start)
            for growth in self.growths()
            for density in self.densities_of(growth)
            for start in STARTS
        ]

    def fine_points(self) -> list[tuple[str, int, str]]:
        """Return way, density and start of the runs at `FINE_DT_S`: the middle density."""
        middle = {way: each[len(each) // 2] for way, each in self.densities.items()}
        return [(way, middle[way], start) for way in WAYS for start in STARTS]

    def all_runs(self, settings: Settings) -> list[RunSpec]:
        """Return every run."""
        specs: list[RunSpec] = []
        for growth, density, start in self.points():
            specs += self.stationary(settings, growth, density, start)
        for way, density, start in self.fine_points():
            specs += self.fine(settings, way, density, start)[1]
        for growth in self.looped():
            for kind in LOOPS:
                specs += self.loop(settings, growth, kind)
        return specs

    def core_minutes(self, settings: Settings) -> float:
        """Return about how long one core takes for all runs, in minutes."""
        seconds = sum(
            _CORE_S
            * (max(s.parameters.n_boats, 200) / 200) ** 0.7
            * s.parameters.n_boats
            * s.duration_s
            / 3600
            for s in self.all_runs(settings)
        )
        return float(seconds) / 60

    def _standing(
        self, settings: Settings, parameters: FlockParameters, start: str
    ) -> tuple[RunSpec, ...]:
        length = settings.duration_s(self.stationary_minutes)
        return self._seeded(settings.seed, parameters, start, length, _POSES_HZ, "poses")

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

FULL = TransitionDesign(
    sizes=(50, 100, 200, 400, 800, 1600),
    densities=_DENSITIES,
    largest_throughout=800,
    # Jams vanish in a long ring, whose wall is nearly straight.
    densities_beyond={"whole pool": _DENSITIES["whole pool"][-1:], "circumference": ()},
    largest_loop=400,
    runs=8,
    stationary_minutes=40.0,
    loop_minutes=10.0,
)

DESIGNS = (
    TransitionDesign(
        sizes=(50, 200, 400, 800),
        densities=_DENSITIES,
        largest_throughout=800,
        densities_beyond=dict.fromkeys(WAYS, ()),
        largest_loop=200,
        runs=4,
        stationary_minutes=20.0,
        loop_minutes=3.0,
    ),
    TransitionDesign(
        sizes=(50, 100, 200, 400, 800),
        densities=_DENSITIES,
        largest_throughout=800,
        densities_beyond=dict.fromkeys(WAYS, ()),
        largest_loop=400,
        runs=8,
        stationary_minutes=40.0,
        loop_minutes=10.0,
    ),
    FULL,
)
"""By the time they take."""


def within(settings: Settings) -> TransitionDesign:
    """Return the largest of `DESIGNS` that the budget allows; errors as for `within_budget`."""
    return within_budget("transition-order", DESIGNS, settings)
