"""`FlockEvalCallback`: evaluation of flocks while a model learns."""

import math
import warnings
from io import BufferedIOBase
from pathlib import Path
from typing import Any, cast

import numpy as np
from stable_baselines3.common.callbacks import EvalCallback
from stable_baselines3.common.vec_env import VecEnv

from flockenv._io.arguments import as_int
from flockenv._io.array_file import read_arrays
from flockenv._io.atomic_write import atomic_write
from flockenv._io.plain_file import check_writable
from flockenv.errors import ParameterError
from flockenv.sb3.as_trained import as_trained
from flockenv.sb3.evaluation import FlockEvaluation, run_evaluation
from flockenv.sb3.per_flock import per_flock

_BEST = "best_model.zip"


class FlockEvalCallback(EvalCallback):
    """stable-baselines3's `EvalCallback` on a `LeaderVecEnv`, with episodes of flocks.

    It prints the result of `evaluate_flocks`, and logs the mean as ``eval/signed_order``. The best
    model is the one with the highest mean signed order or, if episodes end before the analysis
    window, the highest mean return. The file ``evaluations.npz`` has the signed orders as
    ``signed_order``, beside the returns. A continued training (``reset_num_timesteps=False``)
    appends to the file, and replaces the best model only by a better one.

    Parameters
    ----------
    eval_env
        A `LeaderVecEnv`, possibly in wrappers. Observations are normalized as in the training.
    seed
        Seed of the first flock at each evaluation, so that all models lead the same flocks. None
        continues with the next episodes.
    options
        All other arguments of `EvalCallback`; ``n_eval_episodes`` counts flocks.

    Attributes
    ----------
    evaluation : FlockEvaluation or None
        The last evaluation.
    best_signed_order : float
        Mean signed order of the best model; NaN before the first evaluation.

    Raises
    ------
    TypeError
        If `eval_env` is not a `LeaderVecEnv`.
    ParameterError
        Before the training, for flocks whose options differ from the training's (see
        `evaluate_flocks`), and for an existing file with another number of episodes per evaluation.
    OSError
        Before the training, for files that are protected against writing.
    """

    def __init__(self, eval_env: VecEnv, *, seed: int | None = None, **options: Any) -> None:
        super().__init__(per_flock(eval_env), **options)
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
            # `PerFlock` makes the types differ, on purpose.
            warnings.filterwarnings("ignore", "Training and eval env are not of the same type")
            super()._init_callback()
        as_trained(self.model, self.eval_env)  # Only for its errors, before the training.
        if self.log_path is not None:
            check_writable(f"{self.log_path}.npz")
        if self.best_model_save_path is not None:
            check_writable(Path(self.best_model_save_path, _BEST))
        if self.model.num_timesteps > 0 and not self._evaluations_order:
            self._resume()

    def _resume(self) -> None:
        """Read the evaluations before a continued training from the file, if there is one."""
        path = None if self.log_path is None else Path(f"{self.log_path}.npz")
        if path is None or not path.is_file():
            return
        stored = read_arrays(path)
        # A training may continue from a model that was saved before the last evaluations.
        is_before = stored["timesteps"] <= self.model.num_timesteps
        columns = {name: values[is_before] for name, values in stored.items()}
        episodes = columns["results"].shape[1]
        if episodes != self.n_eval_episodes:
            raise ParameterError(
                f"n_eval_episodes = {self.n_eval_episodes} is not accepted: {path}, which this "
                f"training continues, has {episodes} episodes in each evaluation"
            )
        self.evaluations_timesteps = columns["timesteps"].tolist()
        self.evaluations_results = columns["results"].tolist()
        self.evaluations_length = columns["ep_lengths"].tolist()
        if "successes" in columns:
            self.evaluations_successes = columns["successes"].tolist()
        unknown = np.full(columns["results"].shape, np.nan)
        self._evaluations_order = columns.get("signed_order", unknown).tolist()
        for orders, returns in zip(self._evaluations_order, self.evaluations_results, strict=True):
            self._update_best(float(np.mean(orders)), float(np.mean(returns)))

    def _on_step(self) -> bool:
        if self.eval_freq <= 0 or self.n_calls % self.eval_freq != 0:
            return True
        if self.seed is not None:
            self.eval_env.seed(self.seed)
        self._is_success_buffer = []
        evaluation = self.evaluation = run_evaluation(
            as_trained(self.model, self.eval_env),
            self.eval_env,
            self.n_eval_episodes,
            self.deterministic,
            self.render,
            self._log_success_callback,
        )
        self._store(evaluation)
        self._log(evaluation)
        self.last_mean_reward = float(evaluation.returns.mean())
        is_best = self._update_best(evaluation.mean, self.last_mean_reward)
        if self.verbose >= 1:
            best = ", the best so far" if is_best else ""
            print(f"{self.num_timesteps} steps: {evaluation}{best}")  # noqa: T201
        goes_on = True
        if is_best:
            if self.best_model_save_path is not None:
                with atomic_write(Path(self.best_model_save_path, _BEST)) as file:
                    self.model.save(cast(BufferedIOBase, file))
            if self.callback_on_new_best is not None:
                goes_on = self.callback_on_new_best.on_step()
        return goes_on and (self.callback is None or self._on_event())

    def _update_best(self, order: float, mean_return: float) -> bool:
        """Store the order and the return of a model if it is the best so far.

        Return whether it is.
        """
        if math.isnan(order) and math.isnan(self.best_signed_order):
            is_best = mean_return > self.best_mean_reward
        else:
            is_best = math.isnan(self.best_signed_order) or order > self.best_signed_order
        if is_best:
            self.best_signed_order, self.best_mean_reward = order, mean_return
        return is_best

    def _store(self, evaluation: FlockEvaluation) -> None:
        self.evaluations_timesteps.append(self.num_timesteps)
        self.evaluations_results.append(evaluation.returns.tolist())
        self.evaluations_length.append(evaluation.lengths.tolist())
        self._evaluations_order.append(evaluation.signed_order.tolist())
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

    def _log(self, evaluation: FlockEvaluation) -> None:
        self.logger.record("eval/signed_order", evaluation.mean)
        self.logger.record("eval/mean_reward", float(evaluation.returns.mean()))
        self.logger.record("eval/mean_ep_length", float(evaluation.lengths.mean()))
        if self._is_success_buffer:
            self.logger.record("eval/success_rate", np.mean(self._is_success_buffer))
        # Dumped now, so that the log shows the steps at this evaluation.
        self.logger.record("time/total_timesteps", self.num_timesteps, exclude="tensorboard")
        self.logger.dump(self.num_timesteps)
