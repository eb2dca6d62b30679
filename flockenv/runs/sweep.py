"""Sweeps: runs over grids of parameters and seeds, resumable, as one table.

`docs/runs.md` describes the TOML file of a sweep. Its parameters have the names of the fields of
`FlockParameters`. In a grid even a single value is a list, and all grids name the same fields.
"""

import itertools
import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flockenv._io.arguments import as_float
from flockenv._io.atomic_write import atomic_write, remove_leftovers, write_csv
from flockenv._io.extras import require
from flockenv._io.toml import read_toml_file
from flockenv.errors import FlockError, ParameterError, refuse_unknown, short_repr
from flockenv.flock import STEP_STATISTICS
from flockenv.order import QUANTITIES
from flockenv.parameters import FlockParameters
from flockenv.policies.names import EVERY_SUBSTEP
from flockenv.recording import Recording
from flockenv.runs.executors import Engine, threads
from flockenv.runs.spec import RunSpec
from flockenv.runs.store import RUNS_FOLDER, RunStore, StorageError, run_missing
from flockenv.statistics import critical_noise

if TYPE_CHECKING:
    import pandas as pd

MOST_RUNS = 1_000_000
"""Largest number of runs of a sweep. More are probably a mistake; otherwise split the sweep."""

_KEYS = ("preset", "minutes", "seeds", "sample_hz", "policy", "keep", "fixed", "grid")
_AVERAGED = tuple(quantity.name for quantity in QUANTITIES if quantity.is_averaged)
_COLUMNS = (
    "frames",
    *(f"{name}_{kind}" for name in _AVERAGED for kind in ("mean", "std")),
    "rotation_size",
    *STEP_STATISTICS,
    "failure",
)


@dataclass(frozen=True, slots=True)
class SweepSpec:
    """A checked sweep.

    Attributes
    ----------
    axes : tuple of str
        The fields that vary, in the file's order.
    runs : tuple of RunSpec
        One run per combination and seed, in the order of combinations, then seeds.
    """

    axes: tuple[str, ...]
    runs: tuple[RunSpec, ...]


def read_sweep(path: str | os.PathLike[str]) -> SweepSpec:
    """Read a sweep's file, and check every value.

    Raises ParameterError for a file that cannot be read or is not TOML, for unknown keys and fields
    (with the nearest name), for axes that are not lists, and for values that `FlockParameters` or
    `RunSpec` refuse.
    """
    values = read_toml_file(path, str(path))
    try:
        return _parse(values)
    except (FlockError, TypeError) as error:
        raise ParameterError(f"{path}: {error}") from error


def _parse(values: Mapping[str, object]) -> SweepSpec:
    """Return the checked sweep of a file's values."""
    parameter_names = FlockParameters.__dataclass_fields__
    for key in values:
        if key not in _KEYS and key in parameter_names:
            raise ParameterError(
                f"{key!r} is not a key of a sweep: it is a field of the parameters, which belongs "
                "under [fixed] or [[grid]]"
            )
    refuse_unknown(values, _KEYS, "key of a sweep")
    fixed, grids, seeds = values.get("fixed", {}), _grids(values), _seeds(values.get("seeds"))
    if not isinstance(fixed, dict):
        raise ParameterError(f"fixed = {short_repr(fixed)} is not accepted: a table [fixed]")
    _check_pools([fixed.get("pool")], "[130, 70]")
    axes = tuple(grids[0])
    for name in axes:
        if name in fixed:
            raise ParameterError(f"{name!r} is both under [fixed] and in a grid")
    refuse_unknown([*fixed, *axes], parameter_names, "field of FlockParameters")
    count = len(seeds) * sum(math.prod(map(len, grid.values())) for grid in grids)
    if count > MOST_RUNS:
        raise ParameterError(f"the sweep has {count} runs; at most {MOST_RUNS} are accepted")
    # All fields are set at once: `replace` would scale a fixed radius of gyration with the hull,
    # and fixed fields need not fit the preset's values of those that vary.
    base = {"preset": values.get("preset", "simulation"), **fixed}
    flocks = dict.fromkeys(
        FlockParameters.from_dict(base | dict(zip(axes, point, strict=True)))
        for grid in grids
        for point in itertools.product(*(grid[axis] for axis in axes))
    )
    return SweepSpec(axes, _runs(values, tuple(flocks), seeds))


def _runs(
    values: Mapping[str, object], flocks: Sequence[FlockParameters], seeds: Sequence[int]
) -> tuple[RunSpec, ...]:
    """Return a run for each flock and seed, with the duration, policy and so on of the file."""
    led_run: dict[str, Any] = {
        "duration_s": 60.0 * _number("minutes", values.get("minutes")),
        "sample_hz": _number("sample_hz", values.get("sample_hz", 10)),
        **{name: values[name] for name in ("policy", "keep") if name in values},
    }
    # In a sweep of led flocks, those without leaders are for comparison: they take no policy.
    has_leaders = any(flock.n_leaders for flock in flocks)
    leaderless_run = led_run | {"policy": EVERY_SUBSTEP} if has_leaders else led_run
    return tuple(
        RunSpec(parameters=flock, seed=seed, **(led_run if flock.n_leaders else leaderless_run))
        for flock in flocks
        for seed in seeds
    )


