"""What Section 5 ran: flocks, backward durations, densities and seeds of figures 14 to 17."""

from dataclasses import dataclass

from flockenv.parameters import FlockParameters
from flockenv.reproduce.reproduction import Settings
from flockenv.runs.spec import RunSpec

__all__ = ["FIGURES", "POOL", "PRESETS", "TABLE", "Design", "Model"]

POOL = "500-boats"
"""The pool of figures 14 to 17: the one with the free space of Section 2.2."""

_MINUTES = 60.0
_LEADER_SHARE = 0.2


@dataclass(frozen=True, slots=True)
class Model:
    """Table 3 with one reading of how time steps and noise are taken, in one pool.

    Attributes
    ----------
    name : str
        For legends and tables.
    preset : str
        The preset whose scheme is used.
    noise : str
        As in `FlockParameters`.
    pool : str
        A named pool.
    """

    name: str
    preset: str
    noise: str
    pool: str = POOL

    def parameters(self, n_boats: int, n_leaders: int, bw_s: float) -> FlockParameters:
        """Return the parameters of one point of a figure."""
        return FlockParameters.preset(self.preset).replace(
            noise=self.noise, pool=self.pool, n_boats=n_boats, n_leaders=n_leaders, bw_s=bw_s
        )


PRESETS = tuple(
    Model(name, name, FlockParameters.preset(name).noise) for name in ("paper", "simulation")
)
"""The presets that figures show side by side."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """Which runs stand for a model.

    Attributes
    ----------
    levels_s : tuple of float
        Backward durations: lengths of the backward phase in s, increasing.
    densities : tuple of int
        Numbers of boats of figure 17, at bw = 0.
    runs : int
        Runs for each point, of seeds one after another.
    """

    levels_s: tuple[float, ...]
    densities: tuple[int, ...]
    runs: int

    def at(self, settings: Settings, parameters: FlockParameters) -> list[RunSpec]:
        """Return the runs of one point."""
        seeds = range(settings.seed, settings.seed + self.runs)
        length = settings.duration_s(_MINUTES)
        return [RunSpec(parameters=parameters, seed=seed, duration_s=length) for seed in seeds]

    def noise_series(
        self, settings: Settings, model: Model, n_boats: int, with_leaders: bool
    ) -> list[list[RunSpec]]:
        """Return the runs of each backward duration."""
        leaders = round(_LEADER_SHARE * n_boats) if with_leaders else 0
        points = (model.parameters(n_boats, leaders, bw_s) for bw_s in self.levels_s)
        return [self.at(settings, point) for point in points]

    def density_series(self, settings: Settings, model: Model) -> list[list[RunSpec]]:
        """Return the runs of each number of boats."""
        return [self.at(settings, model.parameters(n, 0, 0.0)) for n in self.densities]


FIGURES = Design(
    levels_s=tuple(round(0.05 * place, 2) for place in range(25)),
    densities=tuple(range(20, 51)),
    runs=3,
)
"""For the figures: bw from 0 to 1.2 s by 0.05 s, and every number of boats from 20 to 50."""

TABLE = Design(
    levels_s=tuple(round(0.1 * place, 1) for place in range(13)),
    densities=tuple(range(20, 51, 3)),
    runs=2,
)
"""For the table of claims by scheme, noise and pool: a part of the runs of `FIGURES`."""
