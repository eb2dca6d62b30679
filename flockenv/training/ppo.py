"""The training run: PPO of stable-baselines3, checkpoints, validations, the best policy."""

import math
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import torch
from stable_baselines3.common.logger import KVWriter, Logger, TensorBoardOutputFormat
from stable_baselines3.common.utils import FloatSchedule

from flockenv._io.atomic_write import write_text
from flockenv._io.interrupts import held_interrupts
from flockenv._io.locks import held
from flockenv._io.provenance import provenance_of
from flockenv.errors import ParameterError
from flockenv.policies import NetworkPolicy, load
from flockenv.training import checkpoint
from flockenv.training.actor import (
    actor_module,
    copy_into_actor,
    measure_features,
    network_policy,
    one_thread,
)
from flockenv.training.checkpoint import LEARNED, Progress
from flockenv.training.cloning import initial_policy
from flockenv.training.learner import Learner, Watch, actor_of, learner
from flockenv.training.rollback_point import RollbackPoint
from flockenv.training.settings import TrainingError, TrainingSettings
from flockenv.training.validation import validation_scores

__all__ = ["TrainingResult", "resume", "stored_settings", "train"]

Report = Callable[[Progress], None]

# The log is written here, after an update instead of before the next.
_NEVER = 1 << 62


@dataclass(frozen=True)
class TrainingResult:
    """What a run left: the best policy by validation, and how it came about.

    Attributes
    ----------
    policy
        The best mean policy, as in ``best.npz``.
    settings
        What it was trained with.
    progress
        Samples, seconds, learning curve and validations.
    folder
        Where everything is: ``best.npz``, ``last.npz``, ``checkpoint.npz``, ``settings.toml``,
        ``curve.csv``, ``validations.csv`` and, if it is installed, what tensorboard shows.
    """

    policy: NetworkPolicy
    settings: TrainingSettings
    progress: Progress
    folder: Path


def train(
    settings: TrainingSettings,
    folder: Path,
    *,
    command: str = "",
    report: Report = lambda progress: None,
    trust: bool = False,
) -> TrainingResult:
    """Train a policy into an empty folder.

    The same settings give the same policy, bit for bit on a CPU.

    Parameters
    ----------
    settings
        What to train, and how.
    folder
        Where to write.
    command
        Provenance, stored in the policies' ``made``.
    report
        Called after each rollout.
    trust
        Whether the ``.zip`` file of a model to start from may execute the code in it; see
        `flockenv.policies.load`.

    Raises
    ------
    ParameterError
        If the folder holds a run already, for a policy to start from that does not fit, and for a
        model's file without `trust`.
    InUseError
        If another training is at work in the folder.
    TrainingError
        If the loss is not finite or a file cannot be written; the last checkpoint is intact.
    """
    folder = Path(folder)
    _refuse_another_run(folder)
    with one_thread():
        model = learner(settings)
        start = initial_policy(settings, command, trust)
        if start is None:
            measure_features(actor_module(actor_of(model))[0], settings)
        else:
            copy_into_actor(start, actor_of(model), settings)
        with _alone_in(folder):
            _refuse_another_run(folder)
            with _written(folder, Progress()):
                write_text(folder / "settings.toml", settings.to_toml())
                if start is not None:
                    start.save(folder / "start.npz")
            return _Run(model, settings, folder, Progress(command), report).advance()


def _refuse_another_run(folder: Path) -> None:
    if (folder / "checkpoint.npz").exists():
        raise ParameterError(f"{folder} holds a run already: resume it, or name another folder")


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """Make a folder and hold it: two trainings at once would mix their files."""
    with ExitStack() as stack:
        with _written(folder, Progress()):
            folder.mkdir(parents=True, exist_ok=True)
            stack.enter_context(held(folder / ".lock", str(folder)))
        yield


def resume(
    folder: Path,
    *,
    samples: int | None = None,
    flock_hours: float | None = None,
    report: Report = lambda progress: None,
) -> TrainingResult:
    """Continue from a run's last checkpoint, exactly as if it had never stopped.

    Parameters
    ----------
    folder
        What was given to `train`. Loading its checkpoint executes nothing.
    samples, flock_hours
        When to stop, if not as in the settings: one or the other.
    report
        As for `train`.

    Raises
    ------
    ParameterError
        If there is no checkpoint, or a damaged one.
    InUseError
        If another training is at work in the folder.
    TrainingError
        As for `train`.
    """
    folder = Path(folder)
    stored_settings(folder, samples, flock_hours)
    with _alone_in(folder), one_thread():
        settings = stored_settings(folder, samples, flock_hours)
        model = learner(settings)
        progress = checkpoint.restore(folder / "checkpoint.npz", model)
        return _Run(model, settings, folder, progress, report).advance()


def stored_settings(
    folder: Path, samples: int | None = None, flock_hours: float | None = None
) -> TrainingSettings:
    """Return what `resume` continues with; see there."""
    path = Path(folder) / "checkpoint.npz"
    if not path.exists():
        raise ParameterError(f"{folder} holds no checkpoint to resume")
    settings = checkpoint.read_settings(path)
    given = {"samples": samples, "flock_hours": flock_hours}
    limits = {name: value for name, value in given.items() if value is not None}
    return settings.replace(**limits) if limits else settings


