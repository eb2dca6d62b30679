"""Evaluation of models on a `LeaderVecEnv` that counts episodes of flocks, not of leaders."""

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.callbacks import EvalCallback
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper

from flockenv._io.arguments import whole
from flockenv.envs.spaces import ObservationSpace
from flockenv.errors import ParameterError
from flockenv.policies import ModelPolicy
from flockenv.policies.base import check_action_mode, check_pool
from flockenv.sb3.leader_vec_env import LeaderVecEnv
from flockenv.statistics import mean_interval


class PerFlock(VecEnvWrapper):
    """A `LeaderVecEnv` whose rewards, ends and infos come once per flock; for evaluation only.

    stable-baselines3's `evaluate_policy` counts the ends of slots as episodes. A flock's leaders
    have one episode with one order. Here `num_envs` is the number of flocks, a reward is the mean
    over a flock's leaders, and an info is that of its first leader, with the ``"episode"``.
    Observations and actions still have a row per leader, so that the model sees what it was trained
    on.

    Parameters
    ----------
    venv
        A `LeaderVecEnv`, also inside other wrappers.

    Raises
    ------
    TypeError
        If it wraps none.
    """

    def __init__(self, venv: VecEnv) -> None:
        leaders = getattr(venv, "unwrapped", venv)
        if not isinstance(leaders, LeaderVecEnv):
            raise TypeError(f"a LeaderVecEnv is needed, not {type(leaders).__name__}")
        super().__init__(venv)
        self._leaders = np.bincount(leaders.flock_of_slot)
        self._first = np.cumsum(self._leaders) - self._leaders
        self.num_envs = leaders.num_flocks
        self.pool = leaders._batch.parameters(0).pool

    def check_action_mode(self, model: Any) -> None:
        """Refuse a model that was trained with another action mode than the flocks have.

        Raises
        ------
        ParameterError
            If the model's observation space names another one.
        """
        leaders = self.venv.unwrapped
        assert isinstance(leaders, LeaderVecEnv)
        if isinstance(getattr(model, "observation_space", None), ObservationSpace):
            model = ModelPolicy(model)
        mode = leaders.action_mode
        check_action_mode(model, mode, "in this evaluation")

    def reset(self) -> Any:
        """Start episodes in all flocks; return observations, a row per leader."""
        return self.venv.reset()

    def step_wait(self) -> tuple[Any, NDArray[Any], NDArray[Any], list[dict[str, Any]]]:
        """Return observations, a row per leader, and rewards, ends and infos, one per flock."""
        observations, rewards, dones, infos = self.venv.step_wait()
        means = np.add.reduceat(rewards, self._first) / self._leaders
        return observations, means, dones[self._first], [infos[slot] for slot in self._first]

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Any = None) -> list[bool]:
        """Return, for each flock, True for `Monitor`: the ``"episode"`` is in the infos."""
        wrapped = issubclass(wrapper_class, Monitor)
        return [wrapped or self.venv.env_is_wrapped(wrapper_class)[0]] * self.num_envs


@dataclass(frozen=True, slots=True, eq=False)
class FlockEvaluation:
    """Results of flocks' episodes; it prints as the mean signed order with its interval.

    Attributes
    ----------
    signed_order : float64 array, shape (episodes,)
        Mean signed order of each episode in the analysis window after its first tenth; NaN for an
        episode that ends before.
    returns : float64 array, shape (episodes,)
        Sum of the rewards of each episode, the mean over a flock's leaders.
    lengths : int64 array, shape (episodes,)
        Control steps of each episode.
    """

    signed_order: NDArray[np.float64]
    returns: NDArray[np.float64]
    lengths: NDArray[np.int64]

    @property
    def mean(self) -> float:
        """Mean signed order."""
        return float(self.signed_order.mean())

    @property
    def interval(self) -> tuple[float, float]:
        """Its interval, as of `mean_interval`, at level `flockenv.statistics.CONFIDENCE`."""
        _, low, high = mean_interval(self.signed_order)
        return low, high

    def __str__(self) -> str:
        low, high = self.interval
        count = len(self.signed_order)
        return f"signed order {self.mean:.3f} [{low:.3f}, {high:.3f}] in {count} episodes"


