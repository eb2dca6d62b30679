"""Suite v3: frozen levels in which leaders learn to steer from nothing, and their scores.

If a level or one of its numbers changes, it is another suite.
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
"""Columns of each flock: its signed order, and whether its run kept the tolerance."""

Led = Mapping[str, NDArray[Any]]
"""The columns `MEASURED` by name: shape (flocks,), or (policies, flocks) for several policies."""

BUDGETS = (30, 100, 300)
"""Most flock-hours of a training in each class of entries; the last rollout may add 2 %."""

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
        """Return the simulated hours of all flocks that one policy leads."""
        return flocks * self.episode_s / 3600.0

    def run(
        self, steers: Policy | str, flocks: int = FLOCKS, progress: Progress = no_progress
    ) -> Led:
        """Return `MEASURED` for the level's first flocks, led by a policy: shape (flocks,)."""
        if not 2 <= flocks <= FLOCKS:
            raise ParameterError(
                f"flocks = {short_repr(flocks)} is not accepted: from 2 to {FLOCKS}"
            )
        leaders = policy(steers, self.parameters.pool)
        columns = run_episodes(
            self.parameters, leaders, _SEEDS[:flocks], self.episode_s, progress, self.environment
        )
        return {name: columns[name] for name in MEASURED}

    def references(self, flocks: int = FLOCKS, progress: Progress = no_progress) -> Led:
        """Return `MEASURED` without steering and under the damped law: shape (2, flocks).

        Both policies lead the same flocks.
        """
        return stacked([self.run(name, flocks, progress) for name in (NO_STEERING, REFERENCE)])


LEVELS: Mapping[str, Level] = {
    name: Level.from_id(name, env_id) for name, env_id in LEVEL_IDS.items()
}
"""The levels by name."""


def stacked(led: Sequence[Led]) -> Led:
    """Return the columns of several policies in one array each, shape (policies, flocks)."""
    return {name: np.array([columns[name] for columns in led]) for name in MEASURED}


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
        The mean score, and the ends of its interval. The interval accounts for chance in the
        flocks, which also moves the two references. With two trainings or more it also accounts for
        chance in the trainings.
    """
    gains = np.atleast_2d(np.asarray(orders, float)) - no_steering
    reference_gains = reference - no_steering
    scale = float(reference_gains.mean())
    if not scale > 0.0:
        raise ParameterError(
            f"the damped law gains {scale:.3f} on no steering in these {gains.shape[1]} flocks: "
            "there is no scale for a score"
        )
    mean_score = float(gains.mean()) / scale
    # The score is a ratio of means. To first order it is the mean of these scores of flocks.
    flock_scores = mean_score + (gains - mean_score * reference_gains) / scale
    if len(flock_scores) > 1:
        return two_way_interval(flock_scores)
    return mean_interval(flock_scores[0])


def budget_of(flock_hours: float) -> str:
    """Return the class of a training by its flock-hours: one of `BUDGETS` as text, or "more"."""
    return next((str(most) for most in BUDGETS if flock_hours <= 1.02 * most), "more")