class _Run:
    """One run from where its model and progress are to its last sample."""

    def __init__(
        self,
        model: Learner,
        settings: TrainingSettings,
        folder: Path,
        progress: Progress,
        report: Report,
    ) -> None:
        self.model, self.settings, self.folder = model, settings, folder
        self.progress, self.report = progress, report
        self.started_s = time.perf_counter() - progress.wall_s
        self.log = Logger(None, [])
        self.rollback_point: RollbackPoint | None = None

    def advance(self) -> TrainingResult:
        formats: list[KVWriter] = []
        if find_spec("tensorboard") is not None:
            with held_interrupts(), _written(self.folder, self.progress):
                formats = [TensorBoardOutputFormat(str(self.folder / "tensorboard"))]
        self.log = Logger(None, formats)
        self.model.set_logger(self.log)
        self.report(self.progress)
        try:
            while self.progress.samples < self.settings.total_samples:
                self._iterate()
            if self.progress.best_score is None:  # resumed, to stop before any validation
                self._validate()
        except KeyboardInterrupt:
            with held_interrupts():
                self._write_rollback_point()
            raise
        finally:
            # A full disk that cut the logs has been reported already, or hides nothing else.
            with held_interrupts(), suppress(OSError):
                self.log.close()
        best = _network(self.folder / "best.npz")
        return TrainingResult(best, self.settings, self.progress, self.folder)

    def _iterate(self) -> None:
        settings, progress = self.settings, self.progress
        before = progress.samples
        row = self._rollout_and_update()
        progress.samples = self.model.num_timesteps
        progress.wall_s = time.perf_counter() - self.started_s
        progress.curve.append({"samples": progress.samples, **row})
        self._log()
        ends = progress.samples >= settings.total_samples
        late = progress.samples >= settings.validate_from * settings.total_samples

        def due(every: int) -> bool:
            return ends or progress.samples // every > before // every

        if ends or (late and due(settings.validate_every)):
            self._validate()
        # An interrupt in the middle of the next rollout goes back to here.
        self.rollback_point = RollbackPoint.of(self.model, settings, progress, self._policy({}))
        if due(settings.checkpoint_every) or due(settings.validate_every):
            self._write_rollback_point()
        self.report(progress)

    def _rollout_and_update(self) -> dict[str, float]:
        settings, model = self.settings, self.model
        model.lr_schedule = FloatSchedule(settings.learning_rate_at(model.num_timesteps))
        wanted = settings.rollout_samples
        try:
            with held_interrupts() as release:
                watch = Watch(release)
                model.learn(wanted, watch, log_interval=_NEVER, reset_num_timesteps=False)
        except ValueError as error:
            # Torch's distributions refuse the first NaN before the loss is seen.
            if self._finite():
                raise
            raise self._broken(math.nan) from error
        loss = float(self.log.name_to_value["train/loss"])
        if not (math.isfinite(loss) and self._finite()):
            raise self._broken(loss)
        model.update_average()
        for name, value in watch.means().items():
            self.log.record(f"rollout/{name}", value)
        learned = {name: float(self.log.name_to_value[f"train/{name}"]) for name in LEARNED}
        return {**watch.means(), **learned}

    def _finite(self) -> bool:
        return all(bool(torch.isfinite(each).all()) for each in self.model.policy.parameters())

    def _broken(self, loss: float) -> TrainingError:
        return TrainingError(
            f"the loss is {loss} after {self.progress.samples} samples: try a lower learning_rate "
            f"or max_grad_norm; {_last_good(self.folder)}"
        )

    def _validate(self) -> None:
        policy = self._policy(self._provenance(self.progress))
        scores = validation_scores(policy, self.settings)
        score = sum(scores.values()) / len(scores)
        for name, value in {**scores, "mean": score}.items():
            self.log.record(f"validation/{name}", value)
        self._log()
        row = {"samples": self.progress.samples, "mean": score, **scores}
        self.progress.validations.append(row)
        if self.progress.best_score is None or score > self.progress.best_score:
            policy.provenance["validation"] = f"{score:.4f}"
            with _written(self.folder, self.progress):
                policy.save(self.folder / "best.npz")
            self.progress.best_score = score

    def _log(self) -> None:
        with held_interrupts(), _written(self.folder, self.progress):
            try:
                self.log.dump(self.progress.samples)
            except KeyboardInterrupt:
                # A second one, in the writing itself: closing that might wait for ever.
                self.log = Logger(None, [])
                raise

    def _policy(self, provenance: dict[str, str]) -> NetworkPolicy:
        return network_policy(self.model.mean_actor(), self.settings, provenance)

    def _provenance(self, progress: Progress) -> dict[str, str]:
        return provenance_of(
            progress.command,
            seed=self.settings.seed,
            samples=progress.samples,
            wall_s=progress.wall_s,
            flock_hours=self.settings.flock_hours_at(progress.samples),
        )

    def _write_rollback_point(self) -> None:
        if self.rollback_point is not None:
            self.rollback_point.policy.provenance.update(
                self._provenance(self.rollback_point.progress)
            )
            with _written(self.folder, self.rollback_point.progress):
                self.rollback_point.write(self.folder)
            self.rollback_point = None


def _network(path: Path) -> NetworkPolicy:
    found = load(path)
    if not isinstance(found, NetworkPolicy):
        raise ParameterError(f"{path} is a {found!r}, not a network")
    return found


@contextmanager
def _written(folder: Path, progress: Progress) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise TrainingError(
            f"{folder} cannot be written to after {progress.samples} samples: {error}; "
            f"{_last_good(folder)}"
        ) from error


def _last_good(folder: Path) -> str:
    path = folder / "checkpoint.npz"
    return f"the last good checkpoint is {path}" if path.exists() else "there is no checkpoint yet"
