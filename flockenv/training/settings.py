"""`TrainingSettings`: everything that a training run depends on."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any, Self

import tomli_w

from flockenv import _core
from flockenv._io.toml import read_toml
from flockenv.envs.batch import LeaderBatch
from flockenv.envs.options import EnvOptions
from flockenv.errors import FlockError, ParameterError, refuse_unknown
from flockenv.parameters import FlockParameters
from flockenv.policies.encoders import ENCODERS
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.training.accepted import accepted

__all__ = ["TrainingError", "TrainingSettings"]


class TrainingError(FlockError, RuntimeError):
    """Training cannot continue; the last checkpoint is intact, and the message names it."""


@dataclass(frozen=True)
class TrainingSettings:
    """Settings of PPO with one policy shared by all leaders; checked once, to and from TOML.

    A sample is one leader's decision. Raises `ParameterError` for values out of range.

    Attributes
    ----------
    preset, n_boats
        Of the flock; leaders are counted in `n_boats`.
    pools
        Named pools, each with `num_flocks` flocks.
    n_leaders
        Numbers of leaders, dealt out to the flocks of each pool in turn.
    noise
        Lowest and highest noise, drawn for each episode, in units of the pool's critical noise
        (`FlockParameters.critical_bw_s`).
    target
        ``"random"``, ``"cw"``, ``"ccw"`` or ``"alternate"``.
    episode_s, control_hz
        Length of a training episode in s, and control steps per second.
    mirror_to_target, observation, reward
        The environments' options of those names.
    options
        Further options of the environments, such as ``delay_frames``.
    samples, flock_hours
        When to stop: the run ends with the rollout that reaches it. Either the samples or the time
        that all flocks together are simulated for, in hours; 2,000,000 samples where neither is
        given. The one that is not given is None.
    num_flocks, n_steps, batch_size, n_epochs
        Flocks in each pool; control steps of a rollout; samples of a minibatch, which must divide a
        rollout; passes through a rollout.
    learning_rate, final_learning_rate
        Of Adam, falling linearly with the samples.
    gamma, gae_lambda, clip_range, ent_coef, vf_coef, max_grad_norm, target_kl
        As in stable-baselines3's PPO; `target_kl` 0: no limit.
    net_arch, activation
        Hidden layers of the actor, and what stands between layers. In action mode "lean" an actor
        without a start starts close to the tuned law, which is the lean of 0.
    encoder, encoder_arch
        What stands between the observation and the actor's layers: ``"none"``; ``"deepsets"``, a
        mean embedding of the observed neighbors by a network with the layers `encoder_arch`; or
        ``"leaning"``, the features of a leaning law, standardized under the tuned law
        (`flockenv.policies.encoders`).
    critic_arch
        Hidden layers of the critic; None: those of the actor.
    squash
        Whether actions go through a hyperbolic tangent, where they are clipped otherwise.
    average
        Share of each rollout in the moving average of the actor's weights, in (0, 1], which is what
        is validated and stored as policies; 1: the last weights.
    critic
        What the critic sees: ``"observation"``, as the actor does, or ``"flock"``, the features of
        the whole flock, too (`LeaderVecEnv.flock_features`).
    log_std_init, use_sde, sde_sample_freq
        Exploration: logarithm of the first standard deviation, whether it depends on the state
        (gSDE), and control steps after which it is drawn again. With gSDE the deviation is that of
        each weight of the last layer, else that of the action.
    learn_log_std
        Whether the standard deviation of the exploration is learned, or stays as it is.
    shared_noise_s
        Time in s for which all leaders of a flock deviate from the mean policy by one common noise,
        a whole number of decisions (`flockenv.sb3.SharedNoisePolicy`); 0: each leader has a noise
        of its own at every decision. With `use_sde` the noise perturbs the weights of the last
        layer for this time, instead of `sde_sample_freq`.
    seed
        Number of the training run; the flocks' seeds come from it (`runs.seeds.POLICY_SEEDS`).
    start
        A network's ``.npz`` file to start from, whose hidden layers and layout these must be; or a
        leaning law's file, the ``.zip`` file of a model of stable-baselines3 or the name of a
        closed-form law, which is cloned first; empty: from nothing.
    checkpoint_every
        Samples between checkpoints.
    validate_every, validation_episodes, validation_s, validation_hz
        Samples between validations of the mean policy at the critical noise, episodes for each
        pool and number of leaders, their length in s and control steps per second.
    validate_from
        Share of the samples before which nothing is validated, in [0, 1]; 1: the end alone is.
    device
        ``"auto"`` (a GPU if there is one), ``"cpu"`` or ``"cuda"``.
    """

    preset: str = "simulation"
    n_boats: int = 27
    pools: tuple[str, ...] = ("wide", "narrow")
    n_leaders: tuple[int, ...] = (1, 2, 3, 4)
    noise: tuple[float, float] = (0.5, 1.25)
    target: str = "random"
    episode_s: float = 240.0
    control_hz: float = 10.0
    mirror_to_target: bool = True
    observation: Mapping[str, Any] = field(default_factory=dict)
    reward: Mapping[str, float] = field(default_factory=lambda: {"signed_order": 1.0})
    options: Mapping[str, Any] = field(default_factory=dict)
    samples: int | None = None
    flock_hours: float | None = None
    num_flocks: int = 16
    n_steps: int = 128
    batch_size: int = 512
    n_epochs: int = 6
    learning_rate: float = 3e-4
    final_learning_rate: float = 3e-4
    gamma: float = 0.995
    gae_lambda: float = 0.95
    clip_range: float = 0.2
    ent_coef: float = 0.0
    vf_coef: float = 0.5
    max_grad_norm: float = 0.5
    target_kl: float = 0.0
    net_arch: tuple[int, ...] = (64, 64)
    activation: str = "tanh"
    encoder: str = "none"
    encoder_arch: tuple[int, ...] = (32, 32)
    critic: str = "observation"
    critic_arch: tuple[int, ...] | None = None
    squash: bool = False
    average: float = 1.0
    log_std_init: float = -0.5
    learn_log_std: bool = True
    use_sde: bool = False
    sde_sample_freq: int = 16
    shared_noise_s: float = 0.0
    seed: int = 0
    start: str = ""
    checkpoint_every: int = 100_000
    validate_every: int = 500_000
    validate_from: float = 0.0
    validation_episodes: int = 8
    validation_s: float = 240.0
    validation_hz: float = 10.0
    device: str = "auto"

    def __post_init__(self) -> None:
        for each in fields(self):
            value = getattr(self, each.name)
            if each.name not in _OPTIONAL or value is not None:
                example = _EXAMPLES.get(each.name, each.default)
                object.__setattr__(self, each.name, accepted(each.name, value, example))
        if self.samples is not None and self.flock_hours is not None:
            raise ParameterError(
                f"flock_hours = {self.flock_hours!r} is not accepted with samples = "
                f"{self.samples!r}: one or the other"
            )
        if self.samples is None and self.flock_hours is None:
            object.__setattr__(self, "samples", _SAMPLES)
        if self.noise[0] > self.noise[1]:
            raise ParameterError(f"noise = {self.noise!r} is not accepted: (lowest, highest)")
        if self.rollout_samples % self.batch_size:
            raise ParameterError(
                f"batch_size = {self.batch_size!r} is not accepted: it must divide the "
                f"{self.rollout_samples} samples of a rollout (n_steps x leaders of all flocks)"
            )
        for name in self.options:
            if name in _NOT_OPTIONS:
                raise ParameterError(f"options: {name!r} is not accepted: another setting rules it")
        rates = set()
        for pool in self.pools:
            options = {**self.environment(pool), "n_leaders": max(self.n_leaders)}
            try:
                batch = LeaderBatch(EnvOptions.parse(options), self.n_leaders, "same_step")
            except TypeError as error:
                raise ParameterError(str(error)) from error
            self._check_shared_noise(batch.decisions_hz)
            rates.add(batch.decisions_hz)
        if len(rates) > 1:
            raise ParameterError(
                f"options: decision_period_cycles = {self.options['decision_period_cycles']!r} is "
                "not accepted, since motor cycles differ between pools: decision_period_s holds "
                "in all of them"
            )
        if self.encoder != "none":
            ENCODERS[self.encoder].check(self.observation, self.mirror_to_target)
        object.__setattr__(self, "_decisions_hz", batch.decisions_hz)
        object.__setattr__(self, "_decision_period_s", batch.settings["decision_period_s"])

    def _check_shared_noise(self, decisions_hz: float) -> None:
        try:
            self.held_decisions(decisions_hz)
        except ParameterError as error:
            raise ParameterError(f"shared_noise_s: {error}") from error

    def flock_seeds(self, count: int) -> range:
        """Return seeds of the run's flocks (`runs.seeds.POLICY_SEEDS`)."""
        return POLICY_SEEDS["training"].seeds(count, self.seed)

    @property
    def leaders(self) -> int:
        """Leaders of all flocks: samples of one control step."""
        dealt = (self.n_leaders[i % len(self.n_leaders)] for i in range(self.num_flocks))
        return len(self.pools) * sum(dealt)

    @property
    def rollout_samples(self) -> int:
        """Samples of one rollout."""
        return self.n_steps * self.leaders

    def environment(self, pool: str) -> dict[str, Any]:
        """Return the options of the environment in a pool, without the numbers of leaders."""
        critical = FlockParameters.critical_bw_s(self.preset, pool)
        return {
            "preset": self.preset,
            "pool": pool,
            "n_boats": self.n_boats,
            "bw_s": (self.noise[0] * critical, self.noise[1] * critical),
            "target": self.target,
            "episode_s": self.episode_s,
            "control_hz": self.control_hz,
            "mirror_to_target": self.mirror_to_target,
            "observation": dict(self.observation),
            "reward": dict(self.reward),
            **self.options,
        }

    @property
    def decisions(self) -> dict[str, Any]:
        """What actions stand for and how long they are held, as `options` say."""
        return {
            "action_mode": self.options.get("action_mode", "rudder"),
            "decision_period_s": self.__dict__["_decision_period_s"],
        }

    def held_decisions(self, decisions_hz: float) -> int:
        """Return for how many decisions leaders share a noise; 0: each has a noise of its own."""
        held_s = self.shared_noise_s
        return _core.held_decisions(held_s, decisions_hz) if held_s else 0

    @property
    def decisions_hz(self) -> float:
        """Decisions of a leader per second."""
        hz: float = self.__dict__["_decisions_hz"]
        return hz

    @property
    def total_samples(self) -> int:
        """Samples to stop at, whichever of `samples` and `flock_hours` is given."""
        if self.samples is not None:
            return self.samples
        assert self.flock_hours is not None
        # Without the last digits, 0.1 flock-hours may not take a decision more.
        decisions = round(self.flock_hours / self._flock_hours_a_decision, 6)
        return math.ceil(decisions) * self.leaders

    @property
    def _flock_hours_a_decision(self) -> float:
        return len(self.pools) * self.num_flocks / self.decisions_hz / 3600.0

    def flock_hours_at(self, samples: int) -> float:
        """Return for how many hours all flocks together are simulated in a number of samples."""
        return samples / self.leaders * self._flock_hours_a_decision

    def learning_rate_at(self, samples: int) -> float:
        """Return the learning rate after a number of samples."""
        done = min(1.0, samples / self.total_samples)
        return self.learning_rate + done * (self.final_learning_rate - self.learning_rate)

    def replace(self, **changes: Any) -> Self:
        """Return these settings with some fields changed; a new limit replaces the other one."""
        own = self.to_dict()
        if _LIMITS & changes.keys():
            own = {name: value for name, value in own.items() if name not in _LIMITS}
        return type(self).from_dict({**own, **changes})

    def to_dict(self) -> dict[str, Any]:
        """Return every field by name, but for those that are None."""
        return {name: value for name, value in asdict(self).items() if value is not None}

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Self:
        """Return settings from fields by name, defaults for the others.

        Raises
        ------
        ParameterError
            For unknown names, with the nearest one, and values out of range.
        """
        names = [each.name for each in fields(cls)]
        refuse_unknown(values, names, "setting of the training")
        return cls(**values)

    def to_toml(self) -> str:
        """Return the settings as TOML."""
        return tomli_w.dumps(self.to_dict())

    @classmethod
    def from_toml(cls, text: str) -> Self:
        """Return settings from TOML.

        Raises
        ------
        ParameterError
            For text that is no TOML, and as `from_dict`.
        """
        return cls.from_dict(read_toml(text, "the text of settings"))


_SAMPLES = 2_000_000
_LIMITS = {"samples", "flock_hours"}
_OPTIONAL = {*_LIMITS, "critic_arch"}
#: Values of settings whose default is None.
_EXAMPLES: Mapping[str, Any] = {"samples": _SAMPLES, "flock_hours": 1.0, "critic_arch": (64, 64)}
#: Settings of their own, and what the network's output does not fit.
_NOT_OPTIONS = (
    *(each.name for each in fields(TrainingSettings)),
    "pool",
    "params",
    "bw_s",
    "rudder_levels",
    "render_mode",
)
