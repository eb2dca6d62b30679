"""Sweeps: any grid of parameters and seeds, resumable, as one table."""

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flockenv._io.atomic_write import atomic_write, write_csv
from flockenv._io.extras import require
from flockenv.errors import FlockError, ParameterError
from flockenv.order import QUANTITIES
from flockenv.recording import Recording
from flockenv.runs.executors import Engine, local
from flockenv.runs.spec import RunSpec
from flockenv.runs.store import RUNS_FOLDER, RunStore, StorageError, run_missing
from flockenv.runs.sweep_spec import SweepSpec

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["load_sweep", "run_sweep", "summary", "to_xarray"]

_AVERAGED = tuple(each.name for each in QUANTITIES if each.is_averaged)


def summary(run: Recording) -> dict[str, float]:
    """Return means and standard deviations over the analyzed frames of a run.

    Returns
    -------
    dict
        ``frames``, how many there are (analysis window, after the first tenth); ``<name>_mean`` and
        ``<name>_std`` of each averaged quantity of the table: Ψ_o, C_o, Ψ_v (cm/s), C_v (cm²/s²),
        the nematic order, milling, the signed order towards the target and the rotation
        Ψ_o·sin φ_o. NaN where undefined.
    """
    used = run.analyzed()
    order, target = used.order, run.parameters.target
    row: dict[str, float] = {"frames": len(used)}
    for name in _AVERAGED:
        series = order.series(name, target)
        row[f"{name}_mean"] = float(series.mean()) if len(series) else np.nan
        row[f"{name}_std"] = float(series.std()) if len(series) else np.nan
    return row


def run_sweep(
    sweep: SweepSpec,
    folder: str | os.PathLike[str],
    engine: Engine = local,
    progress: Callable[[RunSpec], None] = lambda spec: None,
    notify: Callable[[str], None] | None = None,
    workers: int | None = None,
) -> "pd.DataFrame":
    """Make the runs of a sweep that a folder lacks, and write its table.

    Writes ``sweep.csv`` and ``sweep.parquet``, and keeps finished runs in ``runs/``.

    Parameters
    ----------
    sweep
        Of `read_sweep`.
    folder
        Where.
    engine
        Where to run, one of `flockenv.runs.executors.ENGINES`.
    progress
        Called with each spec once its run is there.
    notify
        See `RunStore`.
    workers
        How many runs at a time; every core that this process may use by default.

    Returns
    -------
    pandas.DataFrame
        The table, see `load_sweep`.

    Raises
    ------
    MissingExtraError
        Without the extra ``plot``; nothing is run then.
    StorageError
        If files cannot be written.
    """
    pandas = require("pandas", "plot")
    require("pyarrow", "plot")
    folder = Path(folder)
    runs = folder / RUNS_FOLDER
    store = RunStore(runs, notify) if notify else RunStore(runs)
    failures = run_missing(sweep.runs, store, engine, progress, workers)
    table: pd.DataFrame = pandas.DataFrame(
        [
            {**_point(sweep, spec), "seed": spec.seed, **_outcome(spec, store, failures)}
            for spec in sweep.runs
        ]
    )
    _write(table, folder)
    return table


def _point(sweep: SweepSpec, spec: RunSpec) -> dict[str, Any]:
    values = {name: getattr(spec.parameters, name) for name in sweep.axes}
    return {
        name: _one_word(value) if isinstance(value, tuple) else value
        for name, value in values.items()
    }


def _one_word(value: tuple[Any, ...]) -> str:
    # A pool is a name or a pair of radii, a target a word or several: a column of both would be of
    # no type.
    if all(isinstance(each, str) for each in value):
        return ",".join(value)
    if all(isinstance(each, float) for each in value):
        return "x".join(f"{radius:g}" for radius in value)
    return repr(value)


def _outcome(
    spec: RunSpec, store: RunStore, failures: Mapping[RunSpec, FlockError]
) -> dict[str, Any]:
    if spec in failures:
        missing = {f"{name}_{kind}": np.nan for name in _AVERAGED for kind in ("mean", "std")}
        return {"frames": 0, **missing, "failure": str(failures[spec])}
    run = store.load(spec)
    if run is None:
        raise FlockError(f"{store.path(spec)} has been lost since it was written")
    return {**summary(run), "failure": ""}


def _write(table: "pd.DataFrame", folder: Path) -> None:
    try:
        write_csv(folder / "sweep.csv", table)
        with atomic_write(folder / "sweep.parquet") as file:
            table.to_parquet(file, index=False)
    except OSError as error:
        raise StorageError(f"{folder} cannot be written: {error.strerror or error}") from error


def load_sweep(path: str | os.PathLike[str]) -> "pd.DataFrame":
    """Read the table of a sweep.

    Parameters
    ----------
    path
        The folder, or its ``sweep.parquet``.

    Returns
    -------
    pandas.DataFrame
        One row per run: the varied fields (a pool of its own radii as "180x97", a list of targets
        as "cw,cw,ccw"), ``seed``, the columns of `summary`, and ``failure``: empty, or why there
        are no numbers.

    Raises
    ------
    ParameterError
        If it is not there or not whole.
    MissingExtraError
        Without the extra ``plot``.
    """
    pandas = require("pandas", "plot")
    pyarrow = require("pyarrow", "plot")
    path = Path(path)
    file = path / "sweep.parquet" if path.is_dir() else path
    try:
        table: pd.DataFrame = pandas.read_parquet(file)
    except (OSError, ValueError, pyarrow.ArrowException) as error:
        raise ParameterError(f"{file} is no table of a sweep: {error}") from error
    if not {"seed", "frames", "failure"} <= set(table):
        raise ParameterError(f"{file} is no table of a sweep")
    return table


def to_xarray(table: "pd.DataFrame") -> Any:
    """Return the table of a sweep as an `xarray.Dataset` over its fields and seeds.

    Combinations that no grid has are NaN.

    Raises
    ------
    MissingExtraError
        Without the extra ``sweep``.
    """
    require("xarray", "sweep")
    axes = [*table.columns[: table.columns.get_loc("seed")], "seed"]
    return table.set_index(axes).to_xarray()
