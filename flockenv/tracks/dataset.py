"""Datasets of the package `movement` as tables; they hold poses or boxes."""

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.tracks.formats import CM, key_points
from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.table import Table, listed

if TYPE_CHECKING:
    import xarray


def is_dataset(source: object) -> bool:
    """Return whether a source is a dataset of xarray."""
    return hasattr(source, "data_vars")


def table_of(dataset: "xarray.Dataset", layout: TrackLayout) -> Table:
    """Return a dataset as a table, whose layout is completed by the dataset.

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
    names, points = (_named(position, name) for name in ("individuals", "keypoints"))
    columns: dict[str, Any] = {
        "time": np.repeat(dataset["time"].values, len(names)),
        "individuals": np.tile(names, len(dataset["time"])),
    }
    stems = {point: f"{point}_" if point else "" for point in points}
    for index, stem in enumerate(stems.values()):
        columns |= {f"{stem}{kind}": array[..., index].ravel() for kind, array in values.items()}
    rows = require("pandas", "plot").DataFrame(columns).rename_axis(index="row")
    return Table(rows, _completed(dataset, layout, stems))


def _standard(variable: "xarray.DataArray", *own: str) -> "xarray.DataArray":
    """Return a variable with the dimensions time, `own`, individuals and key points."""
    order = ("time", *own, "individuals", "keypoints")
    for name in order[-2:]:
        # Later versions of movement have the names in the singular: individual, keypoint.
        one = name.removesuffix("s")
        variable = variable.rename({one: name}) if one in variable.dims else variable
        variable = variable if name in variable.dims else variable.expand_dims(name)
    if {*variable.dims} != {*order} or not {"time", *own} <= {*variable.coords}:
        raise ParameterError(
            f"{variable.name} has the dimensions {', '.join(map(str, variable.dims))}, and "
            f"{', '.join(order)} are accepted"
        )
    return variable.transpose(*order)


def _named(position: "xarray.DataArray", dimension: str) -> list[str]:
    """Return the names along a dimension; a single unnamed one is "0", or "" for a key point."""
    if dimension not in position.coords:
        only = dimension == "keypoints" and position.sizes[dimension] == 1
        return [""] if only else [str(n) for n in range(position.sizes[dimension])]
    names = [str(name) for name in position[dimension].values]
    for name in names:
        if names.count(name) > 1:
            raise ParameterError(
                f"{names.count(name)} {dimension} of the dataset are called {name!r}"
            )
    return names


def _completed(
    dataset: "xarray.Dataset", layout: TrackLayout, stems: dict[str, str]
) -> TrackLayout:
    """Return a layout with missing fields taken from the dataset."""
    given = {one.name for one in fields(layout) if getattr(layout, one.name) != one.default}
    known, points = key_points(stems), listed([*stems])
    if "heading" not in known and not {"heading", "quaternion"} & given:
        raise ParameterError(
            f"the dataset has no headings: its key points are {points or 'one'}; name those of "
            "tail and head in heading, or heading = None takes the direction of motion"
        )
    if not known and "x" not in given:
        raise ParameterError(
            f"which of the key points {points} is the center is not known: name its columns in x "
            f"and y, such as x = {[f'{stem}x' for stem in stems.values()]}"
        )
    form = {"frame": "time", "id": "individuals"} | known
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
