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

__all__ = ["DENSITY", "DESIGNS", "FULL", "POLICIES", "FractionDesign", "Setup", "within"]

DENSITY = 27.0
"""Boats for each free area of the pool `500-boats`."""

POLICIES: Mapping[str, str] = {
    "steering law": "law",
    "tuned damped law": "tuned damped law (500-boats)",
    "learned": "learned (500-boats)",
}
"""The protocol of runs by policy; the tuned and the learned policy are those of `500-boats`."""

_CORE_S = {"whole pool": 0.010, "circumference": 0.014}
"""Seconds of one core that an hour of a boat takes, by way of growing."""

_SAMPLE_HZ = 0.5


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
        Seeds for each number of leaders, by number of boats.
    minutes : float
        Length of a run, whose second half counts.
    """

    leaders: Mapping[Setup, tuple[int, ...]]
    runs: Mapping[int, int]
    minutes: float

    @property
    def policies(self) -> tuple[str, ...]:
        """Of `POLICIES`, the paper's law first."""
        return tuple(dict.fromkeys(policy for policy, _ in self.leaders))

    @property
    def sizes(self) -> tuple[int, ...]:
        """Numbers of boats, increasing."""
        return tuple(self.runs)

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
                for seed in range(settings.seed, settings.seed + self.runs[growth.n_boats])
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
            _CORE_S[growth.way] * growth.n_boats * self.runs[growth.n_boats] * len(numbers)
            for (_, growth), numbers in self.leaders.items()
        )
        return hours * seconds / 60


_FEWEST: Mapping[str, Mapping[int, tuple[int, int, int]]] = {
    "whole pool": {27: (1, 1, 1), 100: (1, 1, 1), 400: (4, 2, 1), 1600: (8, 8, 4)},
    "circumference": {27: (1, 1, 1), 100: (1, 1, 1), 400: (16, 16, 8), 1600: (64, 64, 64)},
}
"""The fewest leaders, by way of growing, number of boats and policy. Runs of up to 400 boats, of
other seeds, put them below the proportion that was measured."""

_NUMBERS: Mapping[str, Mapping[int, int]] = {
    "whole pool": {27: 4, 100: 5, 400: 5, 1600: 5},
    "circumference": {27: 4, 100: 5, 400: 4, 1600: 4},
}
"""How many numbers of leaders, each twice the one before."""

_RUNS = {27: 24, 100: 24, 400: 12, 1600: 8}


def _design(policies: int, largest: int) -> FractionDesign:
    sizes = [n for n in _RUNS if n <= largest]
    leaders = {
        (policy, Growth(way, n)): tuple(
            _FEWEST[way][n][place] * 2**power for power in range(_NUMBERS[way][n])
        )
        for place, policy in enumerate(tuple(POLICIES)[:policies])
        for way, n in product(WAYS, sizes)
    }
    return FractionDesign(leaders, {n: _RUNS[n] for n in sizes}, minutes=60.0)


FULL = _design(len(POLICIES), 1600)

DESIGNS = (_design(1, 400), _design(len(POLICIES), 400), FULL)
"""By the time they take; each contains the runs of the one before."""


def within(settings: Settings) -> FractionDesign:
    """Return the largest of `DESIGNS` that the budget allows; errors as for `within_budget`."""
    return within_budget("leader-fraction", DESIGNS, settings)
