"""A first description of tracks that have none, from the names and the numbers of their columns."""

import json
import os
from pathlib import Path

import numpy as np

from flockenv._io.atomic_write import write_text
from flockenv.errors import ParameterError
from flockenv.tracks.reader import numbers_of, read_table

_NAMES = {
    "frame": ("frame", "frame_number", "frames", "time_s", "time", "t", "timestamp", "step"),
    "id": ("id", "track_id", "track", "boat", "robot", "animal", "individual", "particle", "name"),
    "x": ("x_cm", "x", "pos_x", "x_px", "position_x", "centroid_x", "center_x"),
    "y": ("y_cm", "y", "pos_y", "y_px", "position_y", "centroid_y", "center_y"),
    "heading": ("heading_rad", "heading", "heading_deg", "theta", "angle", "orientation", "alpha"),
}
_FRAMES = ("frame", "frame_number", "frames", "step")
_MARGIN = 1.02


def guess_layout(path: str | os.PathLike[str]) -> list[str]:
    """Write a description of tracks beside their table, guessed from the table.

    The description is the TOML file of the table's name. Returned are its lines that nothing in the
    table says, each with what to check.

    Raises
    ------
    ParameterError
        If the file is no table, or no column has a name that says what it is; nothing is written.
    OSError
        If the description cannot be written.
    """
    path = Path(path)
    beside, table = path.with_suffix(".toml"), read_table(path)
    there = {str(name).strip().lower(): str(name) for name in table.columns}
    columns = {
        field: next((there[name] for name in names if name in there), "")
        for field, names in _NAMES.items()
    }
    for field in ("frame", "id", "x", "y"):
        if not columns[field]:
            raise ParameterError(
                f"{path}: no column looks like {field!r} ({', '.join(_NAMES[field])}) among "
                f"{', '.join(map(str, table.columns))}: describe the columns in {beside}"
            )
    points = np.stack([numbers_of(table, columns[axis]) for axis in "xy"], axis=-1)
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) == 0:
        raise ParameterError(f"{path}: no row has a position")
    low, high = points.min(axis=0), points.max(axis=0)
    x, y = center = (low + high) / 2
    radius = float(np.hypot(*(points - center).T).max()) * _MARGIN or 1.0
    known = [f"{field} = {json.dumps(name, ensure_ascii=False)}" for field, name in columns.items()]
    # Pictures count from their upper left corner.
    is_down = json.dumps(bool((low >= 0.0).all()))
    doubts = {
        f"pool = [{radius:.1f}, 0.0]": "outer and inner radius in cm, here of the circle about all "
        "positions",
        f"center = [{x:.2f}, {y:.2f}]": "center of the pool in units of the file, here the middle "
        "of all positions",
        "cm_per_unit = 1.0": "how many cm a unit of x and y has",
        f"y_down = {is_down}": "whether y points down, as in pictures",
    }
    if columns["frame"].lower() in _FRAMES:
        doubts["fps = 25.0"] = "frames per second; without it the column of frames holds times in s"
    if columns["heading"]:
        largest = np.nanmax(np.abs(numbers_of(table, columns["heading"])), initial=0.0)
        known.append(f'heading_unit = "{"deg" if largest > 2 * np.pi + 1e-6 else "rad"}"')
    else:
        doubts[known.pop()] = "a column; without one headings are the directions of motion"
    checks = [f"{line}  # check: {meaning}" for line, meaning in doubts.items()]
    first = "# Guessed from the table beside this file. Check the lines that say so."
    write_text(beside, "\n".join([first, *known, *checks]) + "\n")
    return checks
