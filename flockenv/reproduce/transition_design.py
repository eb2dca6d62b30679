"""What `transition-order` runs: growing flocks at fixed density, and loops, in two ways of growing.

Scaling the whole pool also lowers the length of wall for each boat; growing the circumference at
fixed width does not. Both are run.
"""

from dataclasses import dataclass

from flockenv.loops import resized
from flockenv.parameters import FlockParameters
from flockenv.reproduce.reproduction import Settings
from flockenv.runs import RunSpec

__all__ = ["BUDGET", "FULL", "WAYS", "Growth", "TransitionDesign"]

WAYS = {"whole pool": False, "circumference": True}
"""Ways of growing: whether the channel keeps its width."""

BUDGET = "some two hours of one core for each way of growing"
"""What the full design takes, by the cost of short runs of 200 and 800 boats (0.03 s of one core
for each boat and hour of flock time)."""

_POOL = "500-boats"
_MINUTES = 60.0
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
    """

    sizes: tuple[int, ...]
    densities: tuple[int, ...]
    runs: int

    def still(self, settings: Settings, growth: Growth, density: int) -> tuple[RunSpec, ...]:
        """Return the runs at one density without noise."""
        return self._seeded(settings, growth.scene(density), "law", "window")

    def noise_loop(self, settings: Settings, growth: Growth) -> tuple[RunSpec, ...]:
        """Return the loops of bw."""
        scene = growth.scene(_LOOP_DENSITY, _LOOP_BW_S)
        return self._seeded(settings, scene, "noise-loop", "order")

    def density_loop(self, settings: Settings, growth: Growth) -> tuple[RunSpec, ...]:
        """Return the loops of the density, from the lowest to `DENSITY_RATIO` times it."""
        kind = "length-loop" if WAYS[growth.way] else "density-loop"
        return self._seeded(settings, growth.scene(self.densities[0]), kind, "order")

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

    def _seeded(
        self, settings: Settings, scene: FlockParameters, protocol: str, keep: str
    ) -> tuple[RunSpec, ...]:
        length = settings.duration_s(_MINUTES)
        return tuple(
            RunSpec(
                parameters=scene,
                seed=seed,
                duration_s=length,
                sample_hz=_SAMPLE_HZ,
                protocol=protocol,
                keep=keep,
            )
            for seed in range(settings.seed, settings.seed + self.runs)
        )


FULL = TransitionDesign(
    sizes=(50, 100, 200, 400, 800, 1600), densities=(20, 23, 26, 29, 32, 36, 42, 50), runs=4
)
"""Up to 1600 boats."""
