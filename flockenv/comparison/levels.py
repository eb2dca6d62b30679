"""Suite v3: frozen levels in which leaders learn to steer from nothing, and their scores.

If a level or a number in one changes, it is another suite.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv.comparison.episodes import Progress, no_progress, run_episodes
from flockenv.envs.ids import ENVIRONMENTS
from flockenv.envs.options import EnvOptions
from flockenv.errors import ParameterError, short_repr
from flockenv.flock import STEP_STATISTICS
from flockenv.parameters import FlockParameters
from flockenv.policies.base import Policy
from flockenv.policies.names import DAMPED_LAW
from flockenv.policies.registry import policy
from flockenv.runs.seeds import release_seeds
from flockenv.statistics import mean_interval, two_way_interval

SUITE = "v3"
"""Name of the suite."""

FLOCKS = 512
"""Flocks that all entries of a level lead."""

NO_STEERING, REFERENCE = "straight ahead", DAMPED_LAW
"""The policies whose scores are 0 and 1."""

MEASURED = ("signed_order", *STEP_STATISTICS)
"""What is known of each flock: its signed order, and whether its run kept the tolerance."""

Led = Mapping[str, NDArray[Any]]
"""The `MEASURED` of flocks by name, shape (flocks,), or (policies, flocks) of several policies."""

BUDGETS = (30, 100, 300)
"""Flock-hours of a training, by which entries are classed; the last rollout may add 2 %."""

LEVEL_IDS: Mapping[str, str] = {
    "order-easy": "flockenv/Order-easy-v0",
    "order-noisy": "flockenv/Order-noisy-v0",
    "order-narrow": "flockenv/Order-narrow-v0",
    "order-wide": "flockenv/Order-wide-v0",
}
"""The environment of each level."""

_SEEDS = release_seeds("suite v3", FLOCKS)


@dataclass(frozen=True)
class Level:
    """A frozen task in which leaders choose rudders."""

    name: str
    parameters: FlockParameters
    #: Length of an episode in s.
    episode_s: float
    #: Options of the environment that hold for every policy.
    environment: Mapping[str, object]
    #: The observation of leaders in the level's environment.
    observation: Mapping[str, object]

    @classmethod
    def from_id(cls, name: str, env_id: str) -> "Level":
        """Return the level of an environment."""
        options = ENVIRONMENTS[env_id].options
        parsed = EnvOptions.parse(options)
        environment = {name: parsed.settings[name] for name in ("target", "control_hz")}
        return cls(
            name=name,
            parameters=parsed.parameters,
            episode_s=options["episode_s"],
            environment={**environment, "action_mode": "rudder"},
            observation=options.get("observation", {}),
        )

    def flock_hours(self, flocks: int = FLOCKS) -> float:
        """Return the hours of simulated time that a policy takes."""
        return flocks * self.episode_s / 3600.0

    def run(
        self, steers: Policy | str, flocks: int = FLOCKS, progress: Progress = no_progress
    ) -> Led:
        """Return the `MEASURED` of the level's first flocks, led by a policy, shape (flocks,)."""
        if not 2 <= flocks <= FLOCKS:
            raise ParameterError(
                f"flocks = {short_repr(flocks)} is not accepted: from 2 to {FLOCKS}"
            )
        checked = policy(steers, self.parameters.pool)
        found = run_episodes(
            self.parameters, checked, _SEEDS[:flocks], self.episode_s, progress, self.environment
        )
        return {name: found[name] for name in MEASURED}

    def references(self, flocks: int = FLOCKS, progress: Progress = no_progress) -> Led:
        """Return the `MEASURED` of flocks without steering and under the damped law.

        Their shape is (2, flocks); both policies lead the same flocks.
        """
        return stacked([self.run(name, flocks, progress) for name in (NO_STEERING, REFERENCE)])


LEVELS: Mapping[str, Level] = {
    name: Level.from_id(name, env_id) for name, env_id in LEVEL_IDS.items()
}
"""The levels by name."""


def stacked(led: Sequence[Led]) -> Led:
    """Return the flocks of several policies as one, shape (policies, flocks)."""
    return {name: np.array([own[name] for own in led]) for name in MEASURED}


def score(
    orders: ArrayLike, no_steering: NDArray[np.float64], reference: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Return the score of trainings: 0 for no steering, 1 for the damped law.

    Parameters
    ----------
    orders
        Signed orders, shape (trainings, flocks).
    no_steering, reference
        Signed orders of the same flocks without steering and under the damped law.

    Returns
    -------
    tuple of float
        The mean, and the ends of its interval. The interval accounts for the luck of the flocks,
        also in the two references, and for the luck of the trainings if there are two or more.
    """
    led = np.atleast_2d(np.asarray(orders, float))
    scale = float((reference - no_steering).mean())
    if not scale > 0.0:
        raise ParameterError(
            f"the damped law gains {scale:.3f} on no steering in these {led.shape[1]} flocks: "
            "there is no scale for a score"
        )
    found = float((led - no_steering).mean()) / scale
    # Each flock's effect on the ratio, to first order.
    moved = found + ((led - no_steering) - found * (reference - no_steering)) / scale
    return two_way_interval(moved) if len(moved) > 1 else mean_interval(moved[0])


def budget_of(flock_hours: float) -> str:
    """Return the class of a training by its flock-hours."""
    return next((str(most) for most in BUDGETS if flock_hours <= 1.02 * most), "more")
