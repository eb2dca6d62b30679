"""What `leader-fraction` runs: growing flocks with few to many leaders, under several policies.

The density is that of 27 boats in the pool `500-boats`, and the noise is that of the preset
`simulation`. Every run starts at random, so that a flock which orders of its own accord picks a
direction that its leaders may or may not have decided.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

from flockenv.parameters import FlockParameters
from flockenv.reproduce.reproduction import Settings, within_budget
from flockenv.reproduce.transition.design import WAYS, Growth
from flockenv.runs.spec import RunSpec

__all__ = ["DENSITY", "DESIGNS", "FULL", "POLICIES", "FractionDesign", "within"]

DENSITY = 27.0
"""Boats for each free area of the pool `500-boats`."""

POLICIES: Mapping[str, str] = {
    "steering law": "law",
    "tuned damped law": "tuned damped law (500-boats)",
    "learned": "learned (500-boats)",
}
"""The protocol of runs by policy; the tuned and the learned policy are those of `500-boats`."""

_CORE_S = 0.02
"""Seconds of one core that an hour of a boat takes: 0.0125 in a wide pool, 0.025 in a long one."""

_SAMPLE_HZ = 0.5


@dataclass(frozen=True, slots=True)
class FractionDesign:
    """Policies, sizes, numbers of leaders and seeds.

    Attributes
    ----------
    policies : tuple of str
        Of `POLICIES`, the paper's law first.
    leaders : mapping of tuples of int
        By number of boats, increasing: the numbers of leaders, increasing.
    runs : int
        Seeds for each number of leaders.
    minutes : float
        Length of a run, whose second half counts.
    """

    policies: tuple[str, ...]
    leaders: Mapping[int, tuple[int, ...]]
    runs: int
    minutes: float

    def curve(
        self, settings: Settings, policy: str, growth: Growth
    ) -> dict[int, tuple[RunSpec, ...]]:
        """Return the runs of a policy in flocks of one size, by number of leaders."""
        bw_s = FlockParameters.preset("simulation").bw_s
        parameters = growth.parameters(DENSITY, bw_s)
        return {
            k: tuple(
                RunSpec(
                    parameters=parameters.replace(n_leaders=k),
                    seed=seed,
                    duration_s=settings.duration_s(self.minutes),
                    sample_hz=_SAMPLE_HZ,
                    protocol=POLICIES[policy],
                    keep="order",
                )
                for seed in range(settings.seed, settings.seed + self.runs)
            )
            for k in self.leaders[growth.n_boats]
        }

    def curves(self) -> list[tuple[str, Growth]]:
        """Return every policy with every size in every way of growing."""
        return [
            (policy, Growth(way, n))
            for policy, way, n in product(self.policies, WAYS, self.leaders)
        ]

    def all_runs(self, settings: Settings) -> list[RunSpec]:
        """Return every run."""
        return [
            spec
            for policy, growth in self.curves()
            for specs in self.curve(settings, policy, growth).values()
            for spec in specs
        ]

    def core_minutes(self, settings: Settings) -> float:
        """Return about how long one core takes for all runs, in minutes."""
        hours = sum(s.parameters.n_boats * s.duration_s / 3600 for s in self.all_runs(settings))
        return _CORE_S * hours / 60


_LEADERS = {
    27: (1, 2, 3, 4, 6, 9),
    100: (1, 2, 3, 5, 8, 12),
    400: (1, 2, 4, 8, 16, 32),
    1600: (2, 4, 8, 16, 32, 64),
}
_SMALLER = {n: _LEADERS[n] for n in (27, 100, 400)}

FULL = FractionDesign(policies=tuple(POLICIES), leaders=_LEADERS, runs=16, minutes=60.0)

DESIGNS = (
    FractionDesign(policies=("steering law",), leaders=_SMALLER, runs=12, minutes=60.0),
    FractionDesign(policies=tuple(POLICIES), leaders=_SMALLER, runs=12, minutes=60.0),
    FULL,
)
"""By the time they take; each contains the runs of the one before."""


def within(settings: Settings) -> FractionDesign:
    """Return the largest of `DESIGNS` that the budget allows; errors as for `within_budget`."""
    return within_budget("leader-fraction", DESIGNS, settings)
