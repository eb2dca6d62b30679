"""Recordings as tables of pandas and datasets of xarray."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.extras import require
from flockenv.order import ORDER, RECORDED
from flockenv.recording.checks import MOTION, ORIGIN, TIMES

if TYPE_CHECKING:
    import pandas
    import xarray


def table_of(recording: Any, boats: bool) -> "pandas.DataFrame":
    """Return the table that `Recording.to_dataframe` documents."""
    dataframe: type[pandas.DataFrame] = require("pandas", "plot").DataFrame
    columns: dict[str, NDArray[Any]] = {name: getattr(recording, name) for name in TIMES}
    if not boats:
        columns |= {name: getattr(recording.order, name) for name in ORDER}
        return dataframe(columns | dict(recording.quantities))
    count = recording.pose.shape[1]
    columns = {name: np.repeat(values, count) for name, values in columns.items()}
    columns["boat"] = np.tile(np.arange(count), len(recording))
    columns["is_leader"] = columns["boat"] < recording.parameters.n_leaders
    if recording.ids is not None:
        columns["id"] = np.tile(recording.ids, len(recording))
    columns |= {name: values.ravel() for name, values in _motion(recording).items()}
    present = ~np.isnan(columns["x_cm"])
    return dataframe({name: values[present] for name, values in columns.items()})


def dataset_of(recording: Any) -> "xarray.Dataset":
    """Return a recording as `Recording.to_xarray` documents."""
    dataset: type[xarray.Dataset] = require("xarray", "sweep").Dataset
    boats = np.arange(recording.pose.shape[1])
    by_time = {name: getattr(recording, name) for name in TIMES[1:]}
    by_time |= {name: getattr(recording.order, name) for name in ORDER}
    by_time |= recording.quantities
    units = {quantity.name: quantity.unit or "1" for quantity in RECORDED} | MOTION
    attributes = {name: {"units": units[name]} for name in units}
    variables: dict[str, Any] = {
        name: ("time_s", values, attributes.get(name)) for name, values in by_time.items()
    }
    variables |= {
        name: (("time_s", "boat"), values, attributes[name])
        for name, values in _motion(recording).items()
    }
    dtypes = {"policy": np.dtype(np.str_), **ORIGIN}
    origin = {name: (getattr(recording, name), dtype) for name, dtype in dtypes.items()}
    is_leader = ("boat", boats < recording.parameters.n_leaders)
    return dataset(
        variables,
        {
            "time_s": ("time_s", recording.time_s, {"units": "s"}),
            "boat": boats,
            "is_leader": is_leader,
            **({} if recording.ids is None else {"id": ("boat", recording.ids)}),
        },
        {
            "seed": np.uint64(recording.seed),
            "version": recording.version,
            "parameters": recording.parameters.to_toml(),
            **{
                name: dtype.type(value)
                for name, (value, dtype) in origin.items()
                if value is not None
            },
        },
    )


def _motion(recording: Any) -> dict[str, NDArray[np.floating[Any]]]:
    """Return poses and velocities by component, each (t, n)."""
    columns = (*np.moveaxis(recording.pose, -1, 0), *np.moveaxis(recording.velocity, -1, 0))
    return dict(zip(MOTION, columns, strict=True))
