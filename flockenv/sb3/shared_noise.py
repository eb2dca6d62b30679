"""Exploration noise that all leaders of a flock share, held for several decisions."""

from collections.abc import Sequence
from typing import Any, Self

import gymnasium
import torch
from stable_baselines3.common.distributions import (
    DiagGaussianDistribution,
    StateDependentNoiseDistribution,
)
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.preprocessing import get_action_dim
from stable_baselines3.common.type_aliases import Schedule
from stable_baselines3.common.vec_env import VecEnv

from flockenv import _core
from flockenv._io.arguments import as_int
from flockenv.errors import ParameterError, short_repr
from flockenv.sb3.leader_vec_env import LeaderVecEnv


def shared_noise(venv: VecEnv, hold_s: float) -> dict[str, Any]:
    """Return the ``policy_kwargs`` of a `SharedNoisePolicy` for a vector environment.

    Parameters
    ----------
    venv
        A `LeaderVecEnv`, also inside other wrappers.
    hold_s
        Time in s for which a noise is held, a whole number of the environment's decisions.

    Returns
    -------
    dict
        ``flock_of_slot`` and ``hold_steps``.

    Raises
    ------
    TypeError
        If `venv` is not a `LeaderVecEnv`.
    ParameterError
        For a time that is not a whole number of decisions.
    """
    leaders = getattr(venv, "unwrapped", venv)
    if not isinstance(leaders, LeaderVecEnv):
        raise TypeError(f"a LeaderVecEnv is needed, not {type(leaders).__name__}")
    return {
        "flock_of_slot": leaders.flock_of_slot.tolist(),
        "hold_steps": _core.decisions_in(hold_s, leaders.decisions_hz),
    }


class HeldNoise:
    """Normally distributed numbers, one row per flock, drawn again every `hold_steps` decisions.

    Parameters
    ----------
    flock_of_slot, hold_steps
        As for `SharedNoisePolicy`.
    size
        Length of a row.
    """

    def __init__(self, flock_of_slot: Sequence[int], hold_steps: int, size: int) -> None:
        self._flock_of_slot = torch.as_tensor(list(flock_of_slot))
        self._hold_steps = hold_steps
        self._steps_left = 0
        self._noise = torch.zeros(int(self._flock_of_slot.max()) + 1, size)

    def next(self, slots: int, device: torch.device) -> torch.Tensor:
        """Return the row of each slot's flock at the next decision, shape (slots, size).

        If the number of slots is not the training's, as in a prediction, rows are independent.
        """
        if slots != len(self._flock_of_slot):
            return torch.randn(slots, self._noise.shape[1], device=device)
        if self._steps_left == 0:
            self._noise = torch.randn(self._noise.shape, device=device)
            self._steps_left = self._hold_steps
        self._steps_left -= 1
        return self._noise.to(device)[self._flock_of_slot.to(device)]


class SharedNoiseDistribution(DiagGaussianDistribution):
    """Gaussian actions: leaders of a flock share one deviation from the mean, held for a time.

    A single action has the same distribution and the same probability as with independent noise.
    If the number of slots differs from the training's, the noise is independent.
    """

    def __init__(self, action_dim: int, flock_of_slot: Sequence[int], hold_steps: int) -> None:
        super().__init__(action_dim)
        self.noise = HeldNoise(flock_of_slot, hold_steps, action_dim)

    def sample(self) -> torch.Tensor:
        """Return actions, shape (slots, actions)."""
        mean, deviation = self.distribution.mean, self.distribution.stddev
        return mean + deviation * self.noise.next(len(mean), mean.device)


