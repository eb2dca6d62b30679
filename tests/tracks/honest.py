"""Honest tables: the flock that they are written from, and the layouts that read them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
import pandas as pd

from flockenv import FlockParameters, Recording, simulate

BOATS, FRAMES, HZ, PIXEL_CM, CENTER = 6, 150, 10.0, 0.25, (420.0, 390.0)
#: What a table in pixels needs, whatever its columns are called.
PLACE = {"pool": "narrow", "cm_per_unit": PIXEL_CM, "center": CENTER, "y_down": True}
#: Pictures count y downwards, and angles from x to y.
ANGLE = {"heading": "angle", "heading_unit": "deg"}
Rows = pd.DataFrame


@cache
def truth() -> Recording:
    return simulate(FlockParameters(n_boats=BOATS, pool="narrow", bw_s=0.2), 4, FRAMES / HZ)


@cache
def _rows() -> Rows:
    table = truth().to_dataframe(boats=True)
    angle = table["heading_rad"].to_numpy()
    rows = pd.DataFrame(
        {
            "frame": np.rint(table["time_s"] * HZ).astype(int),
            "id": table["boat"] + 1,
            "x": table["x_cm"] / PIXEL_CM + CENTER[0],
            "y": -table["y_cm"] / PIXEL_CM + CENTER[1],
            "angle": -np.degrees(angle) % 360,
        }
    )
    turn = np.radians(rows["angle"])
    for name, sign in (("nose", 1), ("tail", -1)):
        rows[f"{name}_x"] = rows["x"] + sign * 20 * np.cos(turn)
        rows[f"{name}_y"] = rows["y"] + sign * 20 * np.sin(turn)
    return rows


def rows() -> Rows:
    """One row per frame and boat, in pixels, y down, degrees from x to y."""
    return _rows().copy()


@dataclass
class Honest:
    """A table of a convention: what to write, and the layout that a user would give."""

    table: Callable[[], Any]
    layout: Mapping[str, Any]
    name: str = "tracks.csv"
    options: Mapping[str, Any] = field(default_factory=dict)
    #: Whether headings are those of the boats; otherwise places and speeds are compared.
    has_headings: bool = True
    boats: tuple[int, ...] = tuple(range(1, BOATS + 1))
    #: Rows that the report says are left out, by reason.
    left_out: Mapping[str, int] = field(default_factory=dict)
