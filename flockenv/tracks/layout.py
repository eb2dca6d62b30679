"""How tracks lie in a table: columns, units, scale; written in TOML beside the table."""

import json
import math
import os
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from flockenv._io.atomic_write import write_text
from flockenv._io.extras import require
from flockenv._io.plain_file import is_special
from flockenv._io.toml import read_toml_file
from flockenv.errors import ParameterError, refuse_unknown, shown
from flockenv.parameters import FlockParameters
from flockenv.tracks.assemble import Floats, direction

if TYPE_CHECKING:
    import pandas as pd

SUFFIXES = (".csv", ".parquet", ".pq")
"""Endings of files that `read_tracks` takes."""

_NAMES = {
    "frame": ("frame", "frame_number", "frames", "time_s", "time", "t", "timestamp", "step"),
    "id": ("id", "track_id", "track", "boat", "robot", "animal", "individual", "particle", "name"),
    "x": ("x_cm", "x", "pos_x", "x_px", "position_x", "centroid_x", "center_x"),
    "y": ("y_cm", "y", "pos_y", "y_px", "position_y", "centroid_y", "center_y"),
    "heading": ("heading_rad", "heading", "heading_deg", "theta", "angle", "orientation", "alpha"),
}
"""Names that columns often have, in small letters."""


def _is_name(value: Any) -> bool:
    return isinstance(value, str) and bool(value.strip())


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _are(holds: Callable[[Any], bool], values: Any, count: int | None = None) -> bool:
    return isinstance(values, tuple) and all(map(holds, values)) and count in (None, len(values))


