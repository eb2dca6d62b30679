"""A critic that sees the whole flock, beside actors that see what their leader observes."""

from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import MlpExtractor
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper

from flockenv.envs.observation import FlockRowSpace, ObservationSpace
from flockenv.errors import ParameterError
from flockenv.sb3.leader_vec_env import LeaderVecEnv

__all__ = ["FlockCriticPolicy", "WithFlockFeatures"]


class WithFlockFeatures(VecEnvWrapper):
    """A `LeaderVecEnv` whose rows are a leader's observation, followed by its flock's features.

    ``PPO(FlockCriticPolicy, venv, policy_kwargs=venv.policy_kwargs)`` gives the first part alone to
    the actor, so that the model steers wherever a policy does.

    Parameters
    ----------
    venv
        A `LeaderVecEnv`.

    Attributes
    ----------
    policy_kwargs : dict
        ``seen``, the size of an observation.

    Raises
    ------
    TypeError
        If `venv` is none.
    """

    venv: LeaderVecEnv

    def __init__(self, venv: VecEnv) -> None:
        if not isinstance(venv, LeaderVecEnv):
            raise TypeError(f"a LeaderVecEnv is needed, not {type(venv).__name__}")
        own = venv.observation_space
        assert isinstance(own, ObservationSpace)
        super().__init__(venv, observation_space=FlockRowSpace(own))
        self.policy_kwargs = {"seen": own.shape[0]}

    def reset(self) -> NDArray[np.float32]:
        """Start episodes in all flocks; return rows, shape (slots, observation + features)."""
        return self._joined(self.venv.reset())

    def step_wait(
        self,
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Take the decision's control steps; terminal observations have the flock's features."""
        observations, rewards, dones, infos = self.venv.step_wait()
        for slot in np.flatnonzero(dones).tolist():
            last = infos[slot]["terminal_observation"], infos[slot]["terminal_flock_features"]
            infos[slot]["terminal_observation"] = np.concatenate(last)
        return self._joined(observations), rewards, dones, infos

    def _joined(self, observations: NDArray[np.float32]) -> NDArray[np.float32]:
        return np.concatenate([observations, self.venv.flock_features()], axis=1)


class _TwoViews(torch.nn.Module):
    """Hidden layers of the actor on the first numbers of a row, of the critic on the whole row."""

    def __init__(self, seen: int, actor: MlpExtractor, critic: MlpExtractor) -> None:
        super().__init__()
        self._seen = seen
        self.policy_net, self.value_net = actor.policy_net, critic.value_net
        self.latent_dim_pi, self.latent_dim_vf = actor.latent_dim_pi, critic.latent_dim_vf

    def forward(self, rows: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        return self.forward_actor(rows), self.forward_critic(rows)

    def forward_actor(self, rows: torch.Tensor) -> torch.Tensor:
        latent: torch.Tensor = self.policy_net(rows[..., : self._seen])
        return latent

    def forward_critic(self, rows: torch.Tensor) -> torch.Tensor:
        latent: torch.Tensor = self.value_net(rows)
        return latent


class FlockCriticPolicy(ActorCriticPolicy):
    """An actor-critic policy whose actor sees only the first numbers of each row.

    The value of a state depends on the whole flock, of which one leader observes a few boats. A
    critic is needed in training alone, so that it may see more than the actor does. The class may
    stand before `SharedNoisePolicy` in the bases of a policy that is both.

    Parameters
    ----------
    observation_space, action_space, lr_schedule, options
        As of stable-baselines3's ``ActorCriticPolicy``; ``net_arch`` gives the hidden layers of
        both.
    seen
        Numbers of a row that the actor sees.

    Raises
    ------
    ParameterError
        If a row has fewer numbers, or none is seen.
    """

    def __init__(
        self,
        observation_space: Any,
        action_space: Any,
        lr_schedule: Any,
        *,
        seen: int,
        **options: Any,
    ) -> None:
        size = observation_space.shape[0]
        if not 1 <= seen <= size:
            raise ParameterError(f"seen = {seen!r} is not accepted: from 1 to {size}")
        self._seen = seen
        super().__init__(observation_space, action_space, lr_schedule, **options)

    def predict(
        self,
        observation: Any,
        state: Any = None,
        episode_start: Any = None,
        deterministic: bool = False,
    ) -> tuple[Any, Any]:
        """Return actions for rows, or for the parts of rows that the actor sees."""
        rows = np.asarray(observation)
        if rows.shape[-1:] == (self._seen,):
            unseen = self.observation_space.shape[0] - self._seen  # type: ignore[index]
            rows = np.append(rows, np.zeros((*rows.shape[:-1], unseen), rows.dtype), axis=-1)
        return super().predict(rows, state, episode_start, deterministic)

    def _build_mlp_extractor(self) -> None:
        actor, critic = (
            MlpExtractor(size, self.net_arch, self.activation_fn, self.device)
            for size in (self._seen, self.features_dim)
        )
        self.mlp_extractor = _TwoViews(self._seen, actor, critic)  # type: ignore[assignment]

    def _get_constructor_parameters(self) -> dict[str, Any]:
        return {**super()._get_constructor_parameters(), "seen": self._seen}
