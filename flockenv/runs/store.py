"""Finished runs on disk: each stored whole under the hash of its spec, so that work resumes."""

import os
import warnings
from collections.abc import Callable, Iterable, Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv import _core
from flockenv._io.array_file import read_arrays, write_arrays
from flockenv._io.interrupts import end_if_interrupted
from flockenv.errors import FlockError, ParameterError
from flockenv.order import ORDER, OrderSeries
from flockenv.policies.registry import EVERY_SUBSTEP
from flockenv.recording import PHASES, Recording
from flockenv.runs.executors import Engine, local
from flockenv.runs.spec import RunSpec, execute

__all__ = [
    "RESULTS_VERSION",
    "RUNS_FOLDER",
    "RunStore",
    "StorageError",
    "StoreWarning",
    "columns",
    "run_missing",
]

RUNS_FOLDER = "runs"
"""Folder of finished runs, inside a folder of results."""

RESULTS_VERSION = 4
"""Rises whenever the same spec comes to give other numbers: stored runs are then redone."""

_FORMAT = "flockenv run 1"


class StorageError(FlockError, OSError):
    """A folder or file cannot be written; what was finished before is still there."""


class StoreWarning(UserWarning):
    """A stored run could not be used; it was moved aside and is done again."""


def _warn(message: str) -> None:
    warnings.warn(message, StoreWarning, stacklevel=3)


class RunStore:
    """A folder of finished runs.

    A run lies in ``<first two digits>/<key>.npz`` (see `RunSpec.key`), written under a temporary
    name and then renamed: it is there whole or not at all. With it lie the spec, the version of
    flockenv and `RESULTS_VERSION`. An hour at 10 Hz takes 0.4 MB of the analysis window, 1.3 MB of
    all samples, and the poses and velocities of 20 boats 17 MB more.

    Parameters
    ----------
    folder
        Where; made with the first run.
    notify
        Called with a line of text for each stored run that cannot be used: of another version or
        damaged. Such a file is moved to ``set_aside`` and the run counts as missing. By default a
        `StoreWarning`.
    """

    def __init__(
        self, folder: str | os.PathLike[str], notify: Callable[[str], None] = _warn
    ) -> None:
        self.folder = Path(folder)
        self._notify = notify

    def path(self, spec: RunSpec) -> Path:
        """Return where the run of a spec is or would be stored."""
        return self.folder / spec.key[:2] / f"{spec.key}.npz"

    def save(self, spec: RunSpec, run: Recording) -> None:
        """Keep the finished run of a spec.

        Raises
        ------
        StorageError
            If it cannot be written, for example to a full disk.
        """
        texts = {
            "format": _FORMAT,
            "version": _core.__version__,
            "results_version": str(RESULTS_VERSION),
            "spec": spec.to_json(),
        }
        arrays = columns(run) | {name: np.array(text) for name, text in texts.items()}
        path = self.path(spec)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_arrays(path, arrays)
        except OSError as error:
            raise StorageError(
                f"{path} cannot be written ({error.strerror or error}); the runs finished before "
                "are stored, and the same command resumes from them"
            ) from error

    def load(self, spec: RunSpec) -> Recording | None:
        """Return the stored run of a spec, or None if there is none that can be used.

        Raises
        ------
        StorageError
            If the file is there but cannot be read, for example for want of permission.
        """
        path = self.path(spec)
        if not path.exists():
            return None
        try:
            return _read(path, spec)
        except FlockError as error:
            self._set_aside(path, str(error))
            return None
        except OSError as error:
            raise StorageError(f"{path} cannot be read: {error.strerror or error}") from error

    def _set_aside(self, path: Path, reason: str) -> None:
        folder = self.folder / "set_aside"
        try:
            folder.mkdir(exist_ok=True)
            number = 1
            while (target := folder / f"{path.name}.{number}").exists():
                number += 1
            path.rename(target)
        except OSError as error:
            raise StorageError(f"{path} cannot be used ({reason}) nor moved: {error}") from error
        self._notify(f"{reason}; it is done again, and the old file is now {target}")


def _read(path: Path, spec: RunSpec) -> Recording:
    arrays = read_arrays(path)
    found = {name: _text(arrays, name) for name in ("format", "version", "results_version", "spec")}
    ours = {
        "format": _FORMAT,
        "version": _core.__version__,
        "results_version": str(RESULTS_VERSION),
    }
    for name, value in ours.items():
        if found[name] != value:
            raise ParameterError(f"{path} is of another version ({name} {found[name]!r})")
    if found["spec"] != spec.to_json():
        raise ParameterError(f"{path} holds another run than its name says")
    try:
        return _recording(spec, arrays)
    except ParameterError as error:
        raise ParameterError(f"{path} is damaged: {error}") from error


