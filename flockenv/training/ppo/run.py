"""A run of PPO of stable-baselines3: checkpoints, and resuming after an interruption."""

import json
import zipfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from io import BufferedIOBase
from pathlib import Path
from typing import cast

import torch
from filelock import FileLock, Timeout
from stable_baselines3 import PPO
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import configure

from flockenv._io.atomic_write import atomic_write, remove_leftovers, write_text
from flockenv._io.interrupts import end_if_interrupted
from flockenv._io.plain_file import open_plain
from flockenv.errors import FlockError, InUseError, ParameterError, short_repr
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.sb3 import FlockMonitor, LeaderVecEnv
from flockenv.training.ppo.settings import TrainingSettings

CHECKPOINT, MODEL, SETTINGS = "checkpoint.zip", "model.zip", "settings.toml"
#: Entries of the episode summary in the monitor file.
_SUMMARY_KEYWORDS = ("signed_order", "worst_overlap_cm", "unsolved")


class TrainingError(FlockError, RuntimeError):
    """Training cannot continue. The message names the last checkpoint, which is intact."""


@dataclass(frozen=True)
class Progress:
    """Progress of a training.

    Attributes
    ----------
    samples, total
        Number of leaders' decisions so far, and at the end.
    signed_order
        Mean of the episodes that ended last, in which leaders explore; None before the first one.
    """

    samples: int
    total: int
    signed_order: float | None


Report = Callable[[Progress], object]
"""Function that takes the progress before each rollout and at the end."""


def train(settings: TrainingSettings, folder: Path, report: Report = lambda progress: None) -> PPO:
    """Train, write the files of the run into a folder, and return the model.

    The folder gets ``model.zip``, ``checkpoint.zip``, ``settings.toml``, ``0.monitor.csv`` with the
    order and overlaps of each flock's episodes, and stable-baselines3's log in ``log-0``. A resumed
    training adds a monitor file and a log, whose names have the number of samples before it instead
    of 0.

    Parameters
    ----------
    settings
        Settings of the training.
    folder
        The folder; it must hold no run.
    report
        Called before each rollout and at the end.

    Raises
    ------
    ParameterError
        If the folder holds a run already, and for options that are not accepted.
    InUseError
        If another training uses the folder.
    TrainingError
        If weights are not finite or a file cannot be written; the last checkpoint is intact.
    """
    folder = Path(folder)
    venv = settings.venv()
    model = settings.model(venv)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with _locked(folder):
            if (folder / CHECKPOINT).exists():
                raise ParameterError(
                    f"{folder} holds a run already: resume it, or name another folder"
                )
            write_text(folder / SETTINGS, settings.to_toml())
            return _advance(settings, folder, model, venv, report)
    except OSError as error:
        raise TrainingError(f"{folder} cannot be written: {error}") from error


def resume(
    folder: Path, *, flock_hours: float | None = None, report: Report = lambda progress: None
) -> PPO:
    """Continue from a folder's last checkpoint, with new flocks, and return the model.

    Weights and the optimizer's state are read from the checkpoint. No code in it is executed.

    Parameters
    ----------
    folder
        The folder of the training.
    flock_hours
        When to stop; by default as in the folder's settings.
    report
        As for `train`.

    Raises
    ------
    ParameterError
        If there is no checkpoint, or it is damaged or belongs to other settings.
    InUseError, TrainingError
        As for `train`.
    """
    folder = Path(folder)
    path, settings = folder / CHECKPOINT, stored_settings(folder, flock_hours)
    venv = settings.venv()
    model = settings.model(venv)
    with _locked(folder):
        try:
            with open_plain(path) as file:
                model.set_parameters(cast(str, file), device="cpu")
                file.seek(0)
                with zipfile.ZipFile(file) as archive:
                    samples = json.loads(archive.read("data"))["num_timesteps"]
            samples_of_rollout = model.n_steps * venv.num_envs
            if type(samples) is not int or samples < 0 or samples % samples_of_rollout:
                raise ValueError(
                    f"{short_repr(samples)} samples are not a whole number of rollouts"
                )
            model.num_timesteps = samples
        # zipfile, pickle and torch raise errors of several kinds for a damaged archive.
        except Exception as error:
            raise ParameterError(
                f"{path} is not a checkpoint of these settings: {type(error).__name__}: {error}"
            ) from error
        return _advance(settings, folder, model, venv, report)


