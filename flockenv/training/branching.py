"""Groups of flocks that branch from one state with the same noise: only their leaders differ."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv.envs.vector import LeadersVectorEnv
from flockenv.parameters import FlockParameters
from flockenv.runs.seeds import POLICY_SEEDS

_SEEDS = POLICY_SEEDS["branches"]
#: The observation that holds only the lean features.
_OBSERVATION: dict[str, Any] = {
    **dict.fromkeys(("own", "phase", "target", "order"), False),
    "neighbors": 0,
    "lean_features": True,
}

Leans = Callable[[NDArray[np.float32]], NDArray[np.floating]]
"""Function from features (flocks, leaders, features) to leans (flocks, leaders)."""


def branch_seed(run: int) -> int:
    """Return the first of the 2²⁴ seeds for the flocks of the training with seed `run`."""
    return _SEEDS.seeds(1, run=run)[0]


class BranchingFlocks:
    """Groups of flocks of 27 boats with three leaders, at the pool's critical noise.

    Flocks i, i + groups, i + 2·groups and so on are a group. They start each branch from the same
    state and have the same noise. After a branch one of them is drawn at random, and all of the
    group continue from its state. When their episode is over, they start again at rest.

    Parameters
    ----------
    pool
        ``"wide"`` or ``"narrow"``.
    groups, size
        Number of groups, and flocks of each.
    branch_s, episode_s
        Whole seconds of a branch and of an episode.
    seed
        Seed of the training that uses them, from 0 to 2³² - 1.
    """

    def __init__(
        self, pool: str, *, groups: int, size: int, branch_s: int, episode_s: int, seed: int
    ) -> None:
        self.groups, self.size, self.branch_s = groups, size, branch_s
        self.env = LeadersVectorEnv(
            size * groups,
            autoreset_mode="disabled",
            pool=pool,
            n_boats=27,
            n_leaders=3,
            bw_s=FlockParameters.critical_bw_s("simulation", pool),
            observation=_OBSERVATION,
            mirror_to_target=True,
            action_mode="lean",
            decision_period_s=1.0,
            episode_s=branch_s,
            reward_horizon_s=1.0,
            physics="training",
        )
        self._random = np.random.default_rng([seed, 1])
        self._seeds = iter(_SEEDS.seeds(1 << 20, run=seed))
        self._branches_of_episode = episode_s // branch_s
        #: Branches so far in each group's episode. At the start groups differ, so that their
        #: episodes end at different times.
        self._branches_done = np.arange(groups) % self._branches_of_episode
        #: State of each group after the last branch.
        self._snapshots: list[bytes] = []
        self._targets = np.full(groups, "ccw")
        self._start_episodes(np.ones(groups, bool))

    @property
    def branch_hours(self) -> float:
        """Flock-hours of a branch of all flocks."""
        return self.size * self.groups * self.branch_s / 3600.0

    def branch(self, leans: Leans) -> NDArray[np.float64]:
        """Lead all flocks for a branch, and return their signed order in each of its seconds.

        Parameters
        ----------
        leans
            Function that decides once per second, from the 29 lean features. Its leans are clipped
            to [-1, 1].

        Returns
        -------
        numpy.ndarray
            Shape (seconds, flocks).
        """
        observations, orders = self._start_branch(), []
        for _ in range(self.branch_s):
            features = observations.reshape(len(observations), 3, -1)
            observations, rewards, *_ = self.env.step(np.clip(leans(features), -1.0, 1.0))
            orders.append(rewards)  # A reward is the signed order of a second.
        drawn_members = (self._random.random(self.groups) * self.size).astype(int)
        snapshots = self.env.snapshots()
        self._snapshots = [
            snapshots[group + self.groups * member] for group, member in enumerate(drawn_members)
        ]
        self._branches_done += 1
        return np.array(orders)

    def _start_branch(self) -> NDArray[np.float32]:
        """Start the next branch of each group, and return the leaders' observations."""
        if self._snapshots:
            continues = self._branches_done < self._branches_of_episode
            # The list of the groups' snapshots, repeated for each member.
            snapshots = self.size * self._snapshots
            options = {"snapshot": snapshots, "target": self._target_of_flocks()}
            if continues.any():
                self.env.reset(options={**options, "reset_mask": np.tile(continues, self.size)})
            if not continues.all():
                self._start_episodes(~continues)
                self._branches_done[~continues] = 0
        return self.env.observe()

    def _start_episodes(self, starts: NDArray[np.bool_]) -> None:
        """Start episodes at rest, in the groups for which `starts` is True.

        All flocks of a group have the same seed.
        """
        seeds = [next(self._seeds) if is_started else None for is_started in starts]
        self._targets[starts] = self._random.choice(["cw", "ccw"], starts.sum())
        options = {"target": self._target_of_flocks(), "reset_mask": np.tile(starts, self.size)}
        self.env.reset(seed=self.size * seeds, options=options)

    def _target_of_flocks(self) -> list[str]:
        """Return the target of each flock, from those of the groups."""
        return self.size * self._targets.tolist()
