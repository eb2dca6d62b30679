"""What `leader-fraction` runs: growing flocks with few to many leaders, under several policies.

The density is that of 27 boats in the pool `500-boats`, and the noise is that of the preset
`simulation`. Every run starts at random, so that a flock which orders of its own accord picks a
direction that its leaders may or may not have decided.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from flockenv.parameters import FlockParameters
from flockenv.reproduce.reproduction import Settings, within_budget
from flockenv.reproduce.transition.design import Growth
from flockenv.runs.spec import RunSpec

__all__ = ["DENSITY", "DESIGNS", "FULL", "POLICIES", "FractionDesign", "Setup", "within"]

DENSITY = 27.0
"""Boats for each free area of the pool `500-boats`."""

POLICIES: Mapping[str, str] = {
    "steering law": "law",
    "tuned damped law": "tuned damped law (500-boats)",
    "learned": "learned (500-boats)",
}
"""The protocol of runs by policy; the tuned and the learned policy are those of `500-boats`."""

_CORE_S = {"whole pool": 0.012, "circumference": 0.05}
"""Seconds of one core that an hour of a boat takes, by way of growing."""

_SAMPLE_HZ = 0.5
_DT_S = 0.05


Setup = tuple[str, Growth]
"""A policy in flocks of one size in one way of growing."""


@dataclass(frozen=True, slots=True)
class FractionDesign:
    """Policies, sizes, numbers of leaders and seeds.

    Attributes
    ----------
    leaders : mapping of tuples of int
        By policy of `POLICIES`, the paper's law first, and growth, by increasing size: the numbers
        of leaders, increasing.
    runs : mapping of int
        Seeds for each number of leaders, by growth, by increasing size. A long pool of many boats
        is like several pools in a row, and needs fewer.
    minutes : float
        Length of a run, whose second half counts.
    """

    leaders: Mapping[Setup, tuple[int, ...]]
    runs: Mapping[Growth, int]
    minutes: float

    @property
    def policies(self) -> tuple[str, ...]:
        """Of `POLICIES`, the paper's law first."""
        return tuple(dict.fromkeys(policy for policy, _ in self.leaders))

    @property
    def sizes(self) -> tuple[int, ...]:
        """Numbers of boats, increasing."""
        return tuple(dict.fromkeys(growth.n_boats for growth in self.runs))

    def curve(
        self, settings: Settings, policy: str, growth: Growth
    ) -> dict[int, tuple[RunSpec, ...]]:
        """Return the runs of a policy in flocks of one size, by number of leaders."""
        bw_s = FlockParameters.preset("simulation").bw_s
        parameters = growth.parameters(DENSITY, bw_s, _DT_S)
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
                for seed in range(settings.seed, settings.seed + self.runs[growth])
            )
            for k in self.leaders[policy, growth]
        }

    def all_runs(self, settings: Settings) -> list[RunSpec]:
        """Return every run once: 27 boats have the same pool in both ways of growing."""
        specs = (
            spec
            for policy, growth in self.leaders
            for each in self.curve(settings, policy, growth).values()
            for spec in each
        )
        return list(dict.fromkeys(specs))

    def core_minutes(self, settings: Settings) -> float:
        """Return about how long one core takes for all runs, in minutes."""
        hours = settings.duration_s(self.minutes) / 3600
        # Flocks of 27, which are made once for both ways, hardly take any of it.
        seconds = sum(
            _CORE_S[growth.way] * growth.n_boats * self.runs[growth] * len(numbers)
            for (_, growth), numbers in self.leaders.items()
        )
        return hours * seconds / 60


@dataclass(frozen=True, slots=True)
class _Curves:
    """What is run in flocks of one size in one way of growing.

    The fewest leaders are those of each policy, and every other number is twice the one before.
    Runs of up to 400 boats, of other seeds, put the fewest below the proportion that was measured.
    """

    runs: int
    numbers: int
    fewest: tuple[int, int, int]


_CURVES: Mapping[Growth, _Curves] = {
    Growth("whole pool", 27): _Curves(24, 4, (1, 1, 1)),
    Growth("whole pool", 100): _Curves(12, 5, (1, 1, 1)),
    Growth("whole pool", 400): _Curves(12, 5, (4, 2, 1)),
    Growth("whole pool", 1600): _Curves(8, 5, (8, 8, 4)),
    Growth("circumference", 27): _Curves(24, 4, (1, 1, 1)),
    Growth("circumference", 100): _Curves(12, 5, (1, 1, 1)),
    Growth("circumference", 400): _Curves(8, 4, (16, 16, 8)),
    Growth("circumference", 1600): _Curves(8, 3, (64, 64, 64)),
}


def _design(policies: int, largest: int) -> FractionDesign:
    chosen = {growth: each for growth, each in _CURVES.items() if growth.n_boats <= largest}
    leaders = {
        (policy, growth): tuple(each.fewest[place] * 2**power for power in range(each.numbers))
        for place, policy in enumerate(tuple(POLICIES)[:policies])
        for growth, each in chosen.items()
    }
    runs = {growth: each.runs for growth, each in chosen.items()}
    return FractionDesign(leaders, runs, minutes=60.0)


FULL = _design(len(POLICIES), 1600)

DESIGNS = (_design(1, 400), _design(len(POLICIES), 400), FULL)
"""By the time they take; each contains the runs of the one before."""


def within(settings: Settings) -> FractionDesign:
    """Return the largest of `DESIGNS` that the budget allows; errors as for `within_budget`."""
    return within_budget("leader-fraction", DESIGNS, settings)
