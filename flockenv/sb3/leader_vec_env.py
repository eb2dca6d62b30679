"""`LeaderVecEnv`: stable-baselines3's vector interface, one slot per leader."""

import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import NDArray
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvIndices

from flockenv import _core
from flockenv._io.arguments import as_int, items, materialized
from flockenv.envs.base import ManyFlocks
from flockenv.envs.batch import LeaderBatch, at_least_one
from flockenv.envs.options import EnvOptions
from flockenv.envs.registration import registered
from flockenv.envs.render_mode import RenderMode
from flockenv.envs.reset_options import UPCOMING_OPTIONS, reset_requests
from flockenv.envs.seeds import OwnGenerator, drawn_seed, seeds_from
from flockenv.envs.spaces import ObservationSpace, leader_action_space
from flockenv.errors import EpisodeError, ParameterError, short_repr
from flockenv.rendering.frames import DEFAULT_SIZE
from flockenv.sb3.leader_slot import LeaderSlot


class LeaderVecEnv(OwnGenerator, ManyFlocks, VecEnv):
    """Many flocks for stable-baselines3, a slot per leader: one policy is shared by all leaders.

    ``flockenv.sb3.LeaderVecEnv(num_flocks=64, n_leaders=[1, 2, 3, 4], **options)``

    `LeadersEnv` specifies the task, the entries of an observation, the terms of the reward and the
    options. This text describes the differences.

    ## Description
    There is a slot for each leader, flock after flock. Flocks are stepped in parallel in Rust;
    results depend neither on `num_flocks` nor on the number of threads. Arrays that are returned
    are never written to again.

    **A leader is not an episode.** stable-baselines3's `evaluate_policy`, `EvalCallback` and
    `VecMonitor` count each slot, so that three leaders make three episodes with the same order.
    Counts are then three times too large, and deviations and intervals are too small. Use
    `evaluate_flocks`, `FlockEvalCallback` and, for a monitor file, `FlockMonitor` of `flockenv.sb3`
    instead. No `VecMonitor` is needed for SB3's logs: at the end of an episode the info of a
    flock's first slot has the ``"episode"``, whose return is the mean over the flock's leaders.

    ## Action space
    The space of a slot is `Box(-1, 1, (1,), float32)`, its leader's rudder, or `Discrete(n)` with
    `rudder_levels=n`.

    ## Observation space
    The space of a slot is a `Box` of shape (observation size,), float32. `state()` returns for each
    slot the global state of its flock. `flock_features()` returns the features of its flock, in the
    frame of the slot's target.

    ## Rewards
    Each slot gets the weighted sum of its terms. Terms of a single leader go to its slot only.
    `reward_terms()` returns the terms of the last step.

    `reward` may also be a function that takes this environment. It is called after the flocks have
    moved, and before those whose episodes ended start again. It returns rewards (slots,), or
    (flocks,) for all leaders of a flock. It may call `poses()`, `velocities()`,
    `order_parameters()`, `reward_terms()` and the like.

    ## Starting state
    `seed(s)` makes the next reset seed flock i with s + i, and `set_options` sets the options of
    the next reset: a dictionary, or a list with a dictionary for each slot, equal for all leaders
    of a flock. `learn` calls `reset` only at its start. For a curriculum, `set_attr("bw_s", 0.6)`
    and `set_attr("target", "random")` hold for all episodes that start afterwards.

    ## Episode end
    A flock's slots end together and start the next episode in the same step. Their infos then have
    `"TimeLimit.truncated"` (always True), `"terminal_observation"`, `"terminal_state"`,
    `"terminal_flock_features"` and the `"episode_summary"`.

    ## Arguments
    `num_flocks`: number of flocks; `n_leaders`: leaders of each flock (a list is dealt out to the
    flocks in turn, so that one policy can learn all of them); and the arguments of `LeadersEnv`.

    ## Version history
    - v0: as `LeadersEnv`.
    """

    _read_only_attributes: ClassVar[tuple[str, ...]] = (
        "num_envs",
        "num_flocks",
        "render_mode",
        "action_mode",
    )
    _next_episode: ClassVar[str] = "set_attr or set_options"

    def __init__(
        self,
        num_flocks: int = 1,
        *,
        n_leaders: int | Sequence[int] | None = None,
        render_mode: str | None = None,
        render_size: tuple[int, int] = DEFAULT_SIZE,
        **options: object,
    ) -> None:
        num_flocks = at_least_one(num_flocks, "num_flocks")
        dealt = None if n_leaders is None else _leader_counts(n_leaders)
        options = {**options, "n_leaders": max(dealt)} if dealt else options
        parsed = EnvOptions.parse(options, takes_function=True, flocks_argument="num_flocks")
        dealt = dealt or [parsed.parameters.n_leaders]
        leader_counts = [dealt[flock % len(dealt)] for flock in range(num_flocks)]
        # The core does not reset flocks: `step_wait` does, once their rewards are known.
        self._batch = LeaderBatch(parsed, leader_counts, "disabled")
        self._own_reward = parsed.own_reward
        settings = self._batch.settings
        self.num_flocks = num_flocks
        self.render_mode = render_mode
        fps = self._batch.decisions_hz  # There is a frame for each decision.
        self._render_mode = RenderMode(render_mode, render_size, fps, ("rgb_array",))
        self.observation_space: ObservationSpace = ObservationSpace(settings)
        self.action_space = leader_action_space(settings["rudder_levels"])
        self.state_space = self._batch.state_space
        self.flock_feature_space = self._batch.flock_feature_space
        #: Meaning of actions.
        self.action_mode: str = settings["action_mode"]
        #: Decisions per second.
        self.decisions_hz = fps
        self.slots = self._make_slots(leader_counts)
        #: Flock of each slot.
        self.flock_of_slot = np.repeat(np.arange(num_flocks), leader_counts)
        self._actions: NDArray[np.float64] | None = None
        super().__init__(len(self.slots), self.observation_space, self.action_space)
        self.metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": fps}
        self._actions_shape = (self.num_envs, *(self.action_space.shape or ()))

    def _make_slots(self, leader_counts: Sequence[int]) -> list[LeaderSlot]:
        spaces = self.observation_space, self.action_space
        return [
            LeaderSlot(self, flock, leader, *spaces, self.render_mode)
            for flock, k in enumerate(leader_counts)
            for leader in range(k)
        ]

    @cached_property
    def spec(self) -> EnvSpec | None:
        """The registered environment that has the same options; None if there is none."""
        own_options = (self._batch.parameters(0), self._batch.settings, self._own_reward)

        def has_same_options(options: Mapping[str, Any]) -> bool:
            parsed = EnvOptions.parse(options, takes_function=True)
            n_leaders = parsed.parameters.n_leaders
            if {*self._batch.leaders} != {n_leaders}:
                return False
            batch = LeaderBatch(parsed, [n_leaders], "disabled")
            return _equal((batch.parameters(0), batch.settings, parsed.own_reward), own_options)

        return registered(has_same_options)

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Seed the flocks at the next reset: flock i with ``seed + i``; None draws one."""
        first = drawn_seed(self.np_random) if seed is None else seed
        seeds = seeds_from(first, self.num_flocks)
        self._seed_generator(seeds[0])
        self._seeds = [seeds[flock] for flock in self.flock_of_slot]
        return self._seeds

    def reset(self) -> NDArray[np.float32]:
        """Start episodes in all flocks, with the seeds and options set for this reset.

        Returns
        -------
        numpy.ndarray
            Shape (slots, observation size), float32.

        Raises
        ------
        ParameterError
            For options whose values are not accepted; the next reset does not use them.
        """
        requests = self._requests(self._options)
        first_slots = np.searchsorted(self.flock_of_slot, np.arange(self.num_flocks))
        seeds = [self._seeds[slot] for slot in first_slots.tolist()]
        # Options are dropped before the batch may refuse them, so that the next reset lacks them.
        self._reset_options()
        self._batch.reset(seeds, requests, self._drawn_seed)
        self._reset_seeds()
        flock_infos = [self._batch.reset_info(flock) for flock in range(self.num_flocks)]
        self.reset_infos = [dict(flock_infos[flock]) for flock in self.flock_of_slot]
        return self._batch.core.observe()

    def set_options(self, options: object = None) -> None:
        """Set the options of the next reset: a dictionary, or a list of one for each slot.

        Raises
        ------
        ParameterError
            For unknown options, and for options that differ between the leaders of a flock.
            Options that were set before are dropped, too.
        TypeError
            For options that are not dictionaries.
        """
        self._reset_options()
        values = materialized({} if options is None else options)
        by_slot: Any = [values] * self.num_envs if isinstance(values, Mapping) else values
        self._requests(by_slot)  # Only for its errors.
        super().set_options(list(by_slot))

    def _drawn_seed(self) -> int:
        return drawn_seed(self.np_random)

    def _requests(self, options: object) -> list[dict[str, Any]]:
        """Return the request for each flock's reset, from one dictionary per slot."""
        if (
            not isinstance(options, Sequence)
            or len(options) != self.num_envs
            or not all(isinstance(request, Mapping) for request in options)
        ):
            raise TypeError("set_options: a dictionary, or a list of one for each slot")
        by_flock: list[dict[str, Any] | None] = [None] * self.num_flocks
        for flock, slot_options in zip(self.flock_of_slot.tolist(), options, strict=True):
            (request,) = reset_requests(slot_options, 1, lists_flocks=False)
            if by_flock[flock] is None:
                by_flock[flock] = request
            elif not _equal(by_flock[flock], request):
                raise ParameterError(
                    f"set_options: the leaders of flock {flock} have different options"
                )
        return [request for request in by_flock if request is not None]

    def step_async(self, actions: NDArray[Any]) -> None:
        """Store actions for the step: rudders, shape (slots, 1), or levels, shape (slots,)."""
        levels = self._batch.settings["rudder_levels"]
        self._actions = _core.flat_actions(actions, self._actions_shape, levels, "actions")

    def step_wait(
        self,
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Take the decision's control steps.

        Returns
        -------
        observations, rewards, dones, infos
            Shapes (slots, observation size), (slots,), (slots,), and one dictionary per slot. If an
            episode has ended, the observation is the first of the next one.

        Raises
        ------
        ParameterError
            For NaN actions, before anything moves.
        EpisodeError
            Before the first reset.
        """
        if self._actions is None:
            raise EpisodeError("step_wait was called without step_async")
        actions, self._actions = self._actions, None
        try:
            observations, rewards, truncated = self._batch.step(self, actions, np.float32)
        except Exception:
            # Even after an error in the motion or in the reward, ended episodes start again. Flocks
            # that were never reset have had no episode, and no seed.
            running = enumerate(self._batch.running())
            seeded = self._batch.core.is_seeded
            self._start_next(np.array([not runs and seeded(flock) for flock, runs in running]))
            raise
        infos: list[dict[str, Any]] = [{} for _ in self.slots]
        if truncated.any():
            self._report_ends(truncated, observations, infos)
            self._start_next(truncated)
            observations = self._batch.core.observe()
        return observations, rewards.astype(np.float32), truncated[self.flock_of_slot], infos

    def _start_next(self, ended: NDArray[np.bool_]) -> None:
        """Start the next episodes of the flocks whose episodes ended."""
        if not ended.any():
            return
        unseeded: list[int | None] = [None] * self.num_flocks
        no_options: list[dict[str, Any]] = [{}] * self.num_flocks
        self._batch.reset(unseeded, no_options, self._drawn_seed, ended)
        for slot in np.flatnonzero(ended[self.flock_of_slot]).tolist():
            self.reset_infos[slot] = self._batch.reset_info(int(self.flock_of_slot[slot]))

    def _report_ends(
        self,
        truncated: NDArray[np.bool_],
        last_observations: NDArray[np.float32],
        infos: list[dict[str, Any]],
    ) -> None:
        """Fill the infos of slots whose episodes ended."""
        states, features = self._batch.core.states(), self.flock_features()
        for slot in np.flatnonzero(truncated[self.flock_of_slot]).tolist():
            flock, leader = int(self.flock_of_slot[slot]), self.slots[slot].leader_index
            infos[slot] = {
                **self._batch.end_info(flock),
                "TimeLimit.truncated": True,
                "terminal_observation": last_observations[slot],
                "terminal_state": states[flock],
                "terminal_flock_features": features[slot],
            }
            summary = infos[slot]["episode_summary"]
            if leader == 0:
                # As in the infos of `Monitor`, but without the wall-clock time, on which results
                # must not depend.
                decisions = math.ceil(summary["steps"] / self._batch.period_steps)
                infos[slot]["episode"] = {"r": summary["total_reward"], "l": decisions}

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Return an attribute of each slot's `LeaderSlot`."""
        return [getattr(self.slots[slot], attr_name) for slot in self._chosen(indices)]

    def _chosen(self, indices: VecEnvIndices) -> list[int]:
        """Return the slots that indices name; raise an error for other values."""
        chosen = [
            as_int(index, "indices") for index in items(self._get_indices(indices), "indices")
        ]
        if any(not -self.num_envs <= slot < self.num_envs for slot in chosen):
            raise IndexError(
                f"indices = {short_repr(indices)} are not accepted: slots 0 to {self.num_envs - 1}"
            )
        return chosen

    def set_attr(self, attr_name: str, value: object, indices: VecEnvIndices = None) -> None:
        """Set ``bw_s`` or ``target`` of the slots' flocks for the next episodes.

        The values hold until they are set again, also within `learn`. They are as for `reset`: from
        a range (low, high) each episode draws its bw_s, and a list has a target for each leader.

        Raises
        ------
        AttributeError
            For any other name.
        ParameterError
            For a value that is not accepted, and for only some of a flock's slots.
        """
        if attr_name not in UPCOMING_OPTIONS:
            names = " and ".join(UPCOMING_OPTIONS)
            raise AttributeError(
                f"{attr_name!r} cannot be set: set_attr takes {names}, for the next "
                "episodes; set_options takes all options of a reset"
            )
        chosen = np.zeros(self.num_envs, np.bool_)
        chosen[self._chosen(indices)] = True
        flocks = np.unique(self.flock_of_slot[chosen]).tolist()
        for flock in flocks:
            if not chosen[self.flock_of_slot == flock].all():
                raise ParameterError(
                    f"set_attr: {attr_name} is the same for all leaders of flock {flock}, but "
                    "indices name only some of them"
                )
        self._batch.set_upcoming(flocks, {attr_name: value})

    def env_method(
        self,
        method_name: str,
        *method_args: object,
        indices: VecEnvIndices = None,
        **method_kwargs: object,
    ) -> list[Any]:
        """Call a method of each slot's `LeaderSlot`."""
        methods = self.get_attr(method_name, indices)
        return [method(*method_args, **method_kwargs) for method in methods]

    def env_is_wrapped(self, wrapper_class: type[Any], indices: VecEnvIndices = None) -> list[bool]:
        """Return False for each slot: there are no wrappers around single slots."""
        return [False for _ in self._chosen(indices)]

    def state(self) -> NDArray[np.float32]:
        """Return the global state of each slot's flock, shape (slots, state size)."""
        return self._batch.core.states()[self.flock_of_slot]

    def flock_features(self) -> NDArray[np.float32]:
        """Return features of each slot's flock, shape (slots, features), float32.

        The features depend neither on the order of boats nor on absolute angles. They are in the
        frame of the slot's own target.
        """
        return self._batch.core.flock_features(each_leader=True)

    def reward_terms(self) -> dict[str, NDArray[np.float64]]:
        """Return each term of the last step's reward, shape (slots,)."""
        return self._batch.reward_terms()

    def set_state(self, state: bytes) -> NDArray[np.float32]:
        """Continue bit for bit from a state of `get_state`; return the observations.

        The environment must have the same options as the one that returned the state.
        """
        super().set_state(state)
        return self._batch.core.observe()

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """Return a frame of each flock, or None for each slot if `render_mode` is None."""
        if self.render_mode is None:
            return [None for _ in self.slots]
        flocks = map(self._batch.flock, range(self.num_flocks))
        return [self._render_mode.frame(flock) for flock in flocks]

    def close(self) -> None:
        """Do nothing: there is nothing to close."""


def _equal(left: object, right: object) -> bool:
    """Return whether nested containers are equal, arrays and NaN included."""
    try:
        np.testing.assert_equal(left, right)
    except AssertionError:
        return False
    return True


def _leader_counts(n_leaders: object) -> list[int]:
    """Return the numbers of leaders that are dealt out to the flocks in turn."""
    counts = n_leaders.tolist() if isinstance(n_leaders, np.ndarray) else materialized(n_leaders)
    if not isinstance(counts, Sequence) or isinstance(counts, str):
        counts = [counts]
    if not counts:
        raise ParameterError("n_leaders = [] is not accepted: a number or a list of numbers")
    return [at_least_one(count, "n_leaders") for count in counts]
