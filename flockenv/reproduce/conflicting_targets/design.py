"""What `conflicting-targets` runs: flocks whose leaders head for two directions, in two pools.

Clockwise leaders are k1, counter-clockwise ones k2. The physics is symmetric under reflection, so
that the larger side is always the clockwise one. The noise is the critical one of each pool with 27
boats, where flocks order without leaders now and then, and change their direction.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

from flockenv.parameters import FlockParameters
from flockenv.reproduce.reproduction import Settings, within_budget
from flockenv.runs.protocols.hysteresis import resized
from flockenv.runs.spec import RunSpec

__all__ = [
    "AGAINST",
    "DESIGNS",
    "FULL",
    "LEADERLESS",
    "POLICIES",
    "POOLS",
    "ConflictDesign",
    "Match",
    "Setup",
    "within",
]

Match = tuple[int, int]
"""Clockwise and counter-clockwise leaders, k1 and k2."""

POOLS = ("500-boats", "table-1")
AGAINST = "learned against the law"
POLICIES: Mapping[str, str] = {
    "steering law": "law",
    "tuned damped law": "tuned damped law ({pool})",
    "learned": "learned ({pool})",
    AGAINST: "learned ({pool}) against law",
}
"""The protocol of runs by policy; the tuned and the learned policy are those of the pool. The last
one leads clockwise as learned, and counter-clockwise by the paper's law."""

LEADERLESS: Match = (0, 0)
_BOATS = 27
_DT_S = 0.05
_SAMPLE_HZ = 0.5
_BOAT_HOUR_S = 0.011
"""Seconds of one core that an hour of a boat takes."""

_DECISIONS_S = {"steering law": 0.0, "tuned damped law": 0.55, "learned": 3.7, AGAINST: 4.3}
"""Seconds of one core that an hour of a flock takes besides, for what leaders decide."""


@dataclass(frozen=True, slots=True)
class Setup:
    """A policy in flocks of one size in one pool."""

    policy: str
    pool: str
    n_boats: int

    @property
    def scale(self) -> int:
        """Leaders of larger flocks for each leader of a flock of 27."""
        return round(self.n_boats / _BOATS)

    @property
    def words(self) -> str:
        """The setup as claims name it."""
        return f"{self.policy}, {self.pool}, {self.n_boats} boats"

    def parameters(self, match: Match) -> FlockParameters:
        """Return those of flocks with these leaders; larger flocks have a pool of one density."""
        leaders = ("cw",) * match[0] + ("ccw",) * match[1]
        is_small = self.n_boats == _BOATS
        return FlockParameters.preset("simulation").replace(
            n_boats=self.n_boats,
            n_leaders=len(leaders),
            target=leaders or "cw",
            pool=self.pool if is_small else resized(self.pool, self.n_boats / _BOATS, False),
            bw_s=FlockParameters.critical_bw_s("simulation", self.pool),
            dt_s=_DT_S,
        )


@dataclass(frozen=True, slots=True)
class ConflictDesign:
    """Policies, sizes and seeds.

    Attributes
    ----------
    runs : mapping of int
        Seeds for each match, by policy of `POLICIES`, the paper's law first. Flocks without leaders
        have as many as those of the law, and policies that take longer have fewer.
    sizes : tuple of int
        Numbers of boats, increasing.
    minutes : float
        Length of a run, whose second half counts.
    """

    runs: Mapping[str, int]
    sizes: tuple[int, ...]
    minutes: float

    @property
    def policies(self) -> tuple[str, ...]:
        """Of `POLICIES`, the paper's law first."""
        return tuple(self.runs)

    def setups(self) -> list[Setup]:
        """Return every policy in every pool and size."""
        combined = product(self.sizes, POOLS, self.policies)
        return [Setup(policy, pool, n) for n, pool, policy in combined]

    def matches(self, setup: Setup) -> tuple[Match, ...]:
        """Return the matches of a setup, in flocks of 27 with one to six leaders."""
        small = _UNLIKE if setup.policy == AGAINST else _ALIKE
        return tuple((setup.scale * k1, setup.scale * k2) for k1, k2 in small)

    def specs(self, settings: Settings, setup: Setup, match: Match) -> tuple[RunSpec, ...]:
        """Return the runs of a match; those without leaders are the same for all policies."""
        policy = self.policies[0] if match == LEADERLESS else setup.policy
        return tuple(
            RunSpec(
                parameters=setup.parameters(match),
                seed=seed,
                duration_s=settings.duration_s(self.minutes),
                sample_hz=_SAMPLE_HZ,
                protocol=POLICIES[policy].format(pool=setup.pool),
                keep="order",
            )
            for seed in range(settings.seed, settings.seed + self.runs[policy])
        )

    def all_runs(self, settings: Settings) -> list[RunSpec]:
        """Return every run once."""
        specs = (
            spec
            for setup in self.setups()
            for match in (LEADERLESS, *self.matches(setup))
            for spec in self.specs(settings, setup, match)
        )
        return list(dict.fromkeys(specs))

    def core_minutes(self, settings: Settings) -> float:
        """Return about how long one core takes for all runs, in minutes."""
        decisions = sum(
            len(self.matches(setup)) * self.runs[setup.policy] * _DECISIONS_S[setup.policy]
            for setup in self.setups()
        )
        boats = sum(spec.parameters.n_boats for spec in self.all_runs(settings))
        hours = settings.duration_s(self.minutes) / 3600
        return hours * (decisions + _BOAT_HOUR_S * boats) / 60


_ALIKE: tuple[Match, ...] = ((1, 0), (1, 1), (2, 1), (3, 2), (3, 3), (4, 2), (5, 1), (6, 0))
_UNLIKE: tuple[Match, ...] = ((1, 1), (3, 3), (2, 4))

_LAW: Mapping[str, int] = {"steering law": 48}
_LAWS: Mapping[str, int] = {**_LAW, "tuned damped law": 24}
_ALL: Mapping[str, int] = {**_LAWS, "learned": 12, AGAINST: 12}

FULL = ConflictDesign(
    runs={policy: 2 * runs for policy, runs in _ALL.items()}, sizes=(27, 100), minutes=60.0
)
DESIGNS = (
    ConflictDesign(runs={"steering law": 12}, sizes=(27,), minutes=60.0),
    ConflictDesign(runs=_LAW, sizes=(27,), minutes=60.0),
    ConflictDesign(runs=_LAWS, sizes=(27,), minutes=60.0),
    ConflictDesign(runs=_ALL, sizes=(27,), minutes=60.0),
    ConflictDesign(runs=_ALL, sizes=(27, 100), minutes=60.0),
    FULL,
)
"""By the time they take; each contains the runs of the one before."""


def within(settings: Settings) -> ConflictDesign:
    """Return the largest of `DESIGNS` that the budget allows; errors as for `within_budget`."""
    return within_budget("conflicting-targets", DESIGNS, settings)
