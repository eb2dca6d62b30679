"""A first description of tracks that have none, from the names and the numbers of their columns."""

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import tomli_w

from flockenv._io.atomic_write import write_text
from flockenv.errors import ParameterError
from flockenv.tracks.layout import TrackLayout, read_layout
from flockenv.tracks.reader import numbers_of, read_table

if TYPE_CHECKING:
    import pandas as pd

_NAMES = {
    "frame": ("frame", "frame_number", "frames", "time_s", "time", "t", "timestamp", "step"),
    "id": ("id", "track_id", "track", "boat", "robot", "animal", "individual", "particle", "name"),
    "x": ("x_cm", "x", "pos_x", "x_px", "position_x", "centroid_x", "center_x"),
    "y": ("y_cm", "y", "pos_y", "y_px", "position_y", "centroid_y", "center_y"),
    "heading": ("heading_rad", "heading", "heading_deg", "theta", "angle", "orientation", "alpha"),
}
_DOUBTS = {
    "pool": "outer and inner radius in cm: the circle about all positions stands here",
    "center": "center of the pool in units of the file: the middle of all positions",
    "cm_per_unit": "how many cm a unit of x and y has: 1 stands for cm",
    "y_down": "whether y points down, as in pictures",
    "fps": "frames per second of the camera; without it the column of frames holds times in s",
    "heading": "a column of headings; without one they are the directions of motion",
}
_FRAMES = ("frame", "frame_number", "frames", "step")
_FPS = 25.0
_MARGIN = 1.02


def guess_layout(path: str | os.PathLike[str]) -> tuple[TrackLayout, dict[str, str]]:
    """Write a description of tracks beside their table, guessed from the table.

    The description is the TOML file of the table's name. Returned are the layout as it was written,
    and the fields that nothing in the table says, each with what to check.

    Raises
    ------
    ParameterError
        If the file is no table, or no column has a name that says what it is; nothing is written.
    OSError
        If the description cannot be written.
    """
    path = Path(path)
    beside, table = path.with_suffix(".toml"), read_table(path)
    fields: dict[str, object] = {field: _column(table, field) for field in _NAMES}
    for field in ("frame", "id", "x", "y"):
        if not fields[field]:
            raise ParameterError(
                f"{path}: no column looks like {field!r} ({', '.join(_NAMES[field])}) among "
                f"{', '.join(map(str, table.columns))}: describe the columns in {beside}"
            )
    points = np.stack([numbers_of(table, str(fields[axis])) for axis in "xy"], axis=-1)
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) == 0:
        raise ParameterError(f"{path}: no row has a position")
    low, high = points.min(axis=0), points.max(axis=0)
    center = (low + high) / 2
    radius = float(np.hypot(*(points - center).T).max()) * _MARGIN or 1.0
    fields |= {
        "pool": [round(radius, 1), 0.0],
        "center": [round(float(each), 2) for each in center],
        "cm_per_unit": 1.0,
        # Pictures count from their upper left corner.
        "y_down": bool((low >= 0.0).all()),
    }
    if str(fields["frame"]).lower() in _FRAMES:
        fields["fps"] = _FPS
    if fields["heading"]:
        largest = np.nanmax(np.abs(numbers_of(table, str(fields["heading"]))), initial=0.0)
        fields["heading_unit"] = "deg" if largest > 2 * np.pi + 1e-6 else "rad"
    known = {"heading"} if fields["heading"] else set()
    doubts = {name: text for name, text in _DOUBTS.items() if name in fields.keys() - known}
    lines = ["# Guessed from the table beside this file. Check the lines that say so."]
    for name, value in fields.items():
        line = tomli_w.dumps({name: value}, multiline_strings=False).strip().replace("\n", " ")
        lines.append(f"{line}  # check: {doubts[name]}" if name in doubts else line)
    write_text(beside, "\n".join(lines) + "\n")
    return read_layout(beside), doubts


def _column(table: "pd.DataFrame", field: str) -> str:
    names = {str(name).strip().lower(): str(name) for name in table.columns}
    return next((names[each] for each in _NAMES[field] if each in names), "")