def columns(run: Recording) -> dict[str, NDArray[Any]]:
    """Return the arrays that a store keeps of a run, by name.

    They are ``time_s`` (float64), ``phase`` (uint8, its place in the cycle fw, nop1, bw, nop2),
    ``in_analysis_window``, ``order_<name>`` (float32), and ``pose`` and ``velocity`` (float32)
    where the run has them.
    """
    arrays = {
        "time_s": run.time_s,
        "phase": (run.phase[:, None] == PHASES).argmax(axis=1).astype(np.uint8),
        "in_analysis_window": run.in_analysis_window,
        **{f"order_{name}": getattr(run.order, name).astype(np.float32) for name in ORDER},
    }
    if run.has_poses:
        states = {"pose": run.pose, "velocity": run.velocity}
        arrays |= {name: array.astype(np.float32) for name, array in states.items()}
    return arrays


def _recording(spec: RunSpec, arrays: Mapping[str, NDArray[Any]]) -> Recording:
    """Return the run of a spec that has these `columns`, or raise a `ParameterError`."""
    samples = np.size(arrays.get("time_s", ()))
    none = np.zeros((samples, 0, 3), np.float32)
    single = np.dtype(np.float32)
    layout: dict[str, tuple[tuple[int, ...], np.dtype[Any]]] = {
        "time_s": ((samples,), np.dtype(np.float64)),
        "phase": ((samples,), np.dtype(np.uint8)),
        "in_analysis_window": ((samples,), np.dtype(np.bool_)),
        **{f"order_{name}": ((samples,), single) for name in ORDER},
    }
    if spec.keep == "poses":
        state = (samples, spec.parameters.n_boats, 3)
        layout |= {"pose": (state, single), "velocity": (state, single)}
    found = {name: (array.shape, array.dtype) for name, array in arrays.items()}
    if found != layout:
        names = sorted(n for n in found.keys() | layout if found.get(n) != layout.get(n))
        raise ParameterError(f"these arrays are missing, unknown or misshapen: {names}")
    if (arrays["phase"] >= len(PHASES)).any():
        raise ParameterError(f"phase is not accepted: places from 0 to {len(PHASES) - 1}")
    orders = {name: arrays[f"order_{name}"].astype(np.float64) for name in ORDER}
    return Recording(
        time_s=arrays["time_s"],
        phase=PHASES[arrays["phase"]],
        in_analysis_window=arrays["in_analysis_window"],
        pose=arrays.get("pose", none),
        velocity=arrays.get("velocity", none),
        order=OrderSeries(**orders),
        parameters=spec.parameters,
        seed=spec.seed,
        version=_core.__version__,
        policy=EVERY_SUBSTEP,
        duration_s=spec.duration_s,
    )


def _text(arrays: dict[str, NDArray[Any]], name: str) -> str:
    array = arrays.pop(name, None)
    return str(array) if array is not None and array.shape == () else ""


def run_missing(
    specs: Iterable[RunSpec],
    store: RunStore,
    engine: Engine = local,
    progress: Callable[[RunSpec], None] = lambda spec: None,
    workers: int | None = None,
) -> dict[RunSpec, FlockError]:
    """Make those runs that the store lacks, keeping each as soon as it is finished.

    Parameters
    ----------
    specs
        The runs; repeated ones are made once. Expensive ones start first.
    store
        Where finished runs are stored. A full disk ends the work, and costs only the runs under
        way; so does Ctrl-C outside of a command, which itself waits for them.
    engine
        Where to run, one of `flockenv.runs.executors.ENGINES`. The results are the same on each.
    progress
        Called with each spec once its run is there.
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
    missing = []
    for spec in dict.fromkeys(specs):
        if store.load(spec) is None:
            missing.append(spec)
        else:
            progress(spec)
    missing.sort(key=lambda spec: -spec.cost)
    failures = {}
    with closing(engine(_attempt, missing, workers)) as outcomes:
        for place, outcome in outcomes:
            if isinstance(outcome, Recording):
                store.save(missing[place], outcome)
            else:
                failures[missing[place]] = outcome
            progress(missing[place])
    end_if_interrupted()
    return failures


def _attempt(spec: RunSpec) -> Recording | FlockError:
    # One run that fails must not cost the others.
    try:
        return execute(spec)
    except FlockError as error:
        return error
