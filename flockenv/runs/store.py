"""Finished runs on disk: recordings named by the hash of their spec, so that work resumes."""

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
from flockenv.recording import DISCARDED_SHARE, LayoutError, Recording
from flockenv.recording.checks import ORIGIN
from flockenv.runs.executors import Engine, finished, threads
from flockenv.runs.spec import RunSpec, execute

RUNS_FOLDER = "runs"
"""Folder of finished runs, inside a folder of results."""

RESULTS_VERSION = 8
"""Increased when a spec gives other numbers than before; stored runs are then made again."""


class StorageError(FlockError, OSError):
    """A folder or file cannot be written; runs finished before are kept."""


class StoreWarning(UserWarning):
    """A stored run could not be used; its file was renamed, and the run is made again."""


def _warn(message: str) -> None:
    warnings.warn(message, StoreWarning, stacklevel=3)


class RunStore:
    """A folder of finished runs, each a recording's file, written completely or not at all.

    A run is stored in ``<version>/<first two digits>/<key>.npz`` (see `RunSpec.key`). The version
    joins that of flockenv and `RESULTS_VERSION`: runs of other versions count as missing.

    Parameters
    ----------
    folder
        The folder. It is created with the first run.
    notify
        Called with a line of text for each damaged file. The file is renamed to end in
        ``.damaged``, and its run counts as missing. The default gives a `StoreWarning`.
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
        """Return the stored run of a spec, or None if it is missing or damaged.

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
            damaged = path.with_suffix(".damaged")
            try:
                path.replace(damaged)
            except OSError as failure:
                reason = failure.strerror or failure
                raise StorageError(f"{error}; it cannot be renamed: {reason}") from failure
            self._notify(f"{error}; it is done again, and the old file is now {damaged}")
            return None
        except OSError as error:
            raise StorageError(f"{path} cannot be read: {error.strerror or error}") from error
        return run


def _difference(run: Recording, spec: RunSpec) -> str | None:
    """Return how a recording differs from the run of a spec; None if it is that run."""
    step_s, keep = 1.0 / spec.sample_hz, spec.keep
    shortest_s = float(np.diff(run.time_s).min()) if len(run) > 1 else step_s
    # Two successive samples are certain only in a whole analysis window of at least two steps.
    flock, analyzed_s = spec.parameters, (1.0 - DISCARDED_SHARE) * spec.duration_s
    window_s = math.inf if keep != "window" else 0.5 * (flock.fw_s + flock.nop1_s)
    cycle_s = flock.fw_s + flock.nop1_s + flock.bw_s + flock.nop2_s
    may_lack_pairs = keep == "window" and analyzed_s < cycle_s + window_s
    may_lack_pairs |= step_s > 0.5 * window_s
    is_sampled = np.allclose(run.time_s, step_s * np.round(run.time_s / step_s), rtol=0, atol=1e-8)
    is_sampled &= abs(shortest_s - step_s) < 1e-8 or may_lack_pairs
    is_complete = keep == "window" or len(run) == int(spec.duration_s * spec.sample_hz + 1e-6) + 1
    is_window = keep != "window" or run.in_analysis_window.all()
    # A spec's run has none of the fields in `ORIGIN`, which only other runs have.
    differences = {
        "other parameters": run.parameters != spec.parameters,
        f"seed {run.seed}, not {spec.seed}": run.seed != spec.seed,
        f"{run.duration_s:g} s, not {spec.duration_s:g} s": run.duration_s != spec.duration_s,
        f"a policy {run.policy}, not {spec.policy}": run.policy != spec.checked_policy.name,
        **{f"{name} {getattr(run, name)}": getattr(run, name) is not None for name in ORIGIN},
        f"other samples than {spec.sample_hz:g} per second": not is_sampled,
        f"not what {keep!r} keeps": run.has_poses != (keep == "poses")
        or not (is_complete and is_window),
    }
    return next((difference for difference, exists in differences.items() if exists), None)


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
        progress. So does Ctrl-C, but a command of flockenv first finishes these runs.
    engine
        Where to run: one of `flockenv.runs.executors.ENGINES`, or another function that makes an
        executor. The results are the same on each.
    progress
        Called with each spec once its run is stored or has failed.
    workers
        Number of runs at a time, by default the number of cores.

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
    workers = None if workers is None else as_int(workers, "workers")
    if workers is not None and workers < 1:
        raise ParameterError(f"workers = {workers} is not accepted: at least 1")
    missing = []
    specs = items(specs, "specs")
    remove_leftovers(store.folder, recursive=True)
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
    """Make a run; return its error instead of raising it, so that the other runs go on."""
    try:
        return execute(spec)
    except FlockError as error:
        # The partial runs of many errors would fill the memory.
        vars(error).pop("recording", None)
        return error
