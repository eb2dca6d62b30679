"""`TrainingSettings`: everything that a training run depends on."""

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from inspect import signature
from types import MappingProxyType
from typing import Any, Self

import tomli_w
from stable_baselines3 import PPO
from stable_baselines3.common.utils import LinearSchedule

from flockenv._io.arguments import as_int
from flockenv._io.toml import read_toml_file
from flockenv.envs.options import EnvOptions
from flockenv.errors import ParameterError, refuse_unknown, short_repr
from flockenv.parameters import FlockParameters
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.sb3 import LeaderVecEnv, SharedNoisePolicy, shared_noise

#: Times in s by pool, chosen by how fast its order responds: the length of an episode, the horizons
#: of discount and advantage, and the time for which a flock's leaders hold one exploration noise.
_TIMES_S: Mapping[str, Mapping[str, float]] = {
    "wide": {"episode": 480.0, "discount": 200.0, "advantage": 80.0, "hold": 240.0},
    "narrow": {"episode": 240.0, "discount": 60.0, "advantage": 27.0, "hold": 60.0},
}
#: The observation that holds only the lean features, on which leans depend.
_OBSERVATION: Mapping[str, Any] = {
    "own": False,
    "phase": False,
    "target": False,
    "neighbors": 0,
    "order": False,
    "lean_features": True,
}
#: Length of a rollout in s, and number of minibatches into which its samples are divided.
_ROLLOUT_S, _BATCHES = 240, 8
_PHYSICS: Mapping[str, Any] = {"physics": "training"}
#: Arguments of PPO that `TrainingSettings` sets, so that ``ppo`` may not hold them.
_SET_HERE = ("policy", "env", "seed", "_init_setup_model")