def _grids(values: Mapping[str, object]) -> list[dict[str, list[object]]]:
    """Return the checked grids of a sweep's file: lists of values by field."""
    grids = values.get("grid")
    grids = [grids] if isinstance(grids, dict) else grids
    if not isinstance(grids, list) or not grids or not all(isinstance(g, dict) for g in grids):
        raise ParameterError("grid is missing: a table [[grid]] of fields and lists of values")
    for grid in grids:
        for name, axis in grid.items():
            if not isinstance(axis, list) or not axis:
                raise ParameterError(
                    f"{name} = {short_repr(axis)} is not accepted in a grid: a list of one or more "
                    "values (a field that does not vary belongs under [fixed])"
                )
        _check_pools(grid.get("pool", []), '[[130, 70], "wide"]')
        if grid.keys() != grids[0].keys():
            different = ", ".join(sorted(grid.keys() ^ grids[0].keys()))
            raise ParameterError(f"all grids must name the same fields; these differ: {different}")
    return grids


def _check_pools(pools: list[object], example: str) -> None:
    """Refuse pools that are a single number, or a text with numbers such as "130x70"."""
    for pool in pools:
        is_text = isinstance(pool, str) and any(map(str.isdigit, pool))
        if is_text or isinstance(pool, int | float):
            raise ParameterError(
                f"pool = {short_repr(pool)} is not accepted: a name, or outer and inner radius in "
                f"cm, as in pool = {example}"
            )


def _seeds(seeds: object) -> tuple[int, ...]:
    """Return the seeds of a list, or 0 to n - 1 for a number n."""
    if isinstance(seeds, int) and not isinstance(seeds, bool) and 1 <= seeds <= MOST_RUNS:
        return tuple(range(seeds))
    if isinstance(seeds, list) and seeds and len(set(map(repr, seeds))) == len(seeds):
        return tuple(seeds)
    raise ParameterError(
        f"seeds = {short_repr(seeds)} is not accepted: how many (1 to {MOST_RUNS}), or a list of "
        "different seeds"
    )


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ParameterError(f"{name} = {short_repr(value)} is not accepted: a number")
    return as_float(value)


def summary(run: Recording) -> dict[str, float]:
    """Return means and standard deviations over the analyzed frames of a run.

    Returns
    -------
    dict
        ``frames``, the number of analyzed frames (analysis window, after the first tenth);
        ``<name>_mean`` and ``<name>_std`` of each averaged quantity of the table: Ψ_o, C_o, Ψ_v
        (cm/s), C_v (cm²/s²), the nematic order, milling, the signed order and the rotation m =
        Ψ_o·sin φ_o. ``rotation_size`` is the mean of ``|m|``, which does not cancel if a flock
        reverses its rotation. Frames in which a quantity is undefined are left out of its mean; if
        all are, the mean is NaN. The last entries are the run's ``worst_overlap_cm``, ``unsolved``
        and ``halved_substeps``, NaN if they are unknown.
    """
    used = run.analyzed()
    row: dict[str, float] = {"frames": len(used)}
    for name in _AVERAGED:
        series = used.order.series(name, run.parameters.target)
        series = series[np.isfinite(series)]
        row[f"{name}_mean"] = float(series.mean()) if len(series) else np.nan
        row[f"{name}_std"] = float(series.std()) if len(series) else np.nan
    rotation = used.order.rotation()
    rotation = rotation[np.isfinite(rotation)]
    row["rotation_size"] = float(abs(rotation).mean()) if len(rotation) else np.nan
    return row | {name: getattr(run.statistics, name, np.nan) for name in STEP_STATISTICS}


