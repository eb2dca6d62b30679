"""A first description of tracks, guessed from their table."""

import json
import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flockenv._io.atomic_write import write_text
from flockenv.errors import ParameterError
from flockenv.tracks.formats import CM, LOST, PER_S, header_of, plain, recognized, unit_of
from flockenv.tracks.layout import TrackLayout, description_of, naming
from flockenv.tracks.motion import TINY, TURN
from flockenv.tracks.samples import points_of
from flockenv.tracks.table import (
    check_ending,
    is_value,
    listed,
    long_table,
    numbers,
    read_table,
    spelling_of,
)

if TYPE_CHECKING:
    import pandas as pd

Form = dict[str, Any]
"""Values of a layout's fields."""

Doubts = dict[str, tuple[Any, str]]
"""Values of a layout's fields that must be checked or filled in, each with a hint."""


def guess_layout(path: str | os.PathLike[str]) -> list[str]:
    """Write a description of tracks beside their table, guessed from the table.

    The description is a TOML file with the table's name. Returns those of its lines that do not
    follow from the table, so that the user has to check them or fill them in. Raises ParameterError
    for a file that is not a table, and for a description that exists already.
    """
    path = Path(path)
    description = description_of(path)
    check_ending(path)
    if description.exists():
        raise ParameterError(f"{description} already exists: it may be written by hand")
    with naming(path):
        form, doubts = _guessed(path)
    form |= {name: value for name, (value, _) in doubts.items()}
    lines = {name: f"{name} = {json.dumps(form[name], ensure_ascii=False)}" for name in form}
    checks = [f"{lines.pop(name)}  # {words}" for name, (_, words) in doubts.items()]
    first = "# Guessed from the table beside this file. Check the lines that say so."
    write_text(description, "\n".join([first, *lines.values(), *checks]) + "\n")
    return checks


def _guessed(path: Path) -> tuple[Form, Doubts]:
    """Return a layout's fields that follow from a table, and those that the user must check."""
    form, doubts = spelling_of(path), Doubts()
    rows = read_table(path, TrackLayout(pool="wide", **form))
    names = [*map(str, rows)]
    if all(is_value(name) or name.startswith("unnamed") for name in names):
        program_header = header_of(len(names)) if "separator" not in form else []
        names = form["header"] = program_header or [f"column {n}" for n in range(len(names))]
        if not program_header:
            doubts["header"] = (names, "fill in: names of the columns, which the file lacks")
        rows = read_table(path, TrackLayout(pool="wide", **form))
    form |= recognized(names) if "header" not in doubts else {}
    missing = [name for name in ("frame", "x", "y", "id") if name not in form]
    for name in missing:
        is_first = name == missing[0]
        choice = f"one of the columns {listed(names)}" if is_first else "another column"
        doubts[name] = ("", f"fill in: {choice}")
    if missing in ([], ["id"]):
        _guess_from_values(rows, form, doubts)
    else:
        doubts["pool"] = ("", "fill in: outer and inner radius in cm")
    if "confidence" in form:
        doubts["least_confidence"] = (0.6, "check: rows with less are left out")
    if "heading" not in form:
        doubts["heading"] = ("", "check: a column; without one headings are directions of motion")
    return form, doubts


def _guess_from_values(rows: "pd.DataFrame", form: Form, doubts: Doubts) -> None:
    """Add the fields that follow from the table's values to `form` and `doubts`."""
    layout = TrackLayout(pool="wide", **{"heading": "", "id": "", **form, "confidence": ""})
    table, names = long_table(rows, layout)
    if "id" in form and names is None:
        form["id"] = ""
    _guess_pool(table, layout, form, doubts)
    per_s = PER_S.get(unit_of(layout.frame))
    with suppress(ParameterError):  # Dates and clock times need no unit.
        counts = numbers(table[layout.frame], layout)
        is_whole = bool((counts[np.isfinite(counts)] % 1 == 0).all())
        if per_s is not None and (per_s != 1.0 or is_whole):
            form.setdefault("fps", per_s)
        elif is_whole and "fps" not in form:
            doubts["fps"] = (25.0, "check: frames, or other units of this column, per second")
    if len(layout.columns["heading"]) == 1:
        _guess_heading_unit(table[layout.columns["heading"][0]].abs().dropna(), form, doubts)


def _guess_pool(table: "pd.DataFrame", layout: TrackLayout, form: Form, doubts: Doubts) -> None:
    """Guess the pool, its center, the scale and the direction of y from all positions."""
    x, y = (layout.columns[axis][:1] for axis in "xy")
    (points,), _ = points_of(table, x, y, layout)
    points = points[np.isfinite(points)]
    lost = [mark for mark in LOST if 1 < (points == complex(*mark)).sum() < len(points)]
    points = points[~np.isin(points, [complex(*mark) for mark in lost])]
    if len(points) == 0:
        raise ParameterError("no row has a position")
    low, high = (complex(f(points.real), f(points.imag)) for f in (np.min, np.max))
    center, unit = (low + high) / 2, plain(x[0])[1]
    radius_cm = float(np.abs(points - center).max()) * 1.02 * CM.get(unit, 1.0)
    radius_cm = radius_cm or 1.0  # All positions may be one point.
    hint = "check: outer and inner radius in cm, here about all positions"
    doubts["pool"] = ([round(radius_cm, 1), 0.0], hint)
    hint = "check: the pool's, in units of the file, here of all positions"
    doubts["center"] = ([round(center.real, 2), round(center.imag, 2)], hint)
    if unit in CM:
        form["cm_per_unit"] = CM[unit]
    else:
        task = "fill in" if unit else "check"
        doubts["cm_per_unit"] = (1.0, f"{task}: how many cm a unit of x and y has")
    # Pixel coordinates count from the upper left corner.
    y_down = form.get("y_down", bool(low.real >= 0.0 and low.imag >= 0.0))
    hint = "check: whether y points down; compare `analyze --plot` with the video"
    doubts["y_down"] = (y_down, hint)
    if lost:
        doubts["lost"] = (lost, "check: points that stand for a missing boat")


def _guess_heading_unit(sizes: "pd.Series[float]", form: Form, doubts: Doubts) -> None:
    """Guess the headings' unit from their column's name or sizes, and whether they are wrapped."""
    written_unit = plain(form["heading"])[1].replace("°", "deg")
    known_unit = next((unit for unit in ("deg", "rad") if written_unit.startswith(unit)), None)
    largest = sizes.quantile(0.99)  # The few largest may stand for missing headings.
    unit = known_unit or ("deg" if largest > TURN["rad"] + TINY else "rad")
    if known_unit:
        form["heading_unit"] = known_unit
    elif unit == "deg":
        hint = "check: headings exceed a full turn in rad; wrapped = false if they are in rad"
        doubts["heading_unit"] = ("deg", hint)
    if largest > TURN[unit] + TINY:
        doubts["wrapped"] = (False, "check: headings exceed a full turn")
