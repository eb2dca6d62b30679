"""The training run: PPO of stable-baselines3, checkpoints, and resuming after a kill."""

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
#: Numbers that are logged for each episode.
_SUMMARY = ("signed_order", "worst_overlap_cm", "unsolved")


class TrainingError(FlockError, RuntimeError):
    """Training cannot continue; the last checkpoint is intact, and the message names it."""


@dataclass(frozen=True)
class Progress:
    """Progress of a training.

    Attributes
    ----------
    samples, total
        Number of leaders' decisions so far, and at the end.
    signed_order
        Mean of the last episodes, in which leaders explore; None before the first episode ends.
    """

    samples: int
    total: int
    signed_order: float | None


Report = Callable[[Progress], object]


def train(settings: TrainingSettings, folder: Path, report: Report = lambda progress: None) -> PPO:
    """Train into an empty folder, and return the model.

    The folder gets ``model.zip``, ``checkpoint.zip``, ``settings.toml``, ``0.monitor.csv`` with the
    order and overlaps of each flock's episodes, and stable-baselines3's log in ``log-0``. After a
    resume, names have the number of samples so far instead of 0.

    Parameters
    ----------
    settings
        Settings of the training.
    folder
        Where to write.
    report
        Called before each rollout and at the end.

    Raises
    ------
    ParameterError
        If the folder holds a run already, and for options that are not accepted.
    InUseError
        If another training is at work in the folder.
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

    Weights and the optimizer are read from the checkpoint, which executes nothing in it.

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
                    done = json.loads(archive.read("data"))["num_timesteps"]
            if type(done) is not int or done < 0 or done % (model.n_steps * venv.num_envs):
                raise ValueError(f"{short_repr(done)} samples are not a whole number of rollouts")
            model.num_timesteps = done
        # zipfile, pickle and torch raise errors of several kinds for a damaged archive.
        except Exception as error:
            raise ParameterError(
                f"{path} is not a checkpoint of these settings: {type(error).__name__}: {error}"
            ) from error
        return _advance(settings, folder, model, venv, report)


def stored_settings(folder: Path, flock_hours: float | None = None) -> TrainingSettings:
    """Return the settings that `resume` continues with, and raise its errors."""
    if not (Path(folder) / CHECKPOINT).exists():
        raise ParameterError(f"{folder} holds no checkpoint to resume")
    settings = TrainingSettings.from_file(Path(folder) / SETTINGS)
    return settings if flock_hours is None else settings.replace(flock_hours=flock_hours)


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Lock a folder against other trainings."""
    try:
        held = FileLock(folder / ".lock", blocking=False).acquire()
    except Timeout as error:
        raise InUseError(f"{folder} is in use by another process: name another, or wait") from error
    except OSError as error:
        raise TrainingError(f"{folder} cannot be locked: {error}") from error
    with held:
        remove_leftovers(folder)
        yield


def _advance(
    settings: TrainingSettings, folder: Path, model: PPO, venv: LeaderVecEnv, report: Report
) -> PPO:
    """Train a model from its current number of samples to the total."""
    total, done = settings.samples(venv), model.num_timesteps
    rollouts = done // (model.n_steps * venv.num_envs)
    seeds = POLICY_SEEDS["training"]
    first = rollouts * venv.num_flocks % (seeds.of_a_run - venv.num_flocks)
    threads = torch.get_num_threads()
    # More threads do not speed up small networks, and sums would depend on their number.
    torch.set_num_threads(1)
    try:
        with ExitStack() as stack:
            monitor = FlockMonitor(venv, str(folder / str(done)), _SUMMARY, override_existing=True)
            stack.callback(monitor.close)
            model.set_env(monitor)
            model.set_random_seed((settings.seed + rollouts) % (1 << 32))
            monitor.seed(seeds.seeds(1, settings.seed, first)[0])
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
            f"{_last_good(folder)}"
        ) from error
    except ValueError:
        # Torch's distributions refuse the first NaN.
        _check_finite(model, folder)
        raise
    finally:
        torch.set_num_threads(threads)
    return model


class _Checkpoints(BaseCallback):
    """Stores the model before each rollout."""

    def __init__(self, folder: Path, total: int, report: Report) -> None:
        super().__init__()
        self.folder, self.total, self.report = folder, total, report
        self.orders: list[float] = []
        self.last: float | None = None

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
        """Write the model, whole or not at all.

        Raises
        ------
        TrainingError
            For weights that are not finite.
        """
        _check_finite(model, self.folder)
        with atomic_write(self.folder / name) as file:
            model.save(cast(BufferedIOBase, file))
        if self.orders:
            self.last = sum(self.orders) / len(self.orders)
            self.orders.clear()
        self.report(Progress(model.num_timesteps, self.total, self.last))


def _check_finite(model: BaseAlgorithm, folder: Path) -> None:
    if not all(bool(torch.isfinite(weights).all()) for weights in model.policy.parameters()):
        raise TrainingError(
            f"weights are not finite after {model.num_timesteps} samples: try a lower "
            f"learning_rate or max_grad_norm; {_last_good(folder)}"
        )


def _last_good(folder: Path) -> str:
    path = folder / CHECKPOINT
    return f"the last good checkpoint is {path}" if path.exists() else "there is no checkpoint yet"
