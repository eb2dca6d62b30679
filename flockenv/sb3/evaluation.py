"""Evaluation of models on a `LeaderVecEnv` by episodes of flocks, not of leaders."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecEnv

from flockenv._io.arguments import as_int
from flockenv.errors import ParameterError
from flockenv.sb3.as_trained import AsTrained, as_trained, normalizing_layers
from flockenv.sb3.per_flock import per_flock
from flockenv.statistics import mean_interval


@dataclass(frozen=True, slots=True, eq=False)
class FlockEvaluation:
    """Results of flocks' episodes; it prints as the mean signed order with its interval.

    Attributes
    ----------
    signed_order : float64 array, shape (episodes,)
        Mean signed order of each episode in the analysis window after its first tenth; NaN for an
        episode that ends before that.
    returns : float64 array, shape (episodes,)
        Sum of the rewards of each episode, the mean over a flock's leaders.
    lengths : int64 array, shape (episodes,)
        Decisions of each episode.
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
        """Interval of the mean, from `mean_interval` at level `flockenv.statistics.CONFIDENCE`."""
        _, low, high = mean_interval(self.signed_order)
        return low, high

    def __str__(self) -> str:
        low, high = self.interval
        count = len(self.signed_order)
        return f"signed order {self.mean:.3f} [{low:.3f}, {high:.3f}] in {count} episodes"


def evaluate_flocks(
    model: object,
    env: VecEnv,
    n_eval_episodes: int = 64,
    deterministic: bool = True,
    *,
    seed: int | None = None,
) -> FlockEvaluation:
    """Evaluate a model as stable-baselines3's `evaluate_policy` does, but count flocks' episodes.

    A model that was trained in `VecNormalize` gets observations that are normalized as in its
    training, even if `env` is a plain `LeaderVecEnv`. A `VecNormalize` around `env` takes over the
    training's statistics, ``clip_obs`` and ``epsilon``.

    Parameters
    ----------
    model
        A model or policy whose ``predict`` takes one leader's observation per row, such as ``PPO``
        or ``RecurrentPPO``.
    env
        A `LeaderVecEnv`, possibly inside other wrappers. Returns are sums of its own rewards, even
        if a wrapper changes rewards.
    n_eval_episodes
        Number of episodes of flocks, shared among the flocks as evenly as possible.
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
        If `env` is not a `LeaderVecEnv`.
    ParameterError
        For a model that was trained with other options (such as ``mirror_to_target`` or
        ``control_hz``), is made for another pool, or was trained in a `VecNormalize` but loaded
        without it; and for fewer than one episode.
    """
    episodes = as_int(n_eval_episodes, "n_eval_episodes")
    if episodes < 1:
        raise ParameterError(f"n_eval_episodes = {n_eval_episodes} is not accepted: at least 1")
    flocks = per_flock(env)
    model_as_trained = as_trained(model, flocks)
    if seed is not None:
        flocks.seed(as_int(seed, "seed"))
    return run_evaluation(model_as_trained, flocks, episodes, deterministic)


def run_evaluation(
    model: AsTrained,
    flocks: VecEnv,
    episodes: int,
    deterministic: bool,
    render: bool = False,
    callback: Callable[[dict[str, Any], dict[str, Any]], None] = lambda *_: None,
) -> FlockEvaluation:
    """Evaluate a model with `evaluate_policy`, which calls `callback` with its variables."""
    orders: list[float] = []

    def append_order(local_variables: dict[str, Any], global_variables: dict[str, Any]) -> None:
        callback(local_variables, global_variables)
        if local_variables["done"]:
            summary = local_variables["info"]["episode_summary"]
            orders.append(summary.get("signed_order", np.nan))

    with _unchanged_statistics(flocks):
        returns, lengths = evaluate_policy(
            model,
            flocks,
            episodes,
            deterministic,
            render,
            callback=append_order,
            return_episode_rewards=True,
        )
    return FlockEvaluation(np.array(orders), np.array(returns), np.array(lengths))


@contextmanager
def _unchanged_statistics(flocks: VecEnv) -> Iterator[None]:
    """Keep the statistics of every `VecNormalize`: the flocks may be the training's own."""
    layers = normalizing_layers(flocks)
    were_training = [layer.training for layer in layers]
    for layer in layers:
        layer.training = False
    try:
        yield
    finally:
        for layer, was_training in zip(layers, were_training, strict=True):
            layer.training = was_training