def run_sweep(
    sweep: SweepSpec,
    folder: str | os.PathLike[str],
    engine: Engine = threads,
    progress: Callable[[RunSpec], None] = lambda spec: None,
    notify: Callable[[str], None] | None = None,
    workers: int | None = None,
) -> "pd.DataFrame":
    """Make the runs of a sweep that a folder lacks, and write its table.

    Writes ``sweep.csv`` and ``sweep.parquet``, and keeps finished runs in ``runs/``. Without the
    extra ``plot`` nothing is run.

    Parameters
    ----------
    sweep
        The sweep, from `read_sweep`.
    folder
        Folder for the runs and the table.
    notify
        See `RunStore`.
    engine, progress, workers
        See `run_missing`, whose errors this raises.

    Returns
    -------
    pandas.DataFrame
        The table, as from `load_sweep`.
    """
    pandas = require("pandas", "plot")
    require("pyarrow", "plot")
    remove_leftovers(folder)
    folder = Path(folder)
    runs = folder / RUNS_FOLDER
    store = RunStore(runs, notify) if notify else RunStore(runs)
    failures = run_missing(sweep.runs, store, engine, progress, workers)
    rows = []
    for spec in sweep.runs:
        fields = {name: _as_cell(getattr(spec.parameters, name)) for name in sweep.axes}
        run, failure = store.load(spec), str(failures.get(spec, ""))
        if run is None and not failure:
            raise FlockError(f"{store.path(spec)} has been lost since it was written")
        means: dict[str, float] = {"frames": 0} if run is None else summary(run)
        rows.append({**fields, "seed": spec.seed, **means, "failure": failure})
    table: pd.DataFrame = pandas.DataFrame(rows, columns=[*sweep.axes, "seed", *_COLUMNS])
    try:
        folder.mkdir(parents=True, exist_ok=True)  # No run made it if all failed.
        write_csv(folder / "sweep.csv", table)
        with atomic_write(folder / "sweep.parquet") as file:
            table.to_parquet(file, index=False)
    except OSError as error:
        raise StorageError(f"{folder} cannot be written: {error.strerror or error}") from error
    return table


def _as_cell(value: object) -> object:
    """Return tuples as text, and other values unchanged.

    A pool is a name or two radii, and a target is one word or several, but a column of Parquet has
    one type.
    """
    if not isinstance(value, tuple):
        return value
    if all(isinstance(item, str) for item in value):
        return ",".join(value)
    if all(isinstance(item, float) for item in value):
        return "x".join(f"{radius:g}" for radius in value)
    return repr(value)


def critical_noises(table: "pd.DataFrame") -> "pd.DataFrame":
    """Return the noise at which each flock of a sweep loses its order.

    Parameters
    ----------
    table
        The table of `run_sweep` or `load_sweep`. Failed runs are left out.

    Returns
    -------
    pandas.DataFrame
        One row per combination of the varied fields except ``bw_s``: these fields,
        ``critical_bw_s`` of `flockenv.statistics.critical_noise` with the ends of its interval,
        ``critical_bw_s_low`` and ``critical_bw_s_high`` in s, and the largest mean
        ``rotation_size`` of any noise. The noises are NaN if the flock has no order to lose, or if
        a noise has fewer than three runs. No rows if the sweep has fewer than two noises.
    """
    pandas = require("pandas", "plot")
    runs = table[table["failure"] == ""]
    fields = [name for name in table.columns[: table.columns.get_loc("seed")] if name != "bw_s"]
    names = ("critical_bw_s", "critical_bw_s_low", "critical_bw_s_high")
    rows = []
    if "bw_s" in table and runs["bw_s"].nunique() > 1:
        # If only the noise varies, all runs are of one flock.
        for values, flock_runs in runs.groupby(fields) if fields else [((), runs)]:
            levels = np.sort(flock_runs["bw_s"].unique())
            by_noise = flock_runs[["bw_s", "psi_o_mean", "rotation_size"]].groupby("bw_s")
            if len(levels) > 1:
                runs_of_noises = [noise_runs.drop(columns="bw_s") for _, noise_runs in by_noise]
                critical = critical_noise(levels, runs_of_noises)
                row = dict(zip(fields, values, strict=True))
                row |= dict(zip(names, critical, strict=True))
                rows.append(row | {"rotation_size": by_noise["rotation_size"].mean().max()})
    result: pd.DataFrame = pandas.DataFrame(rows, columns=[*fields, *names, "rotation_size"])
    return result


def load_sweep(path: str | os.PathLike[str]) -> "pd.DataFrame":
    """Read the table of a sweep.

    Parameters
    ----------
    path
        The folder, or its ``sweep.parquet``.

    Returns
    -------
    pandas.DataFrame
        One row per run: the varied fields (a pool without a name as "180x97", a list of targets as
        "cw,cw,ccw"), ``seed``, the columns of `summary`, and ``failure``: the error of a failed
        run, otherwise empty.

    Raises
    ------
    ParameterError
        If it is missing or incomplete.
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
        raise ParameterError(f"{file} is not a table of a sweep: {error}") from error
    if not {"seed", "frames", "failure"} <= set(table):
        raise ParameterError(f"{file} is not a table of a sweep")
    return table


def to_xarray(table: "pd.DataFrame") -> object:
    """Return the table of a sweep as an `xarray.Dataset` over its fields and seeds.

    Combinations that no grid has are NaN. Raises MissingExtraError without the extra ``sweep``.
    """
    require("xarray", "sweep")
    axes = [*table.columns[: table.columns.get_loc("seed")], "seed"]
    return table.set_index(axes).to_xarray()
