"""`LeadersEnv`: one policy steering all leaders of a flock, behind Gymnasium's interface."""

import copy
from typing import Any, Self

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from flockenv import _core
from flockenv.action import flat_actions, joint_action_space
from flockenv.batch import LeaderBatch, drawn_seed
from flockenv.observation import (
    OBSERVATION_VERSION,
    observation_entries,
    observation_space,
    observation_table,
)
from flockenv.options import EnvOptions, arguments_table
from flockenv.reward import terms_table
from flockenv.screen import DEFAULT_SIZE, RENDER_MODES, Screen

__all__ = ["LeadersEnv"]


class LeadersEnv(gymnasium.Env[NDArray[np.float32], NDArray[Any]]):
    """Lead a flock of boats around an annular pool.

    ## Description
    Boats drive through a ring-shaped pool: forward for 2 s, drifting, backward for `bw_s`,
    drifting, and so on. They align by nothing but frictionless, perfectly inelastic collisions;
    backing makes them spin, the more the longer it lasts, which destroys order (Tarcai et al.
    2011). A few of them, the leaders, have a rudder. The task is to make the *normal* boats
    circulate in the target direction.

    ## Action space
    `Box(-1, 1, (k,), float32)`: the rudders of leaders 0 to k - 1, held for a control step. A
    positive rudder turns a boat that moves forward counter-clockwise, and works in reverse on one
    that moves backward. Numbers beyond ±1 are clipped, NaN is an error. With `rudder_levels=n` it
    is `MultiDiscrete([n] * k)`: levels 0 to n - 1 are rudders evenly spaced from -1 to 1.

    ## Observation space
    `Box` of shape (k * observation size,), float32: what leader 0 observes, then leader 1, and so
    on. Everything is in the local-angle polar (LAP) frame of the leader's own place, outward and
    clockwise, scaled and clipped at the bounds below.

    {observation_table}

    ## Rewards
    The weighted sum of the terms below, mean over leaders; `signed_order` with weight 1 unless
    `reward` says otherwise.

    {reward_table}

    ## Starting state
    Boats at random places with random headings, not overlapping, at rest; phase fw begins. The
    seed fixes the start, the noise (whatever the policy does), the target and the noise level.

    ## Episode end
    Truncated after `episode_s`; never terminated.

    ## Arguments
    {arguments_table}

    ## Version history
    - v0, observation version {observation_version}: initial version.
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
        parsed = EnvOptions.parse(options)
        self.parameters = parsed.parameters
        self.num_leaders = parsed.parameters.n_leaders
        self._batch = LeaderBatch(parsed, [self.num_leaders], "disabled")
        settings = self._batch.settings
        self.render_mode = render_mode
        self._screen = Screen(render_mode, render_size, settings["control_hz"])
        self.metadata = {**self.metadata, "render_fps": settings["control_hz"]}
        self.observation_space = observation_space(settings["observation"], self.num_leaders)
        self.action_space = joint_action_space(settings["rudder_levels"], self.num_leaders)
        self.state_space = self._batch.state_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin an episode.

        Parameters
        ----------
        seed
            Fixes this episode, and those that follow without a seed. None goes on to the next one.
        options
            For this episode: ``target`` ("cw", "ccw", "random", "alternate"), ``bw_s`` in s,
            ``state`` (a dictionary with pose (n, 3) and, if need be, velocity (n, 3), time_s and
            allow_overlap as in `Flock.set_state`) or ``snapshot`` (bytes of `Flock.snapshot` of a
            flock with the same parameters, target and bw_s aside).

        Returns
        -------
        observation : numpy.ndarray
            Shape (k * observation size,), float32.
        info : dict
            Target, noise level and seed of the episode.
        """
        super().reset(seed=seed)
        self._batch.reset([seed], options, lambda: drawn_seed(self.np_random))
        if self._screen.is_live:
            self._screen.show(self.flock)
        return self.observe(), self._batch.begin_info(0)

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
        flat = flat_actions(action, (self.num_leaders,))
        rows, rewards, truncated = self._batch.core.step(flat)
        terms = {name: float(each.mean()) for name, each in self._batch.reward_terms().items()}
        info: dict[str, Any] = {"reward_terms": terms}
        over = bool(truncated[0])
        if over:
            info.update(self._batch.end_info(0))
        if self._screen.is_live:
            self._screen.show(self.flock)
        return rows.reshape(-1), float(rewards.mean()), False, over, info

    def observe(self) -> NDArray[np.float32]:
        """Return the observation as it is now."""
        return self._batch.core.observe().reshape(-1)

    def state(self) -> NDArray[np.float32]:
        """Return the global state, shape (state size,), float32."""
        return self._batch.core.state(0)

    def episode(self) -> dict[str, Any]:
        """Return target, noise level, seed and step of the episode."""
        return self._batch.core.episode(0)

    @property
    def flock(self) -> _core.Flock:
        """A copy of the flock as it is now."""
        return self._batch.core.flock(0)

    def get_state(self) -> bytes:
        """Return everything that the future depends on, as bytes."""
        return self._batch.core.to_bytes()

    def set_state(self, state: bytes) -> None:
        """Continue from `get_state` of an environment with the same options, bit for bit."""
        self._batch.core.restore(state)

    def clone(self) -> Self:
        """Return an independent copy that goes on exactly as this one."""
        return copy.deepcopy(self)

    def render(self) -> NDArray[np.uint8] | None:
        """Return a frame, (height, width, 3) uint8, where `render_mode` is "rgb_array".

        With "human" every reset and step shows itself in a window (see `rendering.Window` for its
        keys), and nothing is returned.
        """
        return None if self.render_mode is None else self._screen.render(self.flock)

    def close(self) -> None:
        """Close the window, if there is one; it stays closed."""
        self._screen.close()


def _specification(template: str) -> str:
    """Return a docstring with its tables filled in from the core's data."""
    tables = {
        "observation_table": observation_table(observation_entries()),
        "reward_table": terms_table(),
        "arguments_table": arguments_table(),
        "observation_version": str(OBSERVATION_VERSION),
    }
    for name, table in tables.items():
        template = template.replace(f"{{{name}}}", table.replace("\n", "\n    "))
    return template


LeadersEnv.__doc__ = _specification(LeadersEnv.__doc__ or "")
