"""`LeadersVectorEnv`: many flocks behind Gymnasium's vector interface, stepped at once in Rust."""

from collections.abc import Sequence
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from flockenv import _core
from flockenv.envs.base import ManyFlocks, SpecOfEpisodes
from flockenv.envs.batch import LeaderBatch, at_least_one
from flockenv.envs.options import EnvOptions
from flockenv.envs.render_mode import RenderMode
from flockenv.envs.reset_options import RESET_OPTIONS, reset_requests
from flockenv.envs.seeds import drawn_seed, seeds_of_flocks
from flockenv.envs.spaces import ObservationSpace, joint_action_space
from flockenv.errors import EpisodeError, ParameterError, short_repr
from flockenv.rendering.frames import DEFAULT_SIZE


class LeadersVectorEnv(
    SpecOfEpisodes,
    ManyFlocks,
    gymnasium.vector.VectorEnv[NDArray[np.float32], NDArray[Any], NDArray[Any]],
):
    """Lead many flocks at once, one policy steering all leaders of a flock.

    ``gymnasium.make_vec("flockenv/Leaders-v0", num_envs=64, **options)``

    `LeadersEnv` specifies the task, the entries of an observation, the terms of the reward and the
    options; this text says what differs.

    ## Description
    Flocks are stepped in parallel in Rust; results depend neither on `num_envs` nor on the number
    of threads. Arrays that are returned are never written to again.

    ## Action space
    As `LeadersEnv`, for each flock.

    ## Observation space
    As `LeadersEnv`, for each flock; `state()` and `flock_features()` have a row for each.

    ## Rewards
    The weighted sum of the terms, mean over a flock's leaders. `reward_terms()` returns the terms
    of the last step, `leader_rewards()` each leader's own reward: with opposite targets the mean
    says little.

    `reward` may also be a function of this environment. `step` calls it after the flocks have
    moved, and it returns rewards (num_envs,), or (num_envs, k) for each leader. It can call
    `poses()`, `velocities()`, `order_parameters()`, `reward_terms()` and other methods. A function
    is refused with `autoreset_mode="same_step"`, because flocks whose episodes end have started
    again before it is called.

    ## Starting state
    `seed=s` seeds flock i with s + i; a list gives each flock its own. If an option of `reset` is a
    list, it has one entry per flock; a tuple of targets has one per leader.
    `reset(options={"reset_mask": mask})` resets some flocks.

    ## Episode end
    At the end `infos["episode_summary"]` has means over the episode. With
    `autoreset_mode="next_step"` the next step starts the next episode and ignores its action. With
    `"same_step"` the same step starts it, and `infos["final_obs"]` and `infos["final_info"]` are
    those of the episode that ended. With `"disabled"` flocks wait for a reset with a mask, as
    TorchRL's `GymWrapper` needs.

    ## Arguments
    `num_envs`: number of flocks; `autoreset_mode`: one of Gymnasium's `AutoresetMode` or its name;
    and the arguments of `LeadersEnv`.

    ## Version history
    - v0: as `LeadersEnv`.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - Gymnasium's own declaration
        "render_modes": ["rgb_array"],
        "render_fps": 10.0,
    }
    _read_only_attributes: ClassVar[tuple[str, ...]] = (
        "num_envs",
        "num_leaders",
        "autoreset_mode",
        "render_mode",
    )

    def __init__(
        self,
        num_envs: int = 1,
        *,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
        render_size: tuple[int, int] = DEFAULT_SIZE,
        **options: object,
    ) -> None:
        self.autoreset_mode = _autoreset_mode(autoreset_mode)
        num_envs = at_least_one(num_envs, "num_envs")
        parsed = EnvOptions.parse(options, takes_function=True, flocks_argument="num_envs")
        if parsed.own_reward is not None and self.autoreset_mode == AutoresetMode.SAME_STEP:
            raise ParameterError(
                "reward = a function is not accepted with autoreset_mode 'same_step': "
                "'next_step' or 'disabled'"
            )
        self.num_envs = num_envs
        self.num_leaders = parsed.parameters.n_leaders
        self._batch = LeaderBatch(
            parsed, [self.num_leaders] * num_envs, _CORE_NAMES[self.autoreset_mode]
        )
        self.render_mode = render_mode
        fps = self._batch.decisions_hz
        self._render_mode = RenderMode(render_mode, render_size, fps, ("rgb_array",))
        self.metadata = {
            **self.metadata,
            "autoreset_mode": self.autoreset_mode,
            "render_fps": fps,
        }
        self._set_spaces()
        self._rewards: NDArray[np.float64] | None = None

    def _set_spaces(self) -> None:
        settings = self._batch.settings
        self.single_observation_space = ObservationSpace(settings, self.num_leaders)
        self.single_action_space = joint_action_space(settings["rudder_levels"], self.num_leaders)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.single_state_space = self._batch.state_space
        self.flock_feature_space = self._batch.flock_feature_space
        self._actions_shape = (self.num_envs, self.num_leaders)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start episodes in all flocks, or in those of ``options["reset_mask"]``.

        Parameters
        ----------
        seed
            The seed of flock 0, and each further flock has the next number; or a list with a seed
            per flock. None continues with the next episode.
        options
            Those of `LeadersEnv.reset` for the episodes that start; a list has an entry for each
            flock. ``reset_mask`` (num_envs,) bool.

        Returns
        -------
        observations : numpy.ndarray
            Shape (num_envs, k * observation size), float32, of all flocks.
        infos : dict
            Infos of the flocks that were reset, as in `LeadersEnv.reset`.
        """
        seeds = seeds_of_flocks(seed, self.num_envs)
        requests = reset_requests(options, self.num_envs, accepted=(*RESET_OPTIONS, "reset_mask"))
        mask = None if options is None else _checked_mask(options.get("reset_mask"), self.num_envs)
        self._batch.reset(seeds, requests, lambda: drawn_seed(self.np_random), mask)
        if seeds[0] is not None:
            super().reset(seed=seeds[0])
        infos: dict[str, Any] = {}
        for flock in range(self.num_envs) if mask is None else np.flatnonzero(mask).tolist():
            infos = self._add_info(infos, _array_info(self._batch.reset_info(flock)), flock)
        return self._rows_of_flocks(self._batch.core.observe()), infos

    def step(
        self, actions: NDArray[Any]
    ) -> tuple[
        NDArray[np.float32],
        NDArray[np.float64],
        NDArray[np.bool_],
        NDArray[np.bool_],
        dict[str, Any],
    ]:
        """Take one decision in every flock, for one control step or `decision_period_s`.

        Parameters
        ----------
        actions
            Shape (num_envs, k): rudders, clipped to [-1, 1], or numbers of levels.

        Returns
        -------
        observations, rewards, terminations, truncations, infos
            Rewards are means over a flock's leaders; episodes are truncated, never terminated.

        Raises
        ------
        ParameterError
            For NaN and wrong shapes; nothing has moved then. For rewards of a function that have
            another shape or are not finite; the flocks have moved then.
        EpisodeError
            Before the first reset, and after an episode's end with ``"disabled"``.
        """
        flat = _core.flat_actions(
            actions, self._actions_shape, self._batch.settings["rudder_levels"]
        )
        try:
            observations, rewards, truncated = self._batch.step(self, flat)
        except Exception as error:
            ended = [flock for flock, runs in enumerate(self._batch.running()) if not runs]
            if ended and self.autoreset_mode == AutoresetMode.DISABLED:
                error.add_note(f"the episodes of flocks {ended} are over: reset them with a mask")
            raise
        self._rewards = rewards.reshape(self._actions_shape)
        infos = self._end_infos(truncated) if truncated.any() else {}
        return (
            self._rows_of_flocks(observations),
            self._rewards.mean(axis=1),
            np.zeros(self.num_envs, np.bool_),
            truncated,
            infos,
        )

    def _rows_of_flocks(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        return rows.reshape(self.num_envs, -1)

    def _end_infos(self, truncated: NDArray[np.bool_]) -> dict[str, Any]:
        """Return the infos of the flocks whose episodes ended."""
        infos: dict[str, Any] = {}
        for flock in np.flatnonzero(truncated).tolist():
            info = _array_info(self._batch.end_info(flock))
            if self.autoreset_mode == AutoresetMode.SAME_STEP:
                final_obs = self._batch.core.final_observation(flock).reshape(-1)
                final = {"final_obs": final_obs, "final_info": info}
                infos = self._add_info(infos, final, flock)
                info = _array_info(self._batch.reset_info(flock))
            infos = self._add_info(infos, info, flock)
        return infos

    def state(self) -> NDArray[np.float32]:
        """Return the global state of every flock, shape (num_envs, state size)."""
        return self._batch.core.states()

    def flock_features(self) -> NDArray[np.float32]:
        """Return features of every flock, shape (num_envs, features), float32.

        They depend neither on the order of boats nor on absolute angles. They are in the frame of
        the target; with several targets, in the frame of leader 0's target.
        """
        return self._batch.core.flock_features(each_leader=False)

    def reward_terms(self) -> dict[str, NDArray[np.float64]]:
        """Return each term of the last step's reward, shape (num_envs,), mean over leaders."""
        terms = self._batch.reward_terms()
        return {
            name: rows.reshape(self._actions_shape).mean(axis=1) for name, rows in terms.items()
        }

    def leader_rewards(self) -> NDArray[np.float64]:
        """Return each leader's own reward of the last step, shape (num_envs, k).

        Raises EpisodeError before the first step.
        """
        if self._rewards is None:
            raise EpisodeError("leader_rewards was called before the first step")
        return self._rewards.copy()

    def in_analysis_window(self) -> NDArray[np.bool_]:
        """Return which flocks are in the paper's analysis window now."""
        return self._batch.core.in_analysis_window().ravel()

    def observe(self) -> NDArray[np.float32]:
        """Return the present observations, shape (num_envs, k * observation size)."""
        return self._rows_of_flocks(self._batch.core.observe())

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Return a frame of each flock, (height, width, 3) uint8; None without a render mode."""
        if self.render_mode is None:
            return None
        flocks = map(self._batch.flock, range(self.num_envs))
        return tuple(map(self._render_mode.frame, flocks))


_CORE_NAMES = {
    AutoresetMode.NEXT_STEP: "next_step",
    AutoresetMode.SAME_STEP: "same_step",
    AutoresetMode.DISABLED: "disabled",
}


def _array_info(info: dict[str, Any]) -> dict[str, Any]:
    """Return an info with seeds as uint64: Gymnasium's arrays of ints end at 2^63."""
    info = {**info}
    if "flock_seed" in info:
        info["flock_seed"] = np.uint64(info["flock_seed"])
    if "episode_summary" in info:
        info["episode_summary"] = _array_info(info["episode_summary"])
    return info


def _autoreset_mode(mode: str | AutoresetMode) -> AutoresetMode:
    """Return a mode that is given by the core's name, Gymnasium's name, or itself."""
    for known, name in _CORE_NAMES.items():
        if mode in (known, name, known.value):
            return known
    names = ", ".join(repr(name) for name in _CORE_NAMES.values())
    raise ParameterError(f"autoreset_mode = {short_repr(mode)} is not accepted: one of {names}")


def _checked_mask(mask: object, num_envs: int) -> NDArray[np.bool_] | None:
    if mask is None:
        return None
    if type(mask) is not np.ndarray or mask.dtype != np.bool_:
        raise TypeError("options['reset_mask'] must be a numpy array of bools")
    if mask.shape != (num_envs,):
        raise ParameterError(
            f"options['reset_mask'] has shape {mask.shape}, expected ({num_envs},)"
        )
    if not mask.any():
        raise ParameterError("options['reset_mask'] is False everywhere: reset at least one flock")
    return mask
