"""Finished runs on disk, each a recording named by the hash of its spec, so that work resumes."""

import math
import os
import warnings
from collections.abc import Callable, Iterable
from contextlib import closing
from pathlib import Path

import numpy as np

from flockenv import _core
from flockenv._io.arguments import as_int, check_function, items
from flockenv._io.atomic_write import remove_leftovers
from flockenv._io.interrupts import end_if_interrupted
from flockenv.errors import FlockError, ParameterError
from flockenv.recording import LayoutError, Recording
from flockenv.recording.checks import ORIGIN
from flockenv.runs.executors import Engine, finished, threads
from flockenv.runs.spec import RunSpec, execute

RUNS_FOLDER = "runs"
"""Folder of finished runs, inside a folder of results."""

RESULTS_VERSION = 8
"""Rises when the same specs give other numbers than before; stored runs are then made again."""


class StorageError(FlockError, OSError):
    """A folder or file cannot be written; earlier finished runs are kept."""


class StoreWarning(UserWarning):
    """A stored run could not be used; its file was renamed, and the run is made again."""


def _warn(message: str) -> None:
    warnings.warn(message, StoreWarning, stacklevel=3)


class RunStore:
    """A folder of finished runs, each a recording's file that is written whole or not at all.

    A run lies in ``<version>/<first two digits>/<key>.npz`` (see `RunSpec.key`), where the version
    is that of flockenv and `RESULTS_VERSION`: runs of other versions count as missing.

    Parameters
    ----------
    folder
        The folder. It is created with the first run.
    notify
        Called with a line of text for each damaged file. It is renamed to end in ``.damaged``, and
        its run counts as missing. By default a `StoreWarning`.
    """

    def __init__(
        self, folder: str | os.PathLike[str], notify: Callable[[str], None] = _warn
    ) -> None:
        self.folder = Path(folder)
        self._notify = notify

    def path(self, spec: RunSpec) -> Path:
        """Return where the run of a spec is or would be stored."""
        version = f"{_core.__version__}-{RESULTS_VERSION}"
        return self.folder / version / spec.key[:2] / f"{spec.key}.npz"

    def save(self, spec: RunSpec, run: Recording) -> None:
        """Store the finished run of a spec.

        Raises StorageError if the run cannot be written, for example to a full disk.
        """
        path = self.path(spec)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            run.save(path, compressed=True)
        except OSError as error:
            raise StorageError(
                f"{path} cannot be written ({error.strerror or error}); the runs finished before "
                "are stored, and the same command resumes from them"
            ) from error

    def load(self, spec: RunSpec) -> Recording | None:
        """Return the stored run of a spec, or None if there is none that can be used.

        Raises StorageError for a file that can neither be read nor renamed, and ParameterError for
        an undamaged file that lacks an array or has another format; that file is left unchanged.
        """
        path = self.path(spec)
        if not path.exists():
            return None
        try:
            run = Recording.load(path)
            if difference := _difference(run, spec):
                raise ParameterError(f"{path} holds another run than its name says: {difference}")
        except LayoutError:
            raise
        except ParameterError as error:
            aside = path.with_suffix(".damaged")
            path.replace(aside)
            self._notify(f"{error}; it is done again, and the old file is now {aside}")
            return None
        except OSError as error:
            raise StorageError(f"{path} cannot be read: {error.strerror or error}") from error
        return run


def _difference(run: Recording, spec: RunSpec) -> str | None:
    """Return how a recording differs from the run of a spec; None if it is that run."""
    step_s, kept = 1.0 / spec.sample_hz, spec.keep
    gap_s = float(np.diff(run.time_s).min()) if len(run) > 1 else step_s
    # A shorter window may hold no two successive samples.
    window_s = math.inf if kept != "window" else 0.5 * (run.parameters.fw_s + run.parameters.nop1_s)
    is_sampled = np.allclose(run.time_s, step_s * np.round(run.time_s / step_s), rtol=0, atol=1e-8)
    is_sampled &= abs(gap_s - step_s) < 1e-8 or step_s > 0.5 * window_s
    is_whole = kept == "window" or len(run) == int(spec.duration_s * spec.sample_hz + 1e-6) + 1
    differs = {
        "other parameters": run.parameters != spec.parameters,
        f"seed {run.seed}, not {spec.seed}": run.seed != spec.seed,
        f"{run.duration_s:g} s, not {spec.duration_s:g} s": run.duration_s != spec.duration_s,
        f"a policy {run.policy}, not {spec.policy}": run.policy != spec.checked_policy.name,
        **{f"{name} {getattr(run, name)}": getattr(run, name) is not None for name in ORIGIN},
        f"other samples than {spec.sample_hz:g} per second": not is_sampled,
        f"not what {kept!r} keeps": run.has_poses != (kept == "poses")
        or not (is_whole and (kept != "window" or run.in_analysis_window.all())),
    }
    return next((words for words, does in differs.items() if does), None)


def run_missing(
    specs: Iterable[RunSpec],
    store: RunStore,
    engine: Engine = threads,
    progress: Callable[[RunSpec], None] = lambda spec: None,
    workers: int | None = None,
) -> dict[RunSpec, FlockError]:
    """Make the runs that are missing from the store, and store each as soon as it is finished.

    Parameters
    ----------
    specs
        The runs; repeated ones are made once. Expensive ones start first.
    store
        Where finished runs are stored. A full disk ends the work and loses only the runs in
        progress. So does Ctrl-C, except in a command, which waits for them.
    engine
        Where to run, one of `flockenv.runs.executors.ENGINES`, or another function that makes an
        executor. The results are the same on each.
    progress
        Called with each spec once its run is in the store.
    workers
        How many runs at a time, all cores by default.

    Returns
    -------
    dict
        The errors of the runs that failed; all others are in the store.

    Raises
    ------
    StorageError
        If a finished run cannot be written.
    """
    check_function(progress, "progress")
    if workers is not None and as_int(workers, "workers") < 1:
        raise ParameterError(f"workers = {workers} is not accepted: at least 1")
    missing = []
    specs = items(specs, "specs")
    remove_leftovers(store.folder, within=True)
    for spec in dict.fromkeys(specs):
        if store.load(spec) is None:
            missing.append(spec)
        else:
            progress(spec)
    missing.sort(key=lambda spec: -spec.cost)
    failures = {}
    with closing(finished(_attempt, missing, workers, engine)) as outcomes:
        for index, outcome in outcomes:
            if isinstance(outcome, Recording):
                store.save(missing[index], outcome)
            else:
                failures[missing[index]] = outcome
            progress(missing[index])
    end_if_interrupted()
    return failures


def _attempt(spec: RunSpec) -> Recording | FlockError:
    # One run that fails must not cost the others.
    try:
        return execute(spec)
    except FlockError as error:
        # Keeping the partial run of each error would fill a sweep's memory.
        vars(error).pop("recording", None)
        return error
