"""Signal of the policy gradient: how clearly samples show that a direction is the right one.

A policy explores about its mean action: a = mu(s) + sigma(s)*e. Along the direction d(s) from its
own mean actions to those of another policy, the policy gradient is E[e*d(s)/sigma(s)*A], where A is
the return less a baseline. Each flock's episode gives an independent estimate. Their mean over its
standard error is the significance z. It grows with the square root of the samples, so that z per
million samples compares rewards, horizons and action modes.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv.comparison.baseline import least_squares
from flockenv.comparison.exploration import Exploration
from flockenv.comparison.layout import in_one_layout
from flockenv.envs.batch import LeaderBatch
from flockenv.envs.options import EnvOptions
from flockenv.envs.reward import TERMS
from flockenv.errors import ParameterError, refuse_unknown, shown
from flockenv.parameters import FlockParameters
from flockenv.policies import NetworkPolicy
from flockenv.policies.base import LeaderPolicy, check_action_mode
from flockenv.runs.seeds import POLICY_SEEDS

__all__ = ["ConstantAction", "Signal", "SignalSettings", "measured_signals"]

_LARGEST_SQUASHED = 0.9999
#: Rows that a baseline is fitted to, about.
_ROWS = 20_000


class ConstantAction:
    """The same action for every leader at all times, as an end of a direction.

    Parameters
    ----------
    value
        The action, in [-1, 1].
    action_mode
        The environments' option of that name.
    """

    def __init__(self, value: float, action_mode: str) -> None:
        if not -1.0 <= value <= 1.0:
            raise ParameterError(f"action = {value!r} is not accepted: a number in [-1, 1]")
        self.value, self.action_mode = value, action_mode

    def predict(
        self, observation: Any, state: Any = None, episode_start: Any = None
    ) -> tuple[NDArray[np.float32], Any]:
        """Return the action for each row of observations, shape (rows, 1)."""
        return np.full((len(observation), 1), self.value, np.float32), state

    def observing(self, observation: Mapping[str, Any], mirror_to_target: bool) -> Self:
        """Return the same action for another layout of the observations: itself."""
        return self

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.value:g}, {self.action_mode!r})"


@dataclass(frozen=True)
class SignalSettings:
    """How a signal is measured; checked once.

    Attributes
    ----------
    rewards
        Weights of the reward's terms by the name to list a reward under.
    horizons_s
        Times in s over which returns are discounted by a factor e.
    deviation
        Standard deviation of the exploration, in units of the action.
    hold_s
        Time in s that an exploration is held; None: one decision.
    shared
        Whether all leaders of a flock explore with the same noise.
    weights
        Whether the noise perturbs weights and not the action (gSDE): those of the last layer of the
        `NetworkPolicy` that the direction goes to, biases included. `deviation` is then that of
        an action for inputs of the layer whose mean square is 1.
    flocks, rounds
        Flocks at a time, an even number, and how often that many start.
    duration_s
        Length of an episode in s.
    options
        Options of the environment, such as ``action_mode``, ``decision_period_s``, ``control_hz``
        and ``physics``. Its layout of the observation is that of the policies.
    seed
        Number of the measurement; seeds are those of the range ``"signal"`` of
        `flockenv.runs.seeds.POLICY_SEEDS`.
    """

    rewards: Mapping[str, Mapping[str, float]]
    horizons_s: Sequence[float]
    deviation: float = 0.3
    hold_s: float | None = None
    shared: bool = False
    weights: bool = False
    flocks: int = 64
    rounds: int = 1
    duration_s: float = 240.0
    options: Mapping[str, Any] | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        for name, least in (("deviation", 1e-6), ("duration_s", 1e-3), ("rounds", 1)):
            value = getattr(self, name)
            if not least <= value < math.inf:
                raise ParameterError(f"{name} = {shown(value)} is not accepted: at least {least:g}")
        if self.flocks < 4 or self.flocks % 2:
            raise ParameterError(
                f"flocks = {shown(self.flocks)} is not accepted: an even number of at least 4"
            )
        if not self.rewards or not self.horizons_s:
            raise ParameterError("no reward or no horizon is not accepted: at least one of each")
        for weights in self.rewards.values():
            refuse_unknown(weights, TERMS, "part of reward")
        for horizon in self.horizons_s:
            if not 0.0 < horizon < math.inf:
                raise ParameterError(
                    f"horizon = {shown(horizon)} is not accepted: a positive time in s"
                )


@dataclass(frozen=True)
class Signal:
    """The signal of one reward at one horizon.

    Attributes
    ----------
    pool, action_mode, reward, horizon_s
        What was measured; rewards by their names in the settings.
    z_per_million
        Significance of the gradient along the direction, scaled to a million samples. Positive: it
        points the way that the direction goes.
    error
        Its standard error.
    z
        Significance with the samples that were taken.
    samples, flock_hours
        Leaders' decisions, and simulated time of all flocks.
    explained
        Part of the variance of returns that the baseline explains, on other flocks than it was
        fitted to.
    """

    pool: str
    action_mode: str
    reward: str
    horizon_s: float
    z_per_million: float
    error: float
    z: float
    samples: int
    flock_hours: float
    explained: float

    def row(self) -> dict[str, Any]:
        """Return the fields by name."""
        return asdict(self)


def measured_signals(
    parameters: FlockParameters,
    start: LeaderPolicy,
    towards: LeaderPolicy,
    settings: SignalSettings,
    progress: Callable[[float], object] = lambda flock_seconds: None,
) -> list[Signal]:
    """Measure the gradient's signal along the direction from one policy to another.

    Where the direction goes to a squashed network, exploration and direction are those of what the
    hyperbolic tangent takes. All rewards and horizons are measured on the same flocks. The baseline
    is linear in what the leader observes and in the features of its flock, and is fitted to the
    other half of the flocks.

    Parameters
    ----------
    parameters
        The flock, with its pool and number of leaders.
    start
        The policy that explores: its actions are the mean.
    towards
        Where the direction goes.
    settings
        How it is measured.
    progress
        Called with flock-seconds as they are simulated.

    Returns
    -------
    list of Signal
        One for each reward and horizon, in order.

    Raises
    ------
    ParameterError
        For settings and options out of range, for policies of another action mode or layout of
        observations, for two policies that always act alike, and for a noise of weights without a
        network that the direction goes to.
    """
    if settings.weights and not isinstance(towards, NetworkPolicy):
        raise ParameterError(
            f"weights are not perturbed along a direction to {shown(towards)}: it has to go to a "
            "NetworkPolicy, such as the .npz file of a training"
        )
    terms = {name for weights in settings.rewards.values() for name in weights}
    (start, towards), options = in_one_layout((start, towards), settings.options or {})
    options |= {
        "params": parameters,
        "episode_s": settings.duration_s,
        "reward": dict.fromkeys(terms, 1.0),
    }
    parsed = EnvOptions.parse(options)
    batch = LeaderBatch(parsed, [parameters.n_leaders] * settings.flocks, "disabled")
    mode = batch.settings["action_mode"]
    for policy in (start, towards):
        check_action_mode(policy, mode, "in this environment")
    held_s = settings.hold_s
    hold = 1 if held_s is None else _core.held_decisions(held_s, batch.decisions_hz)
    pairs = [(name, h) for name in settings.rewards for h in settings.horizons_s]
    found: dict[tuple[str, float], list[tuple[NDArray[np.float64], float]]] = {}
    samples, differs = 0, False
    for number in range(settings.rounds):
        first = number * settings.flocks
        seeds = POLICY_SEEDS["signal"].seeds(settings.flocks, settings.seed, first)
        random = np.random.default_rng([settings.seed, number])
        each = _Round(batch, start, towards, settings, seeds, random, hold, progress)
        samples += each.scores.size
        differs = differs or bool(each.scores.any())
        for name, horizon in pairs:
            estimate = each.estimates(settings.rewards[name], horizon)
            found.setdefault((name, horizon), []).append(estimate)
    if not differs:
        raise ParameterError(
            f"{start!r} and {towards!r} always act alike: a direction needs two policies"
        )
    hours = settings.rounds * settings.flocks * settings.duration_s / 3600.0
    signals = []
    for name, horizon in pairs:
        estimates, explained = zip(*found[name, horizon], strict=True)
        z, per_million, error = _significance(np.concatenate(estimates), samples)
        signals.append(
            Signal(
                pool=str(parameters.pool),
                action_mode=mode,
                reward=name,
                horizon_s=float(horizon),
                z_per_million=per_million,
                error=error,
                z=z,
                samples=samples,
                flock_hours=hours,
                explained=float(np.mean(explained)),
            )
        )
    return signals


def _significance(estimates: NDArray[np.float64], samples: int) -> tuple[float, float, float]:
    """Return z, z per million samples, and the standard error of the latter."""
    deviation = estimates.std(ddof=1)
    if deviation == 0.0:
        return 0.0, 0.0, math.inf
    z = float(estimates.mean() / deviation * math.sqrt(len(estimates)))
    scale = math.sqrt(1e6 / samples)
    # Of a mean over a deviation that is estimated, too.
    return z, z * scale, scale * math.sqrt(1.0 + z * z / (2.0 * len(estimates)))


def _unsquashed(actions: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.arctanh(np.clip(actions, -_LARGEST_SQUASHED, _LARGEST_SQUASHED))


class _Round:
    """One episode of each flock: scores along the direction, terms and what a baseline sees.

    Attributes
    ----------
    scores
        Shape (decisions, rows): derivative of the action's log probability along the direction.
    terms
        Shape (decisions, rows) by name: terms of the reward, means over each decision.
    """

    def __init__(
        self,
        batch: LeaderBatch,
        start: LeaderPolicy,
        towards: LeaderPolicy,
        settings: SignalSettings,
        seeds: range,
        random: np.random.Generator,
        hold: int,
        progress: Callable[[float], object],
    ) -> None:
        self.leaders = batch.leaders[0]
        self.decisions_hz = batch.decisions_hz
        rows = settings.flocks * self.leaders
        squashed = bool(getattr(towards, "squashed", False))
        exploration = Exploration(
            random,
            settings.flocks,
            self.leaders,
            deviation=settings.deviation,
            shared=settings.shared,
            hold=hold,
            inputs=getattr(towards, "last_inputs", None) if settings.weights else None,
        )
        batch.reset(list(seeds), None, lambda: 0)
        seen = batch.observe()
        inputs: list[NDArray[np.float32]] = []
        scores: list[NDArray[np.float64]] = []
        terms: list[dict[str, NDArray[np.float64]]] = []
        over = False
        while not over:
            noise, deviation = exploration.next(seen)
            mean, other = (
                np.asarray(policy.predict(seen)[0], np.float64).reshape(rows)
                for policy in (start, towards)
            )
            features = np.repeat(batch.flock_features(), self.leaders, axis=0)
            inputs.append(np.concatenate([seen, features], axis=1))
            if squashed:
                mean, other = _unsquashed(mean), _unsquashed(other)
            scores.append(noise * (other - mean) / deviation**2)
            action = mean + noise
            actions = np.tanh(action) if squashed else np.clip(action, -1.0, 1.0)
            seen, _, truncated = batch.step(actions)
            terms.append(batch.reward_terms())
            over = bool(truncated.all())
            progress(settings.flocks / self.decisions_hz)
        self.scores = np.array(scores)
        self.inputs = np.array(inputs, np.float32)
        self.terms = {name: np.array([each[name] for each in terms]) for name in TERMS}

    def estimates(
        self, weights: Mapping[str, float], horizon_s: float
    ) -> tuple[NDArray[np.float64], float]:
        """Return an estimate of the gradient per flock, and what the baseline explains."""
        gamma = math.exp(-1.0 / (horizon_s * self.decisions_hz))
        reward = np.zeros_like(self.scores)
        for name, weight in weights.items():
            reward += weight * self.terms[name]
        returns, share = np.zeros_like(reward), np.zeros(len(reward))
        later, left = np.zeros(reward.shape[1]), 0.0
        for step in reversed(range(len(reward))):
            later = (1.0 - gamma) * reward[step] + gamma * later
            left = (1.0 - gamma) + gamma * left
            returns[step], share[step] = later, left
        baseline = self._baseline(returns, share)
        advantage = returns - baseline
        variance = float(np.var(returns))
        explained = 1.0 - float(np.mean(advantage**2)) / variance if variance > 0.0 else 0.0
        flocks = reward.shape[1] // self.leaders
        each = (self.scores * advantage).reshape(len(reward), flocks, self.leaders)
        return each.sum(axis=(0, 2)), explained

    def _baseline(
        self, returns: NDArray[np.float64], share: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the expected return of each sample, fitted to the other half of the flocks.

        Near the end of the episode returns hold a share of the horizon alone.
        """
        half = returns.shape[1] // 2 // self.leaders * self.leaders
        parts = (slice(None, half), slice(half, None))
        baseline = np.zeros_like(returns)
        for own, other in (parts, parts[::-1]):
            # Decisions that follow each other are alike: some of them are enough.
            some = slice(None, None, max(1, returns.size // _ROWS))
            solution = least_squares(self.inputs[some, other], returns[some, other], share[some])
            expected = self.inputs[:, own] @ solution[:-1] + solution[-1]
            baseline[:, own] = share[:, None] * expected
        return baseline
