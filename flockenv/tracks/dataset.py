"""Datasets of the package `movement` as tables; they hold poses or boxes."""

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.tracks.formats import CM, recognized
from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.table import listed

if TYPE_CHECKING:
    import pandas as pd
    import xarray


def dataset_table(
    dataset: "xarray.Dataset", layout: TrackLayout
) -> "tuple[pd.DataFrame, TrackLayout]":
    """Return a dataset as a table, and the layout, which is completed by the dataset.

    Columns are ``time``, ``individuals``, and ``x``, ``y`` and ``confidence`` of each key point,
    such as ``nose_x``. Raises ParameterError for a missing variable or coordinate.
    """
    if "position" not in dataset.data_vars:
        raise ParameterError(
            f"the dataset has no variable 'position'; there are {listed([*dataset.data_vars])}"
        )
    position = _standard(dataset["position"], "space")
    missing = {"x", "y"} - {*map(str, position["space"].values)}
    if missing:
        raise ParameterError(f"position has no {' and no '.join(sorted(missing))} in space")
    values = {axis: position.sel(space=axis).values for axis in "xy"}
    if "confidence" in dataset.data_vars:
        values["confidence"] = _standard(dataset["confidence"]).values
    boats, points = (_named(position, name) for name in ("individuals", "keypoints"))
    columns: dict[str, Any] = {
        "time": np.repeat(dataset["time"].values, len(boats)),
        "individuals": np.tile(boats, len(dataset["time"])),
    }
    is_alone = points == ["0"] and "keypoints" not in position.coords
    for index, point in enumerate(points):
        stem = "" if is_alone else f"{point}_"
        columns |= {f"{stem}{kind}": array[..., index].ravel() for kind, array in values.items()}
    rows: pd.DataFrame = require("pandas", "plot").DataFrame(columns).rename_axis(index="row")
    return rows, _completed(dataset, layout, [*rows], "one" if is_alone else listed(points))


def _standard(variable: "xarray.DataArray", *own: str) -> "xarray.DataArray":
    """Return a variable with the dimensions time, `own`, individuals and key points."""
    order = ("time", *own, "individuals", "keypoints")
    # Later versions of movement have the names in the singular: individual, keypoint.
    variable = variable.rename({n: f"{n}s" for n in variable.dims if f"{n}s" in order})
    variable = variable.expand_dims([n for n in order[-2:] if n not in variable.dims])
    if {*variable.dims} != {*order} or not {"time", *own} <= {*variable.coords}:
        raise ParameterError(
            f"{variable.name} has the dimensions {', '.join(map(str, variable.dims))}, and "
            f"{', '.join(order)} are accepted"
        )
    return variable.transpose(*order)


def _named(position: "xarray.DataArray", dimension: str) -> list[str]:
    """Return the names along a dimension, or its numbers if there are none."""
    names = [str(name) for name in position[dimension].values]
    for name in names:
        if names.count(name) > 1:
            raise ParameterError(
                f"{names.count(name)} {dimension} of the dataset are called {name!r}"
            )
    return names


def _completed(
    dataset: "xarray.Dataset", layout: TrackLayout, columns: list[str], points: str
) -> TrackLayout:
    """Return a layout with missing fields taken from the dataset and its columns."""
    given = {one.name for one in fields(layout) if getattr(layout, one.name) != one.default}
    form = {"frame": "time", "id": "individuals"} | recognized(columns)
    form.pop("confidence", None)
    if "heading" not in form and not {"heading", "quaternion"} & given:
        raise ParameterError(
            f"the dataset has no headings: its key points are {points}; name those of tail and "
            "head in heading, or heading = None takes the direction of motion"
        )
    if not {"x", "y"} <= form.keys() | given:
        columns = [name for name in columns if name.endswith("_x")]
        raise ParameterError(
            f"which of the key points {points} is the center is not known: name its columns in x "
            f"and y, such as x = {columns}"
        )
    unit = str(dataset["position"].attrs.get("space_unit", "pixels"))
    if unit in CM:
        form["cm_per_unit"] = CM[unit]
    elif layout.cm_per_unit is None:
        raise ParameterError(
            f"positions of the dataset are in {unit}: cm_per_unit, the length of one, is missing"
        )
    time_unit = dataset.attrs.get("time_unit", "seconds")
    if time_unit != "seconds" and layout.fps is None:
        raise ParameterError(f"times of the dataset are in {time_unit}: fps is missing")
    return replace(layout, **{name: value for name, value in form.items() if name not in given})
