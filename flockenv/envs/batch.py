"""The batch of flocks in the core that all environment classes share, and its infos."""

import operator
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from flockenv import _core
from flockenv._io.arguments import as_int, listed, real_numbers
from flockenv.envs.options import TERMS, EnvOptions
from flockenv.envs.reset_options import UPCOMING_OPTIONS
from flockenv.envs.seeds import Seed
from flockenv.envs.spaces import flock_feature_space, state_space
from flockenv.errors import ParameterError, refuse_unknown, short_repr
from flockenv.flock import Flock
from flockenv.parameters import FlockParameters

# NumPy adds fewer numbers than this one after another, but from this many on in another order.
_UNROLLED_FROM = 8
# The largest number of flocks or leaders: more would fill the memory.
_LARGEST_COUNT = 100_000


class LeaderBatch:
    """A batch of flocks with their episodes in the core. Rows are leaders, flock after flock.

    Parameters
    ----------
    options
        Options of all flocks.
    leaders
        Number of leaders of each flock; it replaces the one in `options`.
    autoreset_mode
        ``"next_step"``, ``"same_step"`` or ``"disabled"``.
    """

    def __init__(self, options: EnvOptions, leaders: Sequence[int], autoreset_mode: str) -> None:
        parameters_of = {k: options.parameters.replace(n_leaders=k) for k in set(leaders)}
        flocks = [parameters_of[k] for k in leaders]
        self.core = _core.EnvBatch(flocks, {**options.settings, "autoreset_mode": autoreset_mode})
        self.settings: dict[str, Any] = self.core.options
        self.num_flocks = len(flocks)
        self.leaders = tuple(leaders)
        self._user_reward = options.own_reward
        self._flock_of_row = np.repeat(np.arange(self.num_flocks), self.leaders)
        self.state_space = state_space(options.parameters.n_boats)
        self.flock_feature_space = flock_feature_space()
        #: Numbers in an observation; control steps in an episode, and in a decision.
        self.observation_size, self.episode_steps, self.period_steps = self.core.sizes
        self.decisions_hz: float = self.settings["control_hz"] / self.period_steps
        #: Decisions of an episode, rounded up: the last one may be shorter than the others.
        self.decisions = -(-self.episode_steps // self.period_steps)

    def reset(
        self,
        seeds: Sequence[int | None],
        requests: Sequence[Mapping[str, Any]],
        new_seed: Callable[[], int],
        mask: NDArray[np.bool_] | None = None,
    ) -> None:
        """Start episodes of all flocks, or of those in a mask, with the options in `requests`.

        `requests` come from `reset_requests`. `new_seed` returns a seed for a flock that has none.
        """
        is_reset = np.ones(self.num_flocks, np.bool_) if mask is None else mask
        seeded_requests: list[dict[str, Any] | None] = [None] * self.num_flocks
        for flock in np.flatnonzero(is_reset).tolist():
            seed = seeds[flock]
            if seed is None and not self.core.is_seeded(flock):
                seed = new_seed()
            seeded_requests[flock] = {**requests[flock], "seed": seed}
        self.core.reset(seeded_requests)

    def set_upcoming(self, flocks: Sequence[int], options: Mapping[str, Any]) -> None:
        """Set the target or the bw_s of all future episodes of these flocks."""
        refuse_unknown(options, UPCOMING_OPTIONS, "option of the next episodes")
        values: dict[str, object] = {}
        for name, option in options.items():
            value = listed(option)
            values[name] = tuple(value) if isinstance(value, list) else value
        self.core.set_upcoming(list(flocks), values)

    def step(
        self, env: object, actions: ArrayLike, precision: DTypeLike = np.float64
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_]]:
        """Take a decision; return observations and rewards by row, and whether each episode ended.

        A user's reward function is called with `env`. If it returns anything but rewards that are
        finite in `precision`, an error is raised after the flocks have moved.
        """
        if self._user_reward is None:
            return self.core.step(actions)
        # In these flocks the step only starts the next episode, for which there is no reward.
        only_starts = ~np.array(self.running())
        observations, _, truncated = self.core.step(actions)
        rewards = self._checked_rewards(self._user_reward(env), precision)
        rewards[only_starts[self._flock_of_row]] = 0.0
        self.core.add_rewards(rewards)
        return observations, rewards, truncated

    def running(self) -> list[bool]:
        """Return which flocks have an episode under way."""
        return [self.core.is_running(flock) for flock in range(self.num_flocks)]

    def _checked_rewards(self, returned: object, precision: DTypeLike) -> NDArray[np.float64]:
        """Return the rewards of a user's function by row; refuse all but finite numbers."""
        rows = len(self._flock_of_row)
        if np.ma.is_masked(returned):
            raise ParameterError("the reward function returned masked numbers: return plain ones")
        rewards = real_numbers(returned, "what the reward function returned").astype(np.float64)
        if rewards.shape == (self.num_flocks,):
            rewards = np.repeat(rewards, self.leaders)
        with np.errstate(over="ignore"):
            is_finite = np.isfinite(rewards.astype(precision)).all()
        if rewards.size != rows or not is_finite:
            raise ParameterError(
                f"the reward function returned shape {rewards.shape}, expected numbers that are "
                f"finite in {np.dtype(precision)}, one for each of {self.num_flocks} flocks or "
                f"{rows} leaders"
            )
        return np.asarray(rewards).ravel()

    def flock(self, flock: int) -> Flock:
        """Return a copy of a flock in its present state."""
        return Flock._from_core(self.core.flock(flock))

    def parameters(self, flock: int) -> FlockParameters:
        """Return the parameters of a flock's environment."""
        return FlockParameters._from_core(self.core.parameters(flock))

    def reset_info(self, flock: int) -> dict[str, Any]:
        """Return the info at the start of a flock's episode."""
        episode = self.core.episode(flock)
        seed = Seed(episode["flock_seed"])
        return {"target": episode["target"], "bw_s": episode["bw_s"], "flock_seed": seed}

    def end_info(self, flock: int) -> dict[str, Any]:
        """Return the info at the end of a flock's episode; empty before an end."""
        summary = self.core.finished(flock)
        if summary is None:
            return {}
        return {"episode_summary": {**summary, "flock_seed": Seed(summary["flock_seed"])}}

    def reward_terms(self) -> dict[str, NDArray[np.float64]]:
        """Return each term of the last step's reward, one number per row."""
        return dict(zip(TERMS, self.core.reward_terms().T, strict=True))


def mean_rows(rows: list[list[float]]) -> list[float]:
    """Return the mean of each column, with the bits of NumPy's mean, in a tenth of its time."""
    if len(rows) >= _UNROLLED_FROM:
        return [float(column.mean()) for column in np.array(rows).T]
    sums, count = [0.0] * len(rows[0]), len(rows)
    for row in rows:
        sums = list(map(operator.add, sums, row))
    return [total / count for total in sums]


_FLOATS = (np.dtype(np.float64), np.dtype(np.float32))


def is_plain(action: object, shape: tuple[int, ...]) -> bool:
    """Return whether an action is a float array of this shape, so that it needs no other check."""
    return type(action) is np.ndarray and action.dtype in _FLOATS and action.shape == shape


def at_least_one(count: object, name: str) -> int:
    """Return a number of flocks or leaders as an int; `name` is the argument's, for errors."""
    number = as_int(count, name)
    if not 1 <= number <= _LARGEST_COUNT:
        raise ParameterError(
            f"{name} = {short_repr(number)} is not accepted: 1 to {_LARGEST_COUNT}"
        )
    return number
