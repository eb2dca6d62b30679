"""`LeadersParallelEnv`: each leader is an agent of PettingZoo's parallel interface."""

import math
from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray
from pettingzoo import AECEnv, ParallelEnv
from pettingzoo.utils import OrderEnforcingWrapper, parallel_to_aec

from flockenv import _core
from flockenv.envs.base import OwnFlocks, SingleEnvironmentBase
from flockenv.envs.batch import is_plain
from flockenv.envs.options import TERMS
from flockenv.envs.render_mode import RENDER_MODES
from flockenv.envs.seeds import OwnGenerator
from flockenv.envs.spaces import ObservationSpace, leader_action_space
from flockenv.errors import EpisodeError, ParameterError
from flockenv.rendering.frames import DEFAULT_SIZE

Observations = dict[str, NDArray[np.float32]]
Infos = dict[str, dict[str, Any]]


class LeadersParallelEnv(
    OwnGenerator,
    SingleEnvironmentBase,
    ParallelEnv[str, NDArray[np.float32], NDArray[np.float32] | int],
):
    """Lead a flock of boats around a ring-shaped pool: each leader is an agent.

    ``flockenv.parallel_env(**options)``

    `LeadersEnv` specifies the task, the entries of an observation, the terms of the reward and the
    options; this text says what differs.

    ## Description
    Agents are `leader_0` to `leader_{k-1}`, boats 0 to k - 1. All act at once and live until the
    time limit; `agents` is empty from then on.

    ## Action space
    Each agent has `Box(-1, 1, (1,), float32)`, its rudder, or `Discrete(n)` with `rudder_levels=n`.

    ## Observation space
    Each agent has a `Box` of shape (observation size,), float32.

    ## Rewards
    Each agent gets the weighted sum of its terms. The terms of a leader alone are those of the
    agent's boat. With several targets, all terms refer to the agent's own target. The infos of each
    step have the agent's `"reward_terms"`, and the last infos also have the `"episode_summary"`.

    ## Version history
    - v0: as `LeadersEnv`.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - PettingZoo's own declaration
        "name": "leaders_v0",
        "render_modes": list(RENDER_MODES),
        "render_fps": 10.0,
        "is_parallelizable": True,
    }

    def __init__(
        self,
        *,
        render_mode: str | None = None,
        render_size: tuple[int, int] = DEFAULT_SIZE,
        **options: object,
    ) -> None:
        self._set_up(options, render_mode, render_size)
        settings = self._batch.settings
        self.possible_agents = [f"leader_{leader}" for leader in range(self.num_leaders)]
        self.agents: list[str] = []
        self.observation_spaces = {
            agent: ObservationSpace(settings) for agent in self.possible_agents
        }
        self.action_spaces = {
            agent: leader_action_space(settings["rudder_levels"]) for agent in self.possible_agents
        }
        self._every_agent = frozenset(self.possible_agents)
        self._levels: int | None = settings["rudder_levels"]

    def observation_space(self, agent: str) -> gymnasium.spaces.Space[NDArray[np.float32]]:
        """Return the observation space of an agent, always the same object."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.spaces.Space[Any]:
        """Return the action space of an agent, always the same object."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, Infos]:
        """Start an episode.

        Parameters
        ----------
        seed
            Fixes everything random in this episode and in the episodes that follow without a seed.
            None continues with the next episode.
        options
            ``target``, ``bw_s``, ``state``, ``snapshot`` and ``noise_seed`` as in
            `LeadersEnv.reset`.

        Returns
        -------
        observations, infos : dict
            By agent; observations have shape (observation size,), float32. Each info has target,
            backward duration and seed of the episode.
        """
        checked_seed = self._reset(seed, options)
        if checked_seed is not None:
            self._seed_generator(checked_seed)
        self.agents = self.possible_agents[:]
        self._show()
        info = self._batch.reset_info(0)
        return self.observe(), {agent: dict(info) for agent in self.agents}

    def step(
        self, actions: Mapping[str, ArrayLike]
    ) -> tuple[Observations, dict[str, float], dict[str, bool], dict[str, bool], Infos]:
        """Take one decision, for one control step or `decision_period_s`.

        Parameters
        ----------
        actions
            One per agent: a rudder of shape (1,), clipped to [-1, 1], or the number of a level.

        Returns
        -------
        observations, rewards, terminations, truncations, infos : dict
            By agent. Each info has the agent's ``"reward_terms"``, and at the end the episode's
            ``"episode_summary"``.

        Raises
        ------
        ParameterError
            For NaN, wrong shapes, missing and unknown agents; nothing has moved then.
        EpisodeError
            Before the first reset and after the end.
        """
        rows, rewards, truncated = self._batch.step(self, self._flat_actions(actions))
        agents, is_over = self.agents, bool(truncated[0])
        infos = self._infos(is_over)
        if is_over:
            self.agents = []
        self._show()
        return (
            dict(zip(agents, rows, strict=True)),
            dict(zip(agents, rewards.tolist(), strict=True)),
            dict.fromkeys(agents, False),
            dict.fromkeys(agents, is_over),
            infos,
        )

    def _flat_actions(self, actions: Mapping[str, ArrayLike]) -> NDArray[np.float64]:
        """Return the rudders of all agents, in their order; refuse any other set of agents."""
        if not self.agents:
            raise EpisodeError("step was called before a reset or after the episode's end")
        if not isinstance(actions, Mapping):
            raise TypeError(f"actions must be a dictionary, not {type(actions).__name__}")
        if actions.keys() != self._every_agent:
            differing = sorted(set(self.agents).symmetric_difference(actions), key=str)
            raise ParameterError(
                f"actions must be for {', '.join(self.agents)}; these differ: {differing}"
            )
        in_order = [actions[agent] for agent in self.agents]
        if self._levels is None and (rudders := _plain_rudders(in_order)):
            return np.array(rudders)
        return np.concatenate([self._rudder(agent, actions[agent]) for agent in self.agents])

    def _rudder(self, agent: str, action: Any) -> NDArray[np.float64]:
        """Return the rudder of one agent's action, shape (1,); refuse NaN and other shapes."""
        shape = (1,) if self._levels is None else ()
        rudder = _core.flat_actions(action, shape, self._levels, f"the action of {agent}")
        if np.isnan(rudder).any():
            raise ParameterError(f"the action of {agent} is NaN, which is not accepted: a number")
        return rudder

    def _infos(self, is_over: bool) -> Infos:
        rows = self._batch.core.reward_terms().tolist()
        infos: Infos = {
            agent: {"reward_terms": dict(zip(TERMS, row, strict=True))}
            for agent, row in zip(self.agents, rows, strict=True)
        }
        if is_over:
            for info in infos.values():
                info.update(self._batch.end_info(0))
        return infos

    def observe(self) -> Observations:
        """Return the present observations, by agent."""
        return dict(zip(self.possible_agents, self._batch.core.observe(), strict=True))

    def set_state(self, state: bytes) -> None:
        """Continue from `get_state` of an environment with the same options, bit for bit."""
        super().set_state(state)
        self.agents = self.possible_agents[:] if self._batch.core.is_running(0) else []