class SharedWeightNoiseDistribution(StateDependentNoiseDistribution):
    """gSDE (Raffin et al. 2021) with one noise matrix per flock, held for a time.

    A deviation is the matrix times the inputs of the last layer, to which a constant 1 is appended.
    So the leaders of a flock follow one policy, whose last layer has perturbed weights and biases.
    """

    noise: HeldNoise
    _deviations: torch.Tensor

    def __init__(
        self, action_dim: int, flock_of_slot: Sequence[int], hold_steps: int, **options: bool
    ) -> None:
        super().__init__(action_dim, **options)
        self._flock_of_slot, self._hold_steps = flock_of_slot, hold_steps

    def proba_distribution_net(
        self, latent_dim: int, log_std_init: float = -2.0, latent_sde_dim: int | None = None
    ) -> tuple[torch.nn.Module, torch.nn.Parameter]:
        """Return the last layer, and the log standard deviations of its weights and biases."""
        features = (latent_dim if latent_sde_dim is None else latent_sde_dim) + 1
        self.noise = HeldNoise(self._flock_of_slot, self._hold_steps, features * self.action_dim)
        return super().proba_distribution_net(latent_dim, log_std_init, features)

    def sample_weights(self, log_std: torch.Tensor, batch_size: int = 1) -> None:
        """Draw nothing: `noise` decides when to draw, not stable-baselines3 at each rollout."""

    def proba_distribution(
        self, mean_actions: torch.Tensor, log_std: torch.Tensor, latent_sde: torch.Tensor
    ) -> Self:
        """Return the distribution of actions about their means, for inputs of the last layer."""
        self._deviations = self.get_std(log_std).detach()
        ones = torch.ones_like(latent_sde[:, :1])
        super().proba_distribution(mean_actions, log_std, torch.cat([latent_sde, ones], dim=1))
        return self

    def get_noise(self, latent_sde: torch.Tensor) -> torch.Tensor:
        """Return deviations from the mean actions, shape (slots, actions).

        `latent_sde` holds the inputs of the last layer, and the constant 1 as the last of them.
        """
        drawn = self.noise.next(len(latent_sde), latent_sde.device)
        matrices = drawn.reshape(len(latent_sde), *self._deviations.shape) * self._deviations
        return torch.einsum("sf,sfa->sa", latent_sde.detach(), matrices)


class SharedNoisePolicy(ActorCriticPolicy):
    """An actor-critic policy that explores with one held noise for all leaders of a flock.

    ``PPO(SharedNoisePolicy, venv, policy_kwargs=shared_noise(venv, hold_s=24.0))``

    A flock's order responds to a lasting deviation that its leaders share, and hardly to deviations
    that cancel. The noise is drawn from torch's generator, so that the seed of the algorithm fixes
    it.

    If the algorithm has ``use_sde=True``, the noise is gSDE: it perturbs the weights of the last
    layer, so that a leader's deviation depends on its observation
    (`SharedWeightNoiseDistribution`). It is held for `hold_steps` decisions, whatever
    ``sde_sample_freq``.

    Parameters
    ----------
    observation_space, action_space, lr_schedule, options
        As for stable-baselines3's ``ActorCriticPolicy``.
    flock_of_slot
        Flock of each slot, as `LeaderVecEnv.flock_of_slot`.
    hold_steps
        Number of decisions for which a noise is held, at least 1.

    Raises
    ------
    ParameterError
        For discrete actions, for `hold_steps` that is not a whole number of at least 1, and, in a
        training, for flocks with another number of leaders than the policy was made for.
    """

    def __init__(
        self,
        observation_space: gymnasium.spaces.Space[Any],
        action_space: gymnasium.spaces.Space[Any],
        lr_schedule: Schedule,
        *,
        flock_of_slot: Sequence[int],
        hold_steps: int,
        **options: Any,
    ) -> None:
        flock_of_slot, hold_steps = list(flock_of_slot), as_int(hold_steps, "hold_steps")
        if hold_steps < 1 or not flock_of_slot:
            raise ParameterError(
                f"hold_steps = {short_repr(hold_steps)} and {len(flock_of_slot)} slots are not "
                "accepted: at least 1 each"
            )
        self._noise_options: dict[str, Any] = {
            "flock_of_slot": flock_of_slot,
            "hold_steps": hold_steps,
        }
        super().__init__(observation_space, action_space, lr_schedule, **options)

    def _build(self, lr_schedule: Schedule) -> None:
        """Replace stable-baselines3's distribution by the one with shared noise; make the networks.

        Refuses discrete actions.
        """
        distribution, actions = type(self.action_dist), get_action_dim(self.action_space)
        if distribution is DiagGaussianDistribution:
            self.action_dist = SharedNoiseDistribution(actions, **self._noise_options)
        elif distribution is StateDependentNoiseDistribution:
            options: dict[str, Any] = dict(self.dist_kwargs or {})
            self.action_dist = SharedWeightNoiseDistribution(
                actions, **self._noise_options, **options
            )
        else:
            raise ParameterError(
                f"{distribution.__name__} is not accepted with a shared noise: continuous actions"
            )
        super()._build(lr_schedule)

    def forward(
        self, obs: torch.Tensor, deterministic: bool = False
    ) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """Return actions, values and log probabilities of a step of the training."""
        slots = len(self._noise_options["flock_of_slot"])
        if len(obs) != slots:
            raise ParameterError(
                f"{len(obs)} leaders are not accepted: this policy shares its noise among "
                f"{slots}. Load it with custom_objects={{'policy_kwargs': {{**model.policy_kwargs, "
                "**shared_noise(venv, hold_s)}} to train in other flocks"
            )
        return super().forward(obs, deterministic)

    def _get_constructor_parameters(self) -> dict[str, Any]:
        return {**super()._get_constructor_parameters(), **self._noise_options}
