"""Evaluation of models on a `LeaderVecEnv` that counts episodes of flocks, not of leaders."""

import copy
import math
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BufferedIOBase
from pathlib import Path
from typing import Any, TypeGuard, cast

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.callbacks import EvalCallback
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper, VecNormalize

from flockenv._io.arguments import as_int
from flockenv._io.array_file import read_arrays
from flockenv._io.atomic_write import atomic_write
from flockenv._io.plain_file import check_writable
from flockenv.envs.spaces import POLICY_OPTIONS, ObservationSpace, differing_options
from flockenv.errors import ParameterError, short_repr
from flockenv.policies import ModelPolicy, Policy
from flockenv.policies.model import lacks_normalizing, normalizing, space_under_wrappers
from flockenv.sb3.leader_vec_env import LeaderVecEnv
from flockenv.statistics import mean_interval

_BEST = "best_model.zip"


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
        self.leaders = leaders

    def reset(self) -> Any:
        """Start episodes in all flocks; return observations, a row per leader."""
        return self.venv.reset()

    def step_wait(self) -> tuple[Any, NDArray[Any], NDArray[Any], list[dict[str, Any]]]:
        """Return observations, a row per leader, and rewards, ends and infos, one per flock."""
        observations, rewards, dones, infos = self.venv.step_wait()
        means = np.add.reduceat(rewards, self._first) / self._leaders
        return observations, means, dones[self._first], [infos[slot] for slot in self._first]

    def env_is_wrapped(self, wrapper_class: type[Any], indices: object = None) -> list[bool]:
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


class _AsTrained:
    """A model that acts on what `PerFlock` returns as it acted in its training.

    Observations are normalized as there, and a recurrent model learns of the start of an episode
    for each leader.
    """

    def __init__(self, model: object, flocks: VecEnv, leaders: LeaderVecEnv) -> None:
        self.model = _unwrapped(model)
        self._flock_of_row = leaders.flock_of_slot
        own, layers = normalizing(self.model), _normalizing_layers(flocks)
        theirs = [each for each in layers if each.norm_obs]
        if not layers and lacks_normalizing(self.model):
            raise ParameterError(
                f"{short_repr(self.model)} was trained in VecNormalize and loaded without it: "
                "evaluate "
                "it in VecNormalize.load(..., env), which has how observations were normalized"
            )
        if theirs and own is None and getattr(self.model, "env", None) is not None:
            raise ParameterError(
                f"{short_repr(self.model)} was trained on observations that are not normalized: "
                "evaluate it without VecNormalize"
            )
        normalized: Any = theirs[0].obs_rms if theirs else None
        shape = normalized.mean.shape if theirs else flocks.observation_space.shape
        if own is not None and own.obs_rms.mean.shape != shape:
            raise ParameterError(
                f"{short_repr(self.model)} was trained on normalized observations of shape "
                f"{own.obs_rms.mean.shape}, not {shape}: evaluate it in wrappers in the same order"
            )
        if own is not None:
            for each in theirs:
                _follow(own, each)
        self._normalizing = None if theirs else own

    def predict(
        self,
        observation: object,
        state: object = None,
        episode_start: object = None,
        **options: object,
    ) -> tuple[Any, Any]:
        """Return the model's actions; `episode_start` has an entry for each flock."""
        if self._normalizing is not None:
            observation = self._normalizing.normalize_obs(observation)
        if episode_start is not None:
            episode_start = np.asarray(episode_start)[self._flock_of_row]
        found: tuple[Any, Any] = self.model.predict(
            observation, state=state, episode_start=episode_start, **options
        )
        return found


@contextmanager
def _unchanged_statistics(flocks: VecEnv) -> Iterator[None]:
    """Let no `VecNormalize` learn from an evaluation, which may be on the training's own flocks."""
    layers = _normalizing_layers(flocks)
    learned = [each.training for each in layers]
    for each in layers:
        each.training = False
    try:
        yield
    finally:
        for each, training in zip(layers, learned, strict=True):
            each.training = training