def _plain_rudders(actions: list[Any]) -> list[float] | None:
    """Return the rudders if all actions are float arrays (1,) without NaN; None otherwise."""
    if not all(is_plain(action, (1,)) for action in actions):
        return None
    rudders: list[float] = [action.item() for action in actions]
    return None if any(map(math.isnan, rudders)) else rudders


def parallel_env(*, render_mode: str | None = None, **options: Any) -> LeadersParallelEnv:
    """Return a `LeadersParallelEnv` with these options."""
    return LeadersParallelEnv(render_mode=render_mode, **options)


class _Turns(OwnFlocks, OrderEnforcingWrapper[str, Any, Any]):
    """Agents that act in turn. An action is checked in its agent's turn, before the flock moves."""

    def __init__(self, parallel: LeadersParallelEnv) -> None:
        self._parallel = parallel
        super().__init__(parallel_to_aec(parallel))

    @property
    def np_random(self) -> np.random.Generator:
        """The generator that draws a seed if a reset is given none."""
        return self._parallel.np_random

    @np_random.setter
    def np_random(self, generator: np.random.Generator) -> None:
        self._parallel.np_random = generator

    def step(self, action: object) -> None:
        # An agent whose episode is over takes no action.
        if self._parallel.agents:
            self._parallel._rudder(self.agent_selection, action)
        super().step(action)


def env(*, render_mode: str | None = None, **options: object) -> AECEnv[str, Any, Any]:
    """Return `parallel_env` as PettingZoo's AEC environment, whose agents act in turn.

    The flock moves once all agents have acted.
    """
    return _Turns(parallel_env(render_mode=render_mode, **options))