@dataclass(frozen=True)
class TrainingSettings:
    """Settings of PPO with one policy shared by all leaders; checked once, to and from TOML.

    A leader's lean is a linear function of its lean features. All leaders of a flock explore with
    the same perturbed weights, held for minutes (`flockenv.sb3.SharedNoisePolicy`).

    Attributes
    ----------
    pool
        ``"wide"`` or ``"narrow"``; the flocks have its critical noise.
    n_leaders
        Leaders of each flock.
    flock_hours
        When to stop: simulated hours of all flocks together.
    num_flocks
        Flocks that are stepped together.
    seed
        Seed of the training, from 0 to 2³² - 1.
    environment
        Options of `flockenv.sb3.LeaderVecEnv` that differ from this training's defaults.
    ppo
        Options of stable-baselines3's ``PPO`` that differ from this training's defaults.

    Raises
    ------
    ParameterError
        For unknown options, and values that are not accepted.
    """

    pool: str = "wide"
    n_leaders: int = 3
    flock_hours: float = 500.0
    num_flocks: int = 128
    seed: int = 0
    environment: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))
    ppo: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        # A list: a dictionary would raise TypeError for an unhashable pool.
        if self.pool not in [*_TIMES_S]:
            raise ParameterError(f"pool = {short_repr(self.pool)} is not accepted: wide or narrow")
        hours: object = self.flock_hours
        if (
            isinstance(hours, bool)
            or not isinstance(hours, int | float)
            or not 0.0 < hours < math.inf
        ):
            raise ParameterError(f"flock_hours = {short_repr(hours)} is not accepted: above 0")
        for name in ("environment", "ppo"):
            if not isinstance(getattr(self, name), Mapping):
                raise ParameterError(f"{name} = {short_repr(getattr(self, name))} is not a table")
        refuse_unknown(self.ppo, set(signature(PPO).parameters) - {*_SET_HERE}, "option of PPO")
        POLICY_SEEDS["training"].seeds(1, as_int(self.seed, "seed"))  # Only for its errors.

    def flocks(self) -> dict[str, Any]:
        """Return the options of the environment for the pool, boats, leaders and noise."""
        return {
            "pool": self.pool,
            "n_boats": 27,
            "n_leaders": self.n_leaders,
            "bw_s": FlockParameters.critical_bw_s("simulation", self.pool),
        }

    def held_out(self) -> FlockParameters:
        """Return the parameters of the flocks in which trained leaders are compared.

        They have the parameters of the training, physics included. If the training draws the noise
        from a range, they have the critical noise.
        """
        options = dict(self.environment)
        if isinstance(options.get("bw_s"), list | tuple):
            del options["bw_s"]
        options.pop("n_leaders", None)
        return EnvOptions.parse({**self.flocks(), **_PHYSICS, **options}).parameters

    def venv(self) -> LeaderVecEnv:
        """Return the environment of the training.

        Raises
        ------
        ParameterError
            For options that the environment does not take.
        """
        times = _TIMES_S[self.pool]
        options = {
            **self.flocks(),
            "target": "random",
            "mirror_to_target": True,
            "observation": _OBSERVATION,
            "action_mode": "lean",
            "decision_period_s": 1.0,
            "reward": {"signed_order": 1.0, "contact_alignment": 30.0},
            "episode_s": times["episode"],
            "reward_horizon_s": 40.0,  # It scales returns to about 1, as the critic needs.
            **_PHYSICS,
        }
        return LeaderVecEnv(self.num_flocks, **{**options, **self.environment})

    def model(self, venv: Any) -> PPO:
        """Return an untrained PPO model on an environment with these settings.

        Raises
        ------
        ParameterError
            For options that PPO refuses.
        """
        times, hz = _TIMES_S[self.pool], venv.unwrapped.decisions_hz
        n_steps = max(2, round(_ROLLOUT_S * hz))
        options: dict[str, Any] = {
            "n_steps": n_steps,
            "batch_size": max(2, n_steps * venv.num_envs // _BATCHES),
            "n_epochs": 4,
            "learning_rate": LinearSchedule(2e-3, 0.0, 1.0),
            "gamma": 1.0 - 1.0 / (times["discount"] * hz),
            "gae_lambda": 1.0 - 1.0 / (times["advantage"] * hz),
            "use_sde": True,
            "device": "cpu",
            **self.ppo,
        }
        policy_options = {
            **shared_noise(venv, times["hold"]),
            "net_arch": {"pi": [], "vf": [64, 64]},
            "log_std_init": -2.4,
            "squash_output": bool(options["use_sde"]),
            **(options.pop("policy_kwargs", None) or {}),
        }
        try:
            model = PPO(
                SharedNoisePolicy, venv, policy_kwargs=policy_options, seed=self.seed, **options
            )
        except (AssertionError, TypeError, ValueError) as error:
            raise ParameterError(f"PPO refuses its options: {error}") from error
        # A learned standard deviation would soon end the exploration of weights with a small
        # gradient.
        model.policy.log_std.requires_grad_(False)
        return model

    def samples(self, venv: LeaderVecEnv) -> int:
        """Return the number of samples (leaders' decisions) in `flock_hours`."""
        decisions = self.flock_hours * 3600.0 * venv.decisions_hz / venv.num_flocks
        # Rounded first: a rounding error must not add a decision.
        return math.ceil(round(decisions, 6)) * venv.num_envs

    def replace(self, **changes: object) -> Self:
        """Return these settings with some fields changed."""
        return type(self).from_dict({**self.to_dict(), **changes})

    def to_dict(self) -> dict[str, Any]:
        """Return every field by name, in types of TOML."""
        values = {setting.name: getattr(self, setting.name) for setting in fields(self)}
        return {**values, "environment": dict(self.environment), "ppo": dict(self.ppo)}

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Self:
        """Return settings from fields by name; missing fields have their defaults.

        Raises
        ------
        ParameterError
            For unknown names, with the nearest one, and values that are not accepted.
        """
        refuse_unknown(values, [setting.name for setting in fields(cls)], "setting of the training")
        return cls(**values)

    def to_toml(self) -> str:
        """Return the settings as TOML."""
        return tomli_w.dumps(self.to_dict())

    @classmethod
    def from_file(cls, path: str | os.PathLike[str]) -> Self:
        """Return settings from a TOML file.

        Raises
        ------
        ParameterError
            For a file that cannot be read or is not TOML, and as `from_dict`.
        """
        return cls.from_dict(read_toml_file(path, str(path)))