def stored_settings(folder: Path, flock_hours: float | None = None) -> TrainingSettings:
    """Return the settings with which `resume` continues the training of a folder.

    Raises ParameterError if there is no checkpoint or the settings are not accepted.
    """
    if not (Path(folder) / CHECKPOINT).exists():
        raise ParameterError(f"{folder} holds no checkpoint to resume")
    settings = TrainingSettings.from_file(Path(folder) / SETTINGS)
    return settings if flock_hours is None else settings.replace(flock_hours=flock_hours)


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Lock a folder against other trainings; clear leftovers of killed ones."""
    try:
        lock = FileLock(folder / ".lock", blocking=False).acquire()
    except Timeout as error:
        raise InUseError(f"{folder} is in use by another process: name another, or wait") from error
    except OSError as error:
        raise TrainingError(f"{folder} cannot be locked: {error}") from error
    with lock:
        remove_leftovers(folder)
        yield


def _advance(
    settings: TrainingSettings, folder: Path, model: PPO, venv: LeaderVecEnv, report: Report
) -> PPO:
    """Train a model from its present number of samples to the number in the settings."""
    total, done = settings.samples(venv), model.num_timesteps
    rollouts = done // (model.n_steps * venv.num_envs)
    seeds = POLICY_SEEDS["training"]
    # A resumed training has new flocks: the index of their first seed depends on the rollouts.
    first_index = rollouts * venv.num_flocks % (seeds.of_a_run - venv.num_flocks)
    threads = torch.get_num_threads()
    # More threads do not speed up small networks, and sums would depend on the number of threads.
    torch.set_num_threads(1)
    try:
        with ExitStack() as stack:
            monitor = FlockMonitor(
                venv, str(folder / str(done)), _SUMMARY_KEYWORDS, override_existing=True
            )
            stack.callback(monitor.close)
            model.set_env(monitor)
            model.set_random_seed((settings.seed + rollouts) % (1 << 32))
            monitor.seed(seeds.seeds(1, settings.seed, first_index)[0])
            log = configure(str(folder / f"log-{done}"), ["csv"])
            stack.callback(log.close)
            model.set_logger(log)
            checkpoints = _Checkpoints(folder, total, report)
            if done < total:
                model.learn(total - done, checkpoints, reset_num_timesteps=done == 0)
            checkpoints.store(MODEL, model)
    except OSError as error:
        raise TrainingError(
            f"{folder} cannot be written after {model.num_timesteps} samples: {error}; "
            f"{_checkpoint_note(folder)}"
        ) from error
    except ValueError:
        # Torch's distributions raise it for NaN weights.
        _check_finite(model, folder)
        raise
    finally:
        torch.set_num_threads(threads)
    return model


class _Checkpoints(BaseCallback):
    """Stores the model and reports progress, before each rollout and at the end."""

    def __init__(self, folder: Path, total: int, report: Report) -> None:
        super().__init__()
        self.folder, self.total, self.report = folder, total, report
        #: Signed orders of the episodes that ended since the last report.
        self.orders: list[float] = []
        self.mean_order: float | None = None

    def _on_step(self) -> bool:
        end_if_interrupted()
        for info in self.locals["infos"]:
            if "episode" in info:
                self.orders.append(info["episode_summary"]["signed_order"])
        return True

    def _on_rollout_start(self) -> None:
        self.store(CHECKPOINT, self.model)

    def _on_training_end(self) -> None:
        self.store(CHECKPOINT, self.model)

    def store(self, name: str, model: BaseAlgorithm) -> None:
        """Write the model, completely or not at all, and report the progress.

        Raises
        ------
        TrainingError
            For weights that are not finite.
        """
        _check_finite(model, self.folder)
        with atomic_write(self.folder / name) as file:
            model.save(cast(BufferedIOBase, file))
        if self.orders:
            self.mean_order = sum(self.orders) / len(self.orders)
            self.orders.clear()
        self.report(Progress(model.num_timesteps, self.total, self.mean_order))


def _check_finite(model: BaseAlgorithm, folder: Path) -> None:
    """Raise TrainingError for weights that are not finite."""
    if not all(bool(torch.isfinite(weights).all()) for weights in model.policy.parameters()):
        raise TrainingError(
            f"weights are not finite after {model.num_timesteps} samples: try a lower "
            f"learning_rate or max_grad_norm; {_checkpoint_note(folder)}"
        )


def _checkpoint_note(folder: Path) -> str:
    """Return the end of an error's message, which names the last checkpoint."""
    path = folder / CHECKPOINT
    return f"the last good checkpoint is {path}" if path.exists() else "there is no checkpoint yet"