def _normalizing_layers(flocks: VecEnv) -> list[VecNormalize]:
    return [each for each in _layers(flocks) if isinstance(each, VecNormalize)]


def _follow(training: VecNormalize, own: VecNormalize) -> None:
    """Let a `VecNormalize` normalize as the training's does."""
    own.obs_rms, own.ret_rms = copy.deepcopy((training.obs_rms, training.ret_rms))
    own.clip_obs, own.epsilon = training.clip_obs, training.epsilon


def _unwrapped(model: object) -> Any:
    """Return the model of a `ModelPolicy`, which normalizes too and turns levels into rudders."""
    # One in a wrapper of its own makes what the model observes.
    return model.model if type(model) is ModelPolicy else model


def _check_task(model: Any, flocks: VecEnv, leaders: LeaderVecEnv) -> None:
    """Refuse a model that was trained on observations or actions of another meaning."""
    model = _unwrapped(model)
    own_policy = Policy.from_source(model)
    own_policy.check_pool(leaders._batch.parameters(0).pool)
    space, options = getattr(model, "observation_space", None), leaders.observation_space.options
    # A wrapper may make a space that says nothing of its meaning, or keep another flock's.
    known = [each for each in (space, space_under_wrappers(model)) if _says_meaning(each)]
    for each in known:
        _check_options(model, each.policy_options(), options)
    if not known:
        own_policy.check_action_mode(leaders.action_mode, "in this evaluation")
        said = {name: getattr(model, name, None) for name in POLICY_OPTIONS}
        said = {name: value for name, value in said.items() if value is not None}
        # A policy does not depend on options that it does not name.
        _check_options(model, said, {name: options[name] for name in said})
    spaces = {"observation": (space, flocks.observation_space)}
    spaces["action"] = (getattr(model, "action_space", None), flocks.action_space)
    for kind, (own, other) in spaces.items():
        if own is not None and own != other:
            raise ParameterError(
                f"{short_repr(model)} is not accepted in these flocks: its {kind} space is {own}, "
                f"not {other}"
            )


def _says_meaning(space: object) -> TypeGuard[ObservationSpace]:
    return isinstance(space, ObservationSpace)


def _check_options(model: object, said: dict[str, Any], options: dict[str, Any]) -> None:
    """Refuse flocks with other options than those that a model is made for."""
    if differing := differing_options(said, options):
        raise ParameterError(
            f"{short_repr(model)} is not accepted in these flocks: "
            + ", ".join(
                f"it is made for {name} = {own!r}, not {other!r}"
                for name, (own, other) in differing.items()
            )
        )


def evaluate_flocks(
    model: object,
    env: VecEnv,
    n_eval_episodes: int = 64,
    deterministic: bool = True,
    *,
    seed: int | None = None,
) -> FlockEvaluation:
    """Evaluate a model as stable-baselines3's `evaluate_policy` does, but count flocks' episodes.

    A model that was trained in `VecNormalize` gets observations that are normalized as there, also
    if `env` is a plain `LeaderVecEnv`. If `env` is in a `VecNormalize` of its own, that takes
    statistics, ``clip_obs`` and ``epsilon`` of the training's.

    Parameters
    ----------
    model
        A model or policy whose ``predict`` takes one leader's observation per row, such as ``PPO``
        or ``RecurrentPPO``.
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
        For a model that was trained with other options that a policy depends on (such as
        ``mirror_to_target`` or ``control_hz``), or is made for another pool, or was trained in a
        `VecNormalize` that it is loaded without, and for no episodes.
    """
    episodes = as_int(n_eval_episodes, "n_eval_episodes")
    if episodes < 1:
        raise ParameterError(f"n_eval_episodes = {n_eval_episodes} is not accepted: at least 1")
    counted = _per_flock(env)
    trained = _trained(model, counted)
    if seed is not None:
        counted.seed(as_int(seed, "seed"))
    return _evaluated(trained, counted, episodes, deterministic)


def _per_flock(env: VecEnv) -> VecEnv:
    """Return an environment that counts flocks."""
    return env if any(isinstance(each, PerFlock) for each in _layers(env)) else PerFlock(env)