def evaluate_flocks(
    model: Any,
    env: VecEnv,
    n_eval_episodes: int = 64,
    deterministic: bool = True,
    *,
    seed: int | None = None,
) -> FlockEvaluation:
    """Evaluate a model as stable-baselines3's `evaluate_policy` does, but count flocks' episodes.

    Parameters
    ----------
    model
        A model or policy whose ``predict`` takes one leader's observation per row, without memory.
    env
        A `LeaderVecEnv`, also inside other wrappers. Returns are its own, whatever a wrapper does
        to rewards.
    n_eval_episodes
        Number of flocks' episodes, dealt out to the flocks as evenly as possible.
    deterministic
        Whether actions are the most probable ones.
    seed
        Seed of the first flock, as in ``LeaderVecEnv.seed``; None: the next episodes.

    Returns
    -------
    FlockEvaluation
        Orders, returns and lengths by episode.

    Raises
    ------
    TypeError
        If `env` is no `LeaderVecEnv`.
    ParameterError
        For a model that was trained with another action mode, or is made for another pool, and for
        no episodes.
    """
    flocks = PerFlock(env)
    flocks.check_action_mode(model)
    check_pool(model, flocks.pool)
    if whole(n_eval_episodes, "n_eval_episodes") < 1:
        raise ParameterError(f"n_eval_episodes = {n_eval_episodes} is not accepted: at least 1")
    if seed is not None:
        flocks.seed(seed)
    orders: list[float] = []

    def keep(step: dict[str, Any], _: dict[str, Any]) -> None:
        if step["done"]:
            orders.append(step["info"]["episode_summary"].get("signed_order", np.nan))

    returns, lengths = evaluate_policy(
        model, flocks, n_eval_episodes, deterministic, callback=keep, return_episode_rewards=True
    )
    return FlockEvaluation(np.array(orders), np.array(returns), np.array(lengths))


class FlockEvalCallback(EvalCallback):
    """stable-baselines3's `EvalCallback` on a `LeaderVecEnv`, with episodes of flocks.

    It prints what `evaluate_flocks` does, and logs the mean as ``eval/signed_order``. The last
    evaluation is in `evaluation`.

    Parameters
    ----------
    eval_env
        A `LeaderVecEnv`. In `VecNormalize` wrap it as ``VecNormalize(PerFlock(venv))``.
    seed
        Each evaluation starts with this seed of the first flock, so that models meet the same
        flocks; None: each continues with the next episodes.
    options
        All others of `EvalCallback`; ``n_eval_episodes`` counts flocks.

    Raises
    ------
    TypeError
        If `eval_env` is no `LeaderVecEnv`.
    """

    def __init__(self, eval_env: VecEnv, *, seed: int | None = None, **options: Any) -> None:
        counted = any(isinstance(each, PerFlock) for each in _layers(eval_env))
        super().__init__(eval_env if counted else PerFlock(eval_env), **options)
        self.seed = None if seed is None else whole(seed, "seed")
        self.evaluation: FlockEvaluation | None = None
        self._ended: list[tuple[float, float, int]] = []

    def _init_callback(self) -> None:
        with warnings.catch_warnings():
            # The types differ by `PerFlock` on purpose.
            warnings.filterwarnings("ignore", "Training and eval env are not of the same type")
            super()._init_callback()
        for each in _layers(self.eval_env):
            if isinstance(each, PerFlock):
                each.check_action_mode(self.model)

    def _on_step(self) -> bool:
        if self.seed is not None:
            self.eval_env.seed(self.seed)
        self._ended.clear()
        before, verbose, self.verbose = self.best_mean_reward, self.verbose, 0
        try:
            goes_on = super()._on_step()
        finally:
            self.verbose = verbose
        if self._ended:
            self.evaluation = FlockEvaluation(*map(np.array, zip(*self._ended, strict=True)))
            if self.verbose >= 1:
                best = ", the best return so far" if self.best_mean_reward > before else ""
                print(f"{self.num_timesteps} steps: {self.evaluation}{best}")  # noqa: T201
        return goes_on

    def _log_success_callback(self, locals_: dict[str, Any], globals_: dict[str, Any]) -> None:
        super()._log_success_callback(locals_, globals_)
        if locals_["done"]:
            info = locals_["info"]
            order = info["episode_summary"].get("signed_order", np.nan)
            self._ended.append((order, info["episode"]["r"], info["episode"]["l"]))
            self.logger.record("eval/signed_order", np.mean([each[0] for each in self._ended]))


def _layers(env: VecEnv) -> list[VecEnv]:
    layers = [env]
    while isinstance(layers[-1], VecEnvWrapper):
        layers.append(layers[-1].venv)
    return layers
