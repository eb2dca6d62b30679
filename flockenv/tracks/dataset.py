"""Datasets of the package `movement` as tables: its own form of poses and of boxes."""

from dataclasses import fields, replace
from typing import Any

import numpy as np

from flockenv._io.extras import require
from flockenv.errors import ParameterError
from flockenv.tracks.formats import key_points
from flockenv.tracks.layout import TrackLayout
from flockenv.tracks.table import Table, listed

CM = {"cm": 1.0, "mm": 0.1, "m": 100.0}
"""Units of length by their names, in cm."""

_PIXELS = ("px", "pixel", "pixels")


def is_dataset(source: Any) -> bool:
    """Return whether a source is a dataset of xarray."""
    return hasattr(source, "data_vars")


def table_of(dataset: Any, layout: TrackLayout) -> tuple[Table, TrackLayout]:
    """Return a dataset as a table, and the layout with the dataset's own fields.

    Columns are ``time``, ``individuals``, and ``x``, ``y`` and ``confidence`` of each key point,
    such as ``nose_x``. A ParameterError names a missing variable or coordinate.
    """
    position, confidence = _variables(dataset)
    names, points = (_named(position, name) for name in ("individuals", "keypoints"))
    frames, animals = position.shape[0], position.shape[2]
    columns: dict[str, Any] = {
        "time": np.repeat(dataset["time"].values, animals),
        "individuals": np.tile(names, frames),
    }
    for index, point in enumerate(points):
        stem = f"{point}_" if point else ""
        for axis in ("x", "y"):
            at = [*position["space"].values].index(axis)
            columns[f"{stem}{axis}"] = position.values[:, at, :, index].ravel()
        if confidence is not None:
            columns[f"{stem}confidence"] = confidence.values[:, :, index].ravel()
    rows = require("pandas", "plot").DataFrame(columns).rename_axis(index="row")
    return Table(rows), _said(dataset, layout, points)


def _variables(dataset: Any) -> tuple[Any, Any]:
    """Return position, by time, space, individuals and key points, and confidence, or None."""
    if "position" not in dataset.data_vars:
        raise ParameterError(
            f"the dataset has no variable 'position'; there are {listed([*dataset.data_vars])}"
        )
    found = [dataset["position"], dataset.get("confidence")]
    for index, variable in enumerate(found):
        if variable is None:
            continue
        # Later versions of movement call them by one: individual, keypoint.
        variable = variable.rename(
            {f"{n}": f"{n}s" for n in ("individual", "keypoint") if n in variable.dims}
        )
        own = ("time", "space") if index == 0 else ("time",)
        for name in ("individuals", "keypoints"):
            variable = variable if name in variable.dims else variable.expand_dims(name)
        if {*variable.dims} != {*own, "individuals", "keypoints"} or not {*own} <= {
            *variable.coords
        }:
            raise ParameterError(
                f"{variable.name} has the dimensions {', '.join(map(str, variable.dims))}, and "
                f"{', '.join(own)}, individuals and keypoints are accepted"
            )
        found[index] = variable.transpose(*own, "individuals", "keypoints")
    missing = {"x", "y"} - {*map(str, found[0]["space"].values)}
    if missing:
        raise ParameterError(f"position has no {' and no '.join(sorted(missing))} in space")
    return found[0], found[1]


def _named(position: Any, dimension: str) -> list[str]:
    """Return the names along a dimension; without them one is "0", and one key point is ""."""
    if dimension not in position.coords:
        only = dimension == "keypoints" and position.sizes[dimension] == 1
        return [""] if only else [str(n) for n in range(position.sizes[dimension])]
    names = [str(name) for name in np.atleast_1d(position[dimension].values)]
    for name in names:
        if names.count(name) > 1:
            raise ParameterError(
                f"{names.count(name)} {dimension} of the dataset are called {name!r}"
            )
    return names


def _said(dataset: Any, layout: TrackLayout, points: list[str]) -> TrackLayout:
    """Return a layout with missing fields taken from the dataset."""
    default = {one.name: one.default for one in fields(TrackLayout)}
    given = {name for name, value in default.items() if getattr(layout, name) != value}
    form: dict[str, Any] = {"frame": "time", "id": "individuals"}
    known = key_points({name: f"{name}_" if name else "" for name in points})
    form |= {name: tuple(v) if isinstance(v, list) else v for name, v in known.items()}
    if "heading" not in form and not {"heading", "quaternion"} & given:
        raise ParameterError(
            f"the dataset has no headings: its key points are {listed(points) or 'one'}; name those"
            " of tail and head in heading, or heading = None takes the direction of motion"
        )
    if not known and "x" not in given:
        raise ParameterError(
            f"the key points of the dataset are {listed(points)}, and which is the center is not "
            "known: name its columns in x and y, such as x = ("
            f"'{points[0]}_x', '{points[-1]}_x')"
        )
    unit = str(dataset["position"].attrs.get("space_unit", "pixels"))
    if unit in CM:
        form["cm_per_unit"] = CM[unit]
    elif layout.cm_per_unit is None:
        raise ParameterError(
            f"positions of the dataset are in {unit}: cm_per_unit, the length of one, is missing"
        )
    if dataset.attrs.get("time_unit", "seconds") != "seconds" and layout.fps is None:
        raise ParameterError(
            f"times of the dataset are in {dataset.attrs['time_unit']}: fps is missing, as of a "
            "file that was loaded without it"
        )
    return replace(layout, **{name: value for name, value in form.items() if name not in given})