_FULL_TURN = 2 * np.pi + 1e-6
_Heading = str | tuple[str, str, str, str] | None
_KINDS: dict[Any, tuple[Callable[[Any], bool], str]] = {
    str: (_is_name, "the name of a column"),
    bool: (lambda value: isinstance(value, bool), "true or false"),
    float: (lambda value: _is_number(value) and value > 0.0, "a positive number"),
    float | None: (lambda value: value is None or _KINDS[float][0](value), "a positive number"),
    Literal["rad", "deg"]: (lambda value: value in ("rad", "deg"), "rad or deg"),
    tuple[float, float]: (lambda value: _are(_is_number, value, 2), "two numbers"),
    tuple[str, ...]: (lambda value: _are(_is_name, value), "a list of names"),
    _Heading: (
        lambda value: value is None or _is_name(value) or _are(_is_name, value, 4),
        "a column, or the columns x, y of the tail and x, y of the head",
    ),
}
"""What fields of a layout take, by their annotation; of the others FlockParameters says it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackLayout:
    """How tracks lie in a table with one row per frame and animal, robot or boat.

    A ParameterError refuses a value out of range or of another kind.

    Attributes
    ----------
    pool, hull, target
        As for `recording_of`.
    leaders : tuple of str
        Names of those that lead.
    frame : str
        Column of frame numbers, or of times in s where `fps` is None.
    fps : float or None
        Frames per second.
    id, x, y : str
        Columns.
    heading : str, or tuple of four str, or None
        Column of headings; or the columns x, y of the tail and x, y of the head, two key points
        that the heading joins; or None for the direction of motion, which is no heading where
        something is pushed sideways.
    heading_unit : str
        "rad" or "deg".
    wrapped : bool
        Whether headings are within a full turn. Then larger ones in "rad" are refused, since they
        are degrees most likely.
    cm_per_unit : float
        How many cm a unit of length in the file has, such as a pixel.
    center : tuple of float
        Center of the pool in units of the file.
    y_down : bool
        Whether y points down, as in pictures; headings then turn clockwise with rising angle.
    max_speed_cm_s : float
        Nothing moves faster: no velocity is taken across a step that is.
    """

    pool: Any
    hull: tuple[float, float] = (5.0, 0.5)
    leaders: tuple[str, ...] = ()
    target: str | tuple[str, ...] = "cw"
    frame: str = "frame"
    fps: float | None = None
    id: str = "id"
    x: str = "x"
    y: str = "y"
    heading: _Heading = "heading"
    heading_unit: Literal["rad", "deg"] = "rad"
    wrapped: bool = True
    cm_per_unit: float = 1.0
    center: tuple[float, float] = (0.0, 0.0)
    y_down: bool = False
    max_speed_cm_s: float = 200.0

    def __post_init__(self) -> None:
        for each in fields(self):
            value = getattr(self, each.name)
            holds, accepted = _KINDS.get(each.type, (None, ""))
            if holds and not holds(value):
                raise ParameterError(f"{each.name} = {shown(value)} is not accepted: {accepted}")
        count = len(self.leaders)
        try:
            FlockParameters(n_boats=count + 1, n_leaders=count, pool=self.pool, target=self.target)
        except TypeError as error:
            raise ParameterError(str(error)) from error


def read_layout(path: str | os.PathLike[str]) -> TrackLayout:
    """Return the layout in a TOML file: its fields, where "" is no heading and a pool is needed.

    A ParameterError names a file that cannot be read, or is no layout.
    """
    values = read_toml_file(path, str(path))
    for name, value in values.items():
        if isinstance(value, list):
            # Boats may be numbered, but `true` is no number.
            is_names = name == "leaders"
            values[name] = tuple(str(v) if is_names and type(v) is int else v for v in value)
    try:
        refuse_unknown(values, [each.name for each in fields(TrackLayout)], "field of a layout")
        if "pool" not in values:
            raise ParameterError('pool is missing: "narrow", "wide", or two radii in cm')
        return TrackLayout(**{**values, "heading": values.get("heading", "heading") or None})
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error


def guess_layout(path: str | os.PathLike[str]) -> list[str]:
    """Write a description of tracks beside their table, guessed from the table.

    The description is the TOML file of the table's name. Returned are its lines that nothing in the
    table says, each with what to check. A ParameterError names a file that is no table, or of which
    no column has a name that says what it is; nothing is written then.
    """
    path = Path(path)
    beside, table = path.with_suffix(".toml"), read_table(path)
    there = {str(name).strip().lower(): str(name) for name in table.columns}
    columns = {
        field: next(filter(None, map(there.get, names)), "") for field, names in _NAMES.items()
    }
    for field in ("frame", "id", "x", "y"):
        if not columns[field]:
            raise ParameterError(
                f"{path}: no column looks like {field!r} ({', '.join(_NAMES[field])}) among "
                f"{', '.join(map(str, table))}: describe the columns in {beside}"
            )
    points = np.stack([_numbers(table, columns[axis]) for axis in "xy"], axis=-1)
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) == 0:
        raise ParameterError(f"{path}: no row has a position")
    low, high = points.min(axis=0), points.max(axis=0)
    x, y = center = (low + high) / 2
    radius = float(np.hypot(*(points - center).T).max()) * 1.02 or 1.0
    doubts = {
        f"pool = [{radius:.1f}, 0.0]": "outer and inner radius in cm, here about all positions",
        f"center = [{x:.2f}, {y:.2f}]": "the pool's, in units of the file, here of all positions",
        "cm_per_unit = 1.0": "how many cm a unit of x and y has",
        # Pictures count from their upper left corner.
        f"y_down = {json.dumps(bool((low >= 0.0).all()))}": "whether y points down, as in pictures",
    }
    if columns["frame"].lower().startswith(("frame", "step")):
        doubts["fps = 25.0"] = "frames per second; without it the column of frames holds times in s"
    if not columns["heading"]:
        del columns["heading"]
        doubts['heading = ""'] = "a column; without one headings are the directions of motion"
    elif columns["heading"].lower().endswith("deg"):
        columns["heading_unit"] = "deg"
    elif np.nanmax(np.abs(_numbers(table, columns["heading"])), initial=0.0) > _FULL_TURN:
        if columns["heading"].lower().endswith("rad"):
            doubts["wrapped = false"] = "headings exceed a full turn in rad"
        else:
            doubts['heading_unit = "deg"'] = "headings exceed a full turn in rad"
    known = [f"{field} = {json.dumps(name, ensure_ascii=False)}" for field, name in columns.items()]
    checks = [f"{line}  # check: {meaning}" for line, meaning in doubts.items()]
    first = "# Guessed from the table beside this file. Check the lines that say so."
    write_text(beside, "\n".join([first, *known, *checks]) + "\n")
    return checks


def read_table(path: Path) -> "pd.DataFrame":
    """Return the rows of a CSV or Parquet file; a ParameterError names one that is none."""
    pandas, ending = require("pandas", "plot"), path.suffix.lower()
    if ending not in SUFFIXES:
        raise ParameterError(f"{path}: it ends in none of {', '.join(SUFFIXES)}")
    read = pandas.read_csv if ending == ".csv" else pandas.read_parquet
    try:
        if is_special(path):
            raise ParameterError("a device, a pipe or a socket")
        table: pd.DataFrame = read(path)
    except Exception as error:  # Parsers raise errors of many unrelated classes.
        raise ParameterError(f"{path} cannot be read as a table: {error}") from error
    return table


def rows_of(table: "pd.DataFrame", layout: TrackLayout) -> "pd.DataFrame":
    """Return frame, id, x and y in cm and heading in rad, from the center of the pool, y up."""
    frame, x, y = (_numbers(table, name) for name in (layout.frame, layout.x, layout.y))
    if not np.isfinite(frame).all():
        raise ParameterError(f"column {layout.frame!r} has rows without a number")
    up = -1.0 if layout.y_down else 1.0
    ids = _column(table, layout.id)
    # Blank names are none.
    rows = ids.mask(ids.astype(str).str.strip() == "").convert_dtypes().to_frame("id")
    return rows.assign(
        frame=frame,
        x=(x - layout.center[0]) * layout.cm_per_unit,
        y=(y - layout.center[1]) * layout.cm_per_unit * up,
        heading=_headings(table, layout) * up,
    )


def _headings(table: "pd.DataFrame", layout: TrackLayout) -> Floats:
    """Return headings in rad from x to y of the table, and 0 where the table has none."""
    if layout.heading is None:
        return np.zeros(len(table))
    if not isinstance(layout.heading, str):
        x_tail, y_tail, x_head, y_head = (_numbers(table, name) for name in layout.heading)
        return direction(x_head - x_tail, y_head - y_tail)
    heading = _numbers(table, layout.heading)
    largest = np.nanmax(np.abs(heading), initial=0.0)
    if layout.heading_unit == "rad" and layout.wrapped and largest > _FULL_TURN:
        raise ParameterError(
            f"headings reach {largest:.4g}, more than a full turn in radians: if they are in "
            "degrees, say heading_unit = 'deg'"
        )
    return np.radians(heading) if layout.heading_unit == "deg" else heading


def _column(table: "pd.DataFrame", name: str) -> "pd.Series[Any]":
    if name not in table:
        raise ParameterError(f"column {name!r} is missing; there are {', '.join(map(str, table))}")
    return table[name]


def _numbers(table: "pd.DataFrame", name: str) -> Floats:
    """Return a column, NaN where nothing stands."""
    column = _column(table, name)
    try:
        return column.to_numpy(dtype=np.float64, na_value=np.nan)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"column {name!r} holds other things than numbers") from error
