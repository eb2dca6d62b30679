"""`LeadersEnv`: one policy steering all leaders of a flock, behind Gymnasium's interface."""

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv.envs.base import SingleEnvironmentBase
from flockenv.envs.batch import drawn_seed
from flockenv.envs.docs import specified
from flockenv.envs.observation import ObservationSpace
from flockenv.envs.render_mode import RENDER_MODES
from flockenv.envs.spaces import flat_actions, joint_action_space
from flockenv.rendering.frames import DEFAULT_SIZE

__all__ = ["LeadersEnv"]


@specified
class LeadersEnv(SingleEnvironmentBase, gymnasium.Env[NDArray[np.float32], NDArray[Any]]):
    """Lead a flock of boats around a ring-shaped pool: one policy steers all leaders.

    ``gymnasium.make("flockenv/Leaders-v0", **options)``

    ## Start here
    {start}

    ## Description
    {task}

    ## Action space
    `Box(-1, 1, (k,), float32)`: the rudders of leaders 0 to k - 1; `MultiDiscrete([n] * k)` with
    `rudder_levels=n`. {rudder}

    ## Observation space
    `Box` of shape (k * observation size,), float32: what leader 0 observes, then leader 1, and so
    on. {frame}

    {observation_table}

    `state()` gives the global state, for critics: the entries of `boat` for each boat in order,
    then the rest.

    {state_table}

    ## Rewards
    The weighted sum of the terms below, mean over leaders; `signed_order` with weight 1 unless
    `reward` says otherwise. Each step's info has the `"reward_terms"`, the last one the
    `"episode_summary"`.

    {general_sum} The joint reward stays the mean over leaders, so that k1 leaders against k2 are
    rewarded with (k1 - k2)/k of the signed order towards the k1 leaders' target.

    {reward_table}

    ## Starting state
    {starting_state}

    ## Episode end
    {episode_end}

    ## Arguments
    {arguments_table}

    ## Version history
    {version_history}
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - Gymnasium's own declaration
        "render_modes": list(RENDER_MODES),
        "render_fps": 10.0,
    }

    def __init__(
        self,
        *,
        render_mode: str | None = None,
        render_size: tuple[int, int] = DEFAULT_SIZE,
        **options: Any,
    ) -> None:
        self._set_up(options, render_mode, render_size)
        settings = self._batch.settings
        self.observation_space = ObservationSpace(settings, self.num_leaders)
        self.action_space = joint_action_space(settings["rudder_levels"], self.num_leaders)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start an episode.

        Parameters
        ----------
        seed
            Fixes this episode, and those that follow without a seed. None continues with the
            next one.
        options
            For this episode: ``target`` ("cw", "ccw", "random", "alternate" or one of "cw" and
            "ccw" per leader), ``bw_s`` in s, ``state`` (a dictionary with pose (n, 3) and, if need
            be, velocity (n, 3), time_s and allow_overlap as in `Flock.set_state`) or ``snapshot``
            (bytes of `Flock.snapshot` of a flock with the same parameters, target and bw_s aside).

        Returns
        -------
        observation : numpy.ndarray
            Shape (k * observation size,), float32.
        info : dict
            Target, backward duration and seed of the episode.
        """
        self._reset(seed, options, lambda: drawn_seed(self.np_random))
        super().reset(seed=None if seed is None else int(seed))
        self._show()
        return self.observe(), self._batch.reset_info(0)

    def step(
        self, action: ArrayLike
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Take one control step.

        Parameters
        ----------
        action
            Shape (k,).

        Returns
        -------
        observation, reward, terminated, truncated, info
            The info has the step's ``"reward_terms"``, means over leaders, and at the end the
            ``"episode_summary"``.

        Raises
        ------
        ParameterError
            For NaN and wrong shapes; nothing has moved then.
        EpisodeError
            Before the first reset and after the end.
        """
        flat = flat_actions(action, (self.num_leaders,), self._batch.settings["rudder_levels"])
        rows, rewards, truncated = self._batch.step(flat)
        terms = {name: float(each.mean()) for name, each in self._batch.reward_terms().items()}
        info: dict[str, Any] = {"reward_terms": terms}
        over = bool(truncated[0])
        if over:
            info.update(self._batch.end_info(0))
        self._show()
        return rows.reshape(-1), float(rewards.mean()), False, over, info

    def observe(self) -> NDArray[np.float32]:
        """Return the present observation."""
        return self._batch.observe().reshape(-1)