def _trained(model: object, flocks: VecEnv) -> _AsTrained:
    """Return a model as it acts in flocks whose task is that of its training."""
    (leaders,) = (each.leaders for each in _layers(flocks) if isinstance(each, PerFlock))
    _check_task(model, flocks, leaders)
    return _AsTrained(model, flocks, leaders)


def _evaluated(
    model: _AsTrained,
    flocks: VecEnv,
    episodes: int,
    deterministic: bool,
    render: bool = False,
    keep: Callable[[dict[str, Any], dict[str, Any]], None] = lambda *_: None,
) -> FlockEvaluation:
    orders: list[float] = []

    def kept(step: dict[str, Any], everything: dict[str, Any]) -> None:
        keep(step, everything)
        if step["done"]:
            orders.append(step["info"]["episode_summary"].get("signed_order", np.nan))

    with _unchanged_statistics(flocks):
        returns, lengths = evaluate_policy(
            cast(Any, model),
            flocks,
            episodes,
            deterministic,
            render,
            callback=kept,
            return_episode_rewards=True,
        )
    return FlockEvaluation(np.array(orders), np.array(returns), np.array(lengths))


class FlockEvalCallback(EvalCallback):
    """stable-baselines3's `EvalCallback` on a `LeaderVecEnv`, with episodes of flocks.

    It prints what `evaluate_flocks` does, and logs the mean as ``eval/signed_order``. The best
    model is the one with the highest mean signed order; if episodes end before the analysis window,
    that with the highest mean return. The file ``evaluations.npz`` has the signed orders as
    ``signed_order``, beside the returns. A training that goes on (``reset_num_timesteps=False``)
    goes on with the file, and with its best.

    Parameters
    ----------
    eval_env
        A `LeaderVecEnv`, also in wrappers. Observations are normalized as in the training.
    seed
        Each evaluation starts with this seed of the first flock, so that models meet the same
        flocks; None: each continues with the next episodes.
    options
        All others of `EvalCallback`; ``n_eval_episodes`` counts flocks.

    Attributes
    ----------
    evaluation : FlockEvaluation or None
        The last evaluation.
    best_signed_order : float
        Mean signed order of the best model; NaN before the first evaluation.

    Raises
    ------
    TypeError
        If `eval_env` is no `LeaderVecEnv`.
    ParameterError
        Before the training, for flocks whose options are not those of the training, as
        `evaluate_flocks`, and for a file with another number of episodes to go on with.
    OSError
        Before the training, for files that are protected against writing.
    """

    def __init__(self, eval_env: VecEnv, *, seed: int | None = None, **options: Any) -> None:
        super().__init__(_per_flock(eval_env), **options)
        self.n_eval_episodes = as_int(self.n_eval_episodes, "n_eval_episodes")
        if self.n_eval_episodes < 1:
            raise ParameterError(
                f"n_eval_episodes = {self.n_eval_episodes} is not accepted: at least 1"
            )
        self.seed = None if seed is None else as_int(seed, "seed")
        self.evaluation: FlockEvaluation | None = None
        self.best_signed_order = math.nan
        self._evaluations_order: list[list[float]] = []

    def _init_callback(self) -> None:
        with warnings.catch_warnings():
            # The types differ by `PerFlock` on purpose.
            warnings.filterwarnings("ignore", "Training and eval env are not of the same type")
            super()._init_callback()
        _trained(self.model, self.eval_env)
        if self.log_path is not None:
            check_writable(f"{self.log_path}.npz")
        if self.best_model_save_path is not None:
            check_writable(Path(self.best_model_save_path, _BEST))
        if self.model.num_timesteps > 0 and not self._evaluations_order:
            self._go_on()

    def _go_on(self) -> None:
        """Take over the evaluations of a training that goes on."""
        path = None if self.log_path is None else Path(f"{self.log_path}.npz")
        if path is None or not path.is_file():
            return
        stored = read_arrays(path)
        before = stored["timesteps"] <= self.model.num_timesteps
        parts = {name: values[before] for name, values in stored.items()}
        episodes = parts["results"].shape[1]
        if episodes != self.n_eval_episodes:
            raise ParameterError(
                f"n_eval_episodes = {self.n_eval_episodes} is not accepted: {path} goes on, which "
                f"has {episodes} episodes in each evaluation"
            )
        self.evaluations_timesteps = parts["timesteps"].tolist()
        self.evaluations_results = parts["results"].tolist()
        self.evaluations_length = parts["ep_lengths"].tolist()
        unknown = np.full(parts["results"].shape, np.nan)
        self._evaluations_order = parts.get("signed_order", unknown).tolist()
        for orders, returns in zip(self._evaluations_order, self.evaluations_results, strict=True):
            self._is_best(float(np.mean(orders)), float(np.mean(returns)))

    def _on_step(self) -> bool:
        if self.eval_freq <= 0 or self.n_calls % self.eval_freq != 0:
            return True
        if self.seed is not None:
            self.eval_env.seed(self.seed)
        self._is_success_buffer = []
        found = self.evaluation = _evaluated(
            _trained(self.model, self.eval_env),
            self.eval_env,
            self.n_eval_episodes,
            self.deterministic,
            self.render,
            self._log_success_callback,
        )
        self._store(found)
        self._log(found)
        self.last_mean_reward = float(found.returns.mean())
        is_best = self._is_best(found.mean, self.last_mean_reward)
        if self.verbose >= 1:
            best = ", the best so far" if is_best else ""
            print(f"{self.num_timesteps} steps: {found}{best}")  # noqa: T201
        goes_on = True
        if is_best:
            if self.best_model_save_path is not None:
                with atomic_write(Path(self.best_model_save_path, _BEST)) as file:
                    self.model.save(cast(BufferedIOBase, file))
            if self.callback_on_new_best is not None:
                goes_on = self.callback_on_new_best.on_step()
        return goes_on and (self.callback is None or self._on_event())

    def _is_best(self, order: float, mean_return: float) -> bool:
        """Return whether a model is the best so far, and remember it."""
        if math.isnan(order) and math.isnan(self.best_signed_order):
            is_best = mean_return > self.best_mean_reward
        else:
            is_best = math.isnan(self.best_signed_order) or order > self.best_signed_order
        if is_best:
            self.best_signed_order, self.best_mean_reward = order, mean_return
        return is_best

    def _store(self, found: FlockEvaluation) -> None:
        self.evaluations_timesteps.append(self.num_timesteps)
        self.evaluations_results.append(found.returns.tolist())
        self.evaluations_length.append(found.lengths.tolist())
        self._evaluations_order.append(found.signed_order.tolist())
        if self._is_success_buffer:
            self.evaluations_successes.append(self._is_success_buffer)
        if self.log_path is not None:
            columns: dict[str, Any] = {
                "timesteps": self.evaluations_timesteps,
                "results": self.evaluations_results,
                "ep_lengths": self.evaluations_length,
                "signed_order": self._evaluations_order,
            }
            if self.evaluations_successes:
                columns["successes"] = self.evaluations_successes
            with atomic_write(f"{self.log_path}.npz") as file:
                np.savez(file, **columns)

    def _log(self, found: FlockEvaluation) -> None:
        self.logger.record("eval/signed_order", found.mean)
        self.logger.record("eval/mean_reward", float(found.returns.mean()))
        self.logger.record("eval/mean_ep_length", float(found.lengths.mean()))
        if self._is_success_buffer:
            self.logger.record("eval/success_rate", np.mean(self._is_success_buffer))
        # So that the evaluation is logged with its own number of steps.
        self.logger.record("time/total_timesteps", self.num_timesteps, exclude="tensorboard")
        self.logger.dump(self.num_timesteps)


def _layers(env: VecEnv) -> list[VecEnv]:
    layers = [env]
    while isinstance(layers[-1], VecEnvWrapper):
        layers.append(layers[-1].venv)
    return layers
