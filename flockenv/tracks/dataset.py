"""Datasets of the package movement as tables of tracks."""

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.tracks.formats import CM, key_points
from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.table import listed

if TYPE_CHECKING:
    import pandas as pd
    import xarray

_DIMENSIONS = ("time", "space", "individuals", "keypoints")


def dataset_table(
    dataset: "xarray.Dataset", layout: TrackLayout
) -> "tuple[pd.DataFrame, TrackLayout]":
    """Return a dataset as a table, and the layout completed with units and columns of the dataset.

    Columns are ``time``, ``individuals``, and ``x``, ``y`` and ``confidence`` of each key point,
    such as ``nose_x``. Raises ParameterError for a missing variable or coordinate.
    """
    data = _positions_of(dataset)
    boats, points = (_names_along(data, name) for name in _DIMENSIONS[2:])
    stems = {point: f"{point}_" for point in points}
    # A dataset without key points has one point without a name.
    if points == ["0"] and "keypoints" not in data.coords:
        stems = {"": ""}
    columns: dict[str, Any] = {
        "time": np.repeat(data["time"].values, len(boats)),
        "individuals": np.tile(boats, len(data["time"])),
    }
    data = data.transpose("time", "individuals", "keypoints", "space")
    values = {axis: data["position"].sel(space=axis).values for axis in "xy"}
    values |= {"confidence": data["confidence"].values} if "confidence" in data else {}
    for index, stem in enumerate(stems.values()):
        columns |= {f"{stem}{kind}": array[..., index].ravel() for kind, array in values.items()}
    rows: pd.DataFrame = require("pandas", "plot").DataFrame(columns).rename_axis(index="row")
    return rows, _completed(dataset, layout, stems)


def _positions_of(dataset: "xarray.Dataset") -> "xarray.Dataset":
    """Return the checked variables position and confidence, with all dimensions in the plural."""
    if "position" not in dataset.data_vars:
        raise ParameterError(
            f"the dataset has no variable 'position'; there are {listed([*dataset.data_vars])}"
        )
    data = dataset[[name for name in ("position", "confidence") if name in dataset.data_vars]]
    # Later versions of movement have the names in the singular: individual, keypoint.
    # A selected individual has its name in a coordinate without a dimension.
    singular = (name for name in {*data.dims, *data.coords} if f"{name}s" in _DIMENSIONS)
    data = data.rename({name: f"{name}s" for name in singular})
    data = data.expand_dims([name for name in _DIMENSIONS[2:] if name not in data.dims])
    for name, variable in data.items():
        expected = {*_DIMENSIONS} - ({"space"} if name == "confidence" else set())
        needed_coordinates = expected & {"time", "space"}
        if {*variable.dims} != expected or not needed_coordinates <= {*variable.coords}:
            raise ParameterError(
                f"{name} has the dimensions {', '.join(map(str, variable.dims))}, and "
                f"{', '.join(_DIMENSIONS)} are accepted"
            )
    if missing := {"x", "y"} - {*map(str, data["space"].values)}:
        raise ParameterError(f"position has no {' and no '.join(sorted(missing))} in space")
    return data


def _names_along(data: "xarray.Dataset", dimension: str) -> list[str]:
    """Return the names along a dimension; without names, the indices "0", "1" and so on."""
    names = data.get_index(dimension).astype(str)
    repeated = names[names.duplicated()]
    if len(repeated):
        count = (names == repeated[0]).sum()
        raise ParameterError(f"{count} {dimension} of the dataset are called {repeated[0]!r}")
    return [*names]


def _completed(
    dataset: "xarray.Dataset", layout: TrackLayout, stems: dict[str, str]
) -> TrackLayout:
    """Return the layout with its unset fields, those with their default, taken from the dataset."""
    set_fields = {f.name for f in fields(layout) if getattr(layout, f.name) != f.default}
    columns, points = key_points(stems, {}), listed([*stems])
    form: dict[str, Any] = {"frame": "time", "id": "individuals", **columns}
    if "heading" not in columns and not {"heading", "quaternion"} & set_fields:
        raise ParameterError(
            f"the dataset has no headings: its key points are {points or 'one'}; name those of "
            "tail and head in heading, or heading = None takes the direction of motion"
        )
    if not columns and "x" not in set_fields:
        raise ParameterError(
            f"which of the key points {points} is the center is not known: name its columns in x "
            f"and y, such as x = {[f'{stem}x' for stem in stems.values()]}"
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
    return replace(
        layout, **{name: value for name, value in form.items() if name not in set_fields}
    )
