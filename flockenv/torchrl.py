"""TorchRL's environment for a batch of flocks, in which all leaders are one group of agents.

Needs the extra ``torchrl``.
"""

from typing import Any, ClassVar

from flockenv._io.extras import require

require("torchrl", "torchrl")

# ruff: noqa: E402 - after the check above
import gymnasium
import numpy as np
import torch
from numpy.typing import NDArray
from tensordict import TensorDict, TensorDictBase
from torchrl.data import Binary, Bounded, Categorical, Composite, Unbounded
from torchrl.envs import EnvBase

from flockenv import _core
from flockenv._io.arguments import as_int
from flockenv.envs.base import OwnFlocks
from flockenv.envs.batch import LeaderBatch, at_least_one
from flockenv.envs.observation import state_entries
from flockenv.envs.options import EnvOptions
from flockenv.envs.reset_options import reset_requests
from flockenv.envs.seeds import OwnGenerator, drawn_seed, seeds_from
from flockenv.envs.spaces import ObservationSpace
from flockenv.errors import UnknownOptionError, refuse_unknown

GROUP = "leaders"
"""Name of the group of agents that holds all leaders of a flock."""

STATES = ("boats", "set", "features", "none")
"""Accepted values of the option `state`."""


class LeadersEnv(OwnGenerator, OwnFlocks, EnvBase):
    """Many flocks for TorchRL, stepped in parallel in Rust: the batch size is ``[flocks]``.

    All flocks have equally many leaders, which are one group of agents. On the processor, tensors
    share the memory of the arrays that the core returns. They are never written to again.

    ========================================= =============================================
    key                                       shape, dtype
    ========================================= =============================================
    ``("leaders", "observation")``            (flocks, leaders, observation size), float32
    ``("leaders", "action")``                 (flocks, leaders, 1), float32: rudders; with
                                              `rudder_levels` (flocks, leaders), int64
    ``("next", "leaders", "reward")``         (flocks, leaders, 1), float32
    ``"state"``                               (flocks, state size), float32; with `state` "set"
                                              (flocks, boats, entries)
    ``"done"``, ``"terminated"``,             (flocks, 1), bool; episodes are truncated, never
    ``"truncated"``                           terminated
    ========================================= =============================================

    The same seed gives the same bits as in `LeadersVectorEnv`. ``set_seed(s)`` makes the next reset
    seed flock i with s + i. Flocks that never had a seed draw one from `np_random`. ``reset`` with
    a ``"_reset"`` mask starts the flocks in it, and ``reset(options={...})`` takes the options of
    `LeadersVectorEnv.reset`.

    Parameters
    ----------
    num_flocks
        Number of flocks, at least 1.
    state
        The observation of a centralized critic. "boats": the global state, the boats one after
        another. "set": the same with a row for each boat, which holds the boat's own entries and
        then the clock's, for networks that take sets. "features": features of the flock that do not
        depend on the order of boats, as `LeadersVectorEnv.flock_features`. "none": no state.
    device
        The device of the tensors; the simulator itself runs on the processor.
    options
        The environments' options.

    Attributes
    ----------
    group_map : dict
        The names of the agents by group; the only group is ``"leaders"``.
    observation_space : flockenv.envs.spaces.ObservationSpace
        The space of one leader's observation, which `NetworkPolicy.from_module` takes.
    episode_steps : int
        Decisions of an episode.
    rudder_levels : int or None
        The environments' option of that name.

    Raises
    ------
    ParameterError
        For values out of range, and flocks with different numbers of leaders.
    UnknownOptionError
        For unknown options, with the nearest known one.
    """

    _read_only_attributes: ClassVar[tuple[str, ...]] = (
        "parameters",
        "num_flocks",
        "num_leaders",
        "rudder_levels",
    )

    def __init__(
        self,
        num_flocks: int = 1,
        *,
        state: str = "boats",
        device: torch.device | str = "cpu",
        **options: object,
    ) -> None:
        flocks = at_least_one(num_flocks, "num_flocks")
        refuse_unknown((state,), STATES, "state")
        parsed = EnvOptions.parse(options, flocks_argument="num_flocks")
        self.parameters = parsed.parameters
        self.num_flocks, self.num_leaders = flocks, parsed.parameters.n_leaders
        at_least_one(self.num_leaders, "n_leaders")
        super().__init__(device=device, batch_size=torch.Size([flocks]))
        self._batch = LeaderBatch(parsed, [self.num_leaders] * flocks, "disabled")
        settings = self._batch.settings
        self.observation_space = ObservationSpace(settings)
        self.episode_steps = self._batch.decisions
        self.group_map = {GROUP: [f"leader_{leader}" for leader in range(self.num_leaders)]}
        self.rudder_levels: int | None = settings["rudder_levels"]
        self._state = state
        self._seeds: list[int | None] = [None] * flocks
        self._make_specs()

    def _make_specs(self) -> None:
        """Set the specs by which TorchRL knows shapes, types and bounds of all entries."""
        flocks, device = self.batch_size, self.device
        per_leader = torch.Size([*flocks, self.num_leaders])

        def bounded(space: gymnasium.spaces.Box, *shape: int) -> Bounded:
            low, high = (torch.from_numpy(bound) for bound in (space.low, space.high))
            size = torch.Size([*shape, *space.shape])
            return Bounded(low.expand(size), high.expand(size), size, device, torch.float32)

        def grouped(**entries: object) -> Composite:
            return Composite({GROUP: Composite(entries, shape=per_leader)}, shape=flocks)

        self.observation_spec = grouped(observation=bounded(self.observation_space, *per_leader))
        if self._state != "none":
            self.observation_spec["state"] = bounded(self._state_space(), *flocks)
        if self.rudder_levels is None:
            action = Bounded(-1.0, 1.0, torch.Size([*per_leader, 1]), device, torch.float32)
        else:
            action = Categorical(self.rudder_levels, per_leader, device, torch.int64)
        self.action_spec = grouped(action=action)
        self.reward_spec = grouped(
            reward=Unbounded(torch.Size([*per_leader, 1]), device, torch.float32)
        )
        per_flock = torch.Size([*flocks, 1])
        self.done_spec = Composite(
            {
                name: Binary(shape=per_flock, device=device, dtype=torch.bool)
                for name in ("done", "terminated", "truncated")
            },
            shape=flocks,
        )

    def set_next_episodes(self, **options: object) -> None:
        """Set ``bw_s`` or ``target`` for the next episodes, as `LeadersVectorEnv` does."""
        self._batch.set_upcoming(range(self.num_flocks), options)

    def set_seed(self, seed: int | None = None, static_seed: bool = False) -> int | None:
        """Seed the flocks at the next reset: flock i with ``seed + i``; return TorchRL's next seed.

        Raises ParameterError for anything but a seed.
        """
        checked = None if seed is None else as_int(seed, "seed")
        next_seed: int | None = super().set_seed(checked, static_seed)
        return next_seed

    def _set_seed(self, seed: int | None) -> None:
        flocks = self.num_flocks
        self._seeds = [None] * flocks if seed is None else list(seeds_from(seed, flocks))

    def _reset(
        self,
        tensordict: TensorDictBase | None = None,
        *,
        options: dict[str, Any] | None = None,
        set_state: bool | None = None,
        **others: object,
    ) -> TensorDictBase:
        if others:
            name = next(iter(others))
            raise UnknownOptionError(
                f"reset got an unexpected keyword argument {name!r}: options of a reset are given "
                f"as options={{...}}, the seed by set_seed"
            )
        flocks = self.num_flocks
        reset_tensor = None if tensordict is None else tensordict.get("_reset", None)
        mask = None if reset_tensor is None else reset_tensor.reshape(flocks).cpu().numpy()
        requests = reset_requests(options, flocks)
        self._batch.reset(self._seeds, requests, lambda: drawn_seed(self.np_random), mask)
        was_reset = np.ones(flocks, np.bool_) if mask is None else mask
        for flock in np.flatnonzero(was_reset).tolist():
            self._seeds[flock] = None
        return self._tensordict(self._batch.core.observe())

    def _step(self, tensordict: TensorDictBase) -> TensorDictBase:
        actions = tensordict[GROUP, "action"].detach().cpu().numpy()
        shape = (self.num_flocks, self.num_leaders)
        expected = shape if self.rudder_levels is not None else (*shape, 1)
        flat = _core.flat_actions(actions, expected, self.rudder_levels, "the leaders' action")
        observations, rewards, ended = self._batch.step(self, flat)
        result = self._tensordict(observations)
        reward = self._tensor(rewards.astype(np.float32)).reshape(*shape, 1)
        result.set((GROUP, "reward"), reward)
        truncated = self._tensor(ended).unsqueeze(-1)
        result.set("truncated", truncated)
        result.set("done", truncated.clone())
        result.set("terminated", torch.zeros_like(truncated))
        return result

    def _tensordict(self, observations: NDArray[np.float32]) -> TensorDict:
        """Return the leaders' observations, a row per leader, and the present state."""
        shape = [self.num_flocks, self.num_leaders]
        observation = self._tensor(observations).reshape(*shape, -1)
        leaders = TensorDict({"observation": observation}, shape, device=self.device)
        entries: dict[str, Any] = {GROUP: leaders}
        if self._state != "none":
            entries["state"] = self._tensor(self._present_state())
        return TensorDict(entries, self.batch_size, device=self.device)

    def _state_space(self) -> gymnasium.spaces.Box:
        """Return the space of one flock's entry ``state``."""
        if self._state == "features":
            return self._batch.flock_feature_space
        space = self._batch.state_space
        if self._state != "set":
            return space
        boats = self.parameters.n_boats
        low, high = (_boat_rows(bound[None], boats)[0] for bound in (space.low, space.high))
        return gymnasium.spaces.Box(low, high, dtype=np.float32)

    def _present_state(self) -> NDArray[np.float32]:
        """Return the entry ``state`` of all flocks."""
        if self._state == "features":
            return self._batch.core.flock_features(each_leader=False)
        states = self._batch.core.states()
        return _boat_rows(states, self.parameters.n_boats) if self._state == "set" else states

    def _tensor(self, array: NDArray[Any]) -> torch.Tensor:
        return torch.from_numpy(array).to(self.device)


def _boat_rows(states: NDArray[np.float32], boats: int) -> NDArray[np.float32]:
    """Return states with a row per boat: the boat's own entries, then those of the clock.

    `states` has shape (flocks, state size), and the result (flocks, boats, entries).
    """
    n_clock = len(state_entries(0))  # A state of no boats holds the entries of the clock only.
    boat_entries = states[:, :-n_clock].reshape(len(states), boats, -1)
    clock = np.broadcast_to(states[:, None, -n_clock:], (len(states), boats, n_clock))
    return np.concatenate([boat_entries, clock], axis=2)
