"""What a sweep runs: a TOML file of grids of parameters and seeds.

```toml
preset = "simulation"     # what the fields not named below are
minutes = 60              # length of a run
seeds = 4                 # 0, 1, 2, 3; or a list: [7, 8, 11]
sample_hz = 10            # may be left out: 10
protocol = "law"          # may be left out: leaders follow eq. (10)
keep = "window"           # may be left out: what the store keeps, see flockenv.runs.spec.KEEP

[fixed]                   # may be left out: fields that every run has
pool = "narrow"

[[grid]]                  # every combination of these lists
n_boats = [20]
n_leaders = [0, 4]
bw_s = [0.0, 0.2, 0.4, 0.6]

[[grid]]                  # one more grid; its runs are added
n_boats = [50]
n_leaders = [0, 10]
bw_s = [0.0, 0.2, 0.4, 0.6]
```

Fields are those of `flockenv.FlockParameters`. A field in a grid must be a list, also of one value,
and all grids must name the same fields.
"""

import itertools
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from flockenv._io.toml import read_toml_file
from flockenv.errors import FlockError, ParameterError, refuse_unknown
from flockenv.parameters import FlockParameters
from flockenv.runs.spec import RunSpec

__all__ = ["MOST_RUNS", "SweepSpec", "read_sweep"]

MOST_RUNS = 1_000_000
"""A sweep of more runs is refused: it is a mistake in a list, or needs to be split."""

_KEYS = ("preset", "minutes", "seeds", "sample_hz", "protocol", "keep", "fixed", "grid")


@dataclass(frozen=True, slots=True)
class SweepSpec:
    """A checked sweep.

    Attributes
    ----------
    axes : tuple of str
        The fields that vary, in the file's order.
    points : tuple
        The values of the axes of each combination.
    runs : tuple of RunSpec
        For each point one run a seed, in the order of points, then seeds.
    seeds : tuple of int
        The seeds of every point.
    """

    axes: tuple[str, ...]
    points: tuple[tuple[Any, ...], ...]
    runs: tuple[RunSpec, ...]
    seeds: tuple[int, ...]


def read_sweep(path: str | os.PathLike[str]) -> SweepSpec:
    """Read and check a sweep's file; every value is checked before anything runs.

    Raises
    ------
    ParameterError
        For a file that cannot be read or is no TOML, unknown keys and fields (with the nearest
        name), axes that are no lists, and values that `FlockParameters` or `RunSpec` refuse. The
        message names the file.
    """
    values = read_toml_file(path, str(path))
    try:
        return _parse(values)
    except (FlockError, TypeError) as error:
        raise ParameterError(f"{path}: {error}") from error


def _parse(values: Mapping[str, Any]) -> SweepSpec:
    for key in values:
        if key not in _KEYS and key in FlockParameters.__dataclass_fields__:
            raise ParameterError(
                f"{key!r} is no key of a sweep: it is a field of the parameters, which belongs "
                "under [fixed] or [[grid]]"
            )
    refuse_unknown(values, _KEYS, "key of a sweep")
    grids, fixed = _grids(values), values.get("fixed", {})
    if not isinstance(fixed, dict):
        raise ParameterError(f"fixed = {fixed!r} is not accepted: a table [fixed]")
    seeds, axes = _seeds(values.get("seeds")), tuple(grids[0])
    _check_axes(grids, axes, fixed)
    count = len(seeds) * sum(math.prod(map(len, grid.values())) for grid in grids)
    if count > MOST_RUNS:
        raise ParameterError(f"the sweep has {count} runs; at most {MOST_RUNS} are accepted")
    base = FlockParameters.from_dict({"preset": values.get("preset", "simulation"), **fixed})
    points = tuple(
        dict.fromkeys(
            tuple(_plain(value) for value in point)
            for grid in grids
            for point in itertools.product(*(grid[axis] for axis in axes))
        )
    )
    run = {
        "duration_s": 60.0 * _number("minutes", values.get("minutes")),
        "sample_hz": _number("sample_hz", values.get("sample_hz", 10)),
        **{name: values[name] for name in ("protocol", "keep") if name in values},
    }
    flocks = [base.replace(**dict(zip(axes, point, strict=True))) for point in points]
    runs = tuple(RunSpec(parameters=each, seed=seed, **run) for each in flocks for seed in seeds)
    return SweepSpec(axes, points, runs, seeds)


def _grids(values: Mapping[str, Any]) -> list[dict[str, list[Any]]]:
    grids = values.get("grid")
    grids = [grids] if isinstance(grids, dict) else grids
    if not isinstance(grids, list) or not grids or not all(isinstance(g, dict) for g in grids):
        raise ParameterError("grid is missing: a table [[grid]] of fields and lists of values")
    for grid in grids:
        for name, axis in grid.items():
            if not isinstance(axis, list) or not axis:
                raise ParameterError(
                    f"{name} = {axis!r} is not accepted in a grid: a list of one or more values "
                    "(a field that does not vary belongs under [fixed])"
                )
    return grids


def _check_axes(
    grids: list[dict[str, list[Any]]], axes: tuple[str, ...], fixed: Mapping[str, Any]
) -> None:
    # Unknown fields are refused here, before their values are checked.
    for name in itertools.chain(fixed, *grids):
        if name not in FlockParameters.__dataclass_fields__:
            FlockParameters.from_dict({name: None})
    for grid in grids:
        if grid.keys() != set(axes):
            different = ", ".join(sorted(grid.keys() ^ set(axes)))
            raise ParameterError(f"all grids must name the same fields; these differ: {different}")
    for name in axes:
        if name in fixed:
            raise ParameterError(f"{name!r} is both under [fixed] and in a grid")


def _seeds(seeds: Any) -> tuple[int, ...]:
    if isinstance(seeds, int) and not isinstance(seeds, bool) and 1 <= seeds <= MOST_RUNS:
        return tuple(range(seeds))
    if isinstance(seeds, list) and seeds and len(set(map(repr, seeds))) == len(seeds):
        return tuple(seeds)
    raise ParameterError(
        f"seeds = {seeds!r} is not accepted: how many (1 to {MOST_RUNS}), or a list of different "
        "seeds"
    )


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ParameterError(f"{name} = {value!r} is not accepted: a number")
    return float(value)


def _plain(value: Any) -> Any:
    # A pool may be a list of two radii, obstacles are lists of lists; points must be hashable.
    return tuple(map(_plain, value)) if isinstance(value, list) else value
