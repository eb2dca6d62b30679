"""What `transition-order` runs: growing flocks at fixed density, and loops, in two ways of growing.

Scaling the whole pool also lowers the length of wall for each boat; growing the circumference at
fixed width does not. Both are run. How much is run follows from a budget of computing time.
"""

from dataclasses import dataclass

from flockenv.errors import ParameterError
from flockenv.loops import resized
from flockenv.parameters import FlockParameters
from flockenv.reproduce.reproduction import Settings
from flockenv.runs import RunSpec

__all__ = ["DESIGNS", "FULL", "WAYS", "Growth", "TransitionDesign", "within"]

WAYS = {"whole pool": False, "circumference": True}
"""Ways of growing: whether the channel keeps its width."""

_CORE_S = 0.035
"""Seconds of one core that an hour of a boat takes: 0.017 to 0.045 by density and way of growing,
measured with runs of one minute of 400 and 1600 boats."""

_POOL = "500-boats"
# Poses are not kept, but pass through memory: 1600 boats at 10 Hz would take 1.4 GB a run.
_SAMPLE_HZ = 1.0
_LOOP_BW_S = 0.6
_LOOP_DENSITY = 32


@dataclass(frozen=True, slots=True)
class Growth:
    """One size in one way of growing."""

    way: str
    n_boats: int

    def scene(self, density: float, bw_s: float = 0.0) -> FlockParameters:
        """Return the scene; `density` counts boats for each free area of the pool `500-boats`."""
        pool = resized(_POOL, self.n_boats / density, WAYS[self.way])
        base = FlockParameters.preset("simulation")
        return base.replace(n_boats=self.n_boats, n_leaders=0, bw_s=bw_s, pool=pool)


@dataclass(frozen=True, slots=True)
class TransitionDesign:
    """Sizes, densities and seeds.

    Attributes
    ----------
    sizes : tuple of int
        Numbers of boats, increasing.
    densities : tuple of int
        Boats for each free area of the pool `500-boats`, increasing.
    runs : int
        Seeds for each point and loop.
    still_minutes, loop_minutes : float
        Length of a run at one density, and of a loop.
    """

    sizes: tuple[int, ...]
    densities: tuple[int, ...]
    runs: int
    still_minutes: float = 60.0
    loop_minutes: float = 60.0

    def still(self, settings: Settings, growth: Growth, density: int) -> tuple[RunSpec, ...]:
        """Return the runs at one density without noise."""
        length = settings.duration_s(self.still_minutes)
        return self._seeded(length, settings.seed, growth.scene(density), "law", "window")

    def noise_loop(self, settings: Settings, growth: Growth) -> tuple[RunSpec, ...]:
        """Return the loops of bw."""
        scene = growth.scene(_LOOP_DENSITY, _LOOP_BW_S)
        length = settings.duration_s(self.loop_minutes)
        return self._seeded(length, settings.seed, scene, "noise-loop", "order")

    def density_loop(self, settings: Settings, growth: Growth) -> tuple[RunSpec, ...]:
        """Return the loops of the density, from the lowest to `DENSITY_RATIO` times it."""
        kind = "length-loop" if WAYS[growth.way] else "density-loop"
        length, scene = settings.duration_s(self.loop_minutes), growth.scene(self.densities[0])
        return self._seeded(length, settings.seed, scene, kind, "order")

    def growths(self) -> list[Growth]:
        """Return all sizes in all ways."""
        return [Growth(way, n) for way in WAYS for n in self.sizes]

    def all_runs(self, settings: Settings) -> list[RunSpec]:
        """Return every run."""
        specs: list[RunSpec] = []
        for growth in self.growths():
            for density in self.densities:
                specs += self.still(settings, growth, density)
            specs += self.noise_loop(settings, growth)
            specs += self.density_loop(settings, growth)
        return specs

    def core_minutes(self, settings: Settings) -> float:
        """Return about how long one core takes for all runs, in minutes."""
        hours = sum(s.parameters.n_boats * s.duration_s / 3600 for s in self.all_runs(settings))
        return _CORE_S * hours / 60

    def _seeded(
        self, length_s: float, first: int, scene: FlockParameters, protocol: str, keep: str
    ) -> tuple[RunSpec, ...]:
        return tuple(
            RunSpec(
                parameters=scene,
                seed=seed,
                duration_s=length_s,
                sample_hz=_SAMPLE_HZ,
                protocol=protocol,
                keep=keep,
            )
            for seed in range(first, first + self.runs)
        )


FULL = TransitionDesign(
    sizes=(50, 100, 200, 400, 800, 1600), densities=(20, 23, 26, 29, 32, 36, 42, 50), runs=4
)
"""Six sizes; some 150 minutes of one core."""

DESIGNS = (
    TransitionDesign(
        sizes=(100, 400, 1600),
        densities=(20, 26, 32),
        runs=3,
        still_minutes=12.0,
        loop_minutes=15.0,
    ),
    TransitionDesign(
        sizes=(100, 400, 1600),
        densities=(20, 23, 26, 29, 36),
        runs=3,
        still_minutes=20.0,
        loop_minutes=45.0,
    ),
    FULL,
)
"""By the time they take: some 8, 23 and 150 minutes of one core."""


def within(settings: Settings) -> TransitionDesign:
    """Return the largest design that the budget allows.

    Raises
    ------
    ParameterError
        If it does not suffice for the smallest design.
    """
    for design in reversed(DESIGNS):
        if design.core_minutes(settings) <= settings.budget_core_min:
            return design
    least = DESIGNS[0].core_minutes(settings)
    raise ParameterError(
        f"budget = {settings.budget_core_min:g} core-minutes is not enough for transition-order: "
        f"at least {least:.1f}, or shorter runs"
    )
