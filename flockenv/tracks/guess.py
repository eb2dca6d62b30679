"""A first description of tracks, guessed from their table."""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from flockenv._io.atomic_write import write_text
from flockenv.errors import ParameterError
from flockenv.tracks.formats import CM, LOST, PER_S, header_of, plain, recognized, unit_of
from flockenv.tracks.headings import FULL_TURN
from flockenv.tracks.layout import TrackLayout, description_of, naming
from flockenv.tracks.table import (
    Floats,
    Table,
    check_ending,
    is_value,
    listed,
    read_table,
    spelling_of,
)

Form = dict[str, Any]
Doubts = dict[str, tuple[Any, str]]


def guess_layout(path: str | os.PathLike[str]) -> list[str]:
    """Write a description of tracks beside their table, guessed from the table.

    The description is a TOML file with the table's name. Returns the lines that the user has to
    check or to fill in, since they do not follow from the table. Raises ParameterError for a file
    that is not a table, and for a description that exists already.
    """
    path = Path(path)
    description = description_of(path)
    check_ending(path)
    if description.exists():
        raise ParameterError(f"{description} already exists: it may be written by hand")
    with naming(path):
        form, doubts = _guessed(path)
    lines = [f"{name} = {_toml(value)}" for name, value in form.items() if name not in doubts]
    checks = [f"{name} = {_toml(value)}  # {words}" for name, (value, words) in doubts.items()]
    first = "# Guessed from the table beside this file. Check the lines that say so."
    write_text(description, "\n".join([first, *lines, *checks]) + "\n")
    return checks


def _toml(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)


def _guessed(path: Path) -> tuple[Form, Doubts]:
    """Return the fields of a layout, and the doubtful ones with a hint what to do about them."""
    form, doubts = spelling_of(path), Doubts()
    table = read_table(path, TrackLayout(pool="wide", **form))
    if all(is_value(name) or name.startswith("unnamed") for name in table.names):
        count = len(table.names)
        header = header_of(count) if "separator" not in form else []
        form["header"] = header or [f"column {n}" for n in range(count)]
        if not header:
            words = "fill in: names of the columns, which the file lacks"
            doubts["header"] = (form["header"], words)
        table = read_table(path, TrackLayout(pool="wide", **form))
    form |= recognized(table.names) if "header" not in doubts else {}
    missing = [name for name in ("frame", "x", "y", "id") if name not in form]
    words = f"fill in: one of the columns {listed(table.names)}"
    for name in missing:
        doubts[name], words = ("", words), "fill in: another column"
    if missing in ([], ["id"]):
        _guess_from_values(table, form, doubts)
    else:
        doubts["pool"] = ("", "fill in: outer and inner radius in cm")
    if "confidence" in form:
        doubts["least_confidence"] = (0.6, "check: rows with less are left out")
    if "heading" not in form:
        doubts["heading"] = ("", "check: a column; without one headings are directions of motion")
    return form, doubts


def _guess_from_values(table: Table, form: Form, doubts: Doubts) -> None:
    """Add fields that follow from the table's values to those from its columns' names."""
    layout = TrackLayout(pool="wide", **{"heading": "", **form, "confidence": ""})
    table = Table(table.rows, layout)
    if "id" in form and not table.is_named:
        form["id"] = ""
    _guess_pool(table, form, doubts)
    _guess_time(table, form, doubts)
    if len(layout.columns["heading"]) == 1:
        _guess_turn(table.numbers(form["heading"]), form, doubts)


def _guess_pool(table: Table, form: Form, doubts: Doubts) -> None:
    """Guess the pool, its center and the scale from all positions."""
    names = [table.layout.columns[axis][0] for axis in ("x", "y")]
    points = np.stack([table.numbers(name) for name in names], axis=-1)
    points = points[np.isfinite(points).all(axis=1)]
    lost = [mark for mark in LOST if 1 < (points == mark).all(axis=1).sum() < len(points)]
    for mark in lost:
        points = points[(points != mark).any(axis=1)]
    if len(points) == 0:
        raise ParameterError("no row has a position")
    low, high = points.min(axis=0), points.max(axis=0)
    center = (low + high) / 2
    unit = plain(names[0])[1]
    radius = float(np.hypot(*(points - center).T).max()) * 1.02 * CM.get(unit, 1.0) or 1.0
    words = "check: outer and inner radius in cm, here about all positions"
    doubts["pool"] = ([round(radius, 1), 0.0], words)
    words = "check: the pool's, in units of the file, here of all positions"
    doubts["center"] = ([round(float(coordinate), 2) for coordinate in center], words)
    if unit in CM:
        form["cm_per_unit"] = CM[unit]
    else:
        word = "fill in" if unit else "check"
        doubts["cm_per_unit"] = (1.0, f"{word}: how many cm a unit of x and y has")
    # Pixel coordinates count from the upper left corner.
    is_down = form.get("y_down", bool((low >= 0.0).all()))
    words = "check: whether y points down; compare `analyze --plot` with the video"
    doubts["y_down"] = (is_down, words)
    if lost:
        doubts["lost"] = (lost, "check: points that stand for a missing boat")


def _guess_time(table: Table, form: Form, doubts: Doubts) -> None:
    try:
        counts = table.numbers(form["frame"])
    except ParameterError:  # Dates and clock times.
        return
    is_whole = (counts[np.isfinite(counts)] % 1 == 0).all()
    per_s = PER_S.get(unit_of(form["frame"]))
    if per_s is not None and (per_s != 1.0 or is_whole):
        form.setdefault("fps", per_s)
    elif is_whole and "fps" not in form:
        doubts["fps"] = (25.0, "check: frames, or other units of this column, per second")


def _guess_turn(heading: Floats, form: Form, doubts: Doubts) -> None:
    name = plain(form["heading"])[1].replace("°", "deg")
    said = next((unit for unit in ("deg", "rad") if name.startswith(unit)), None)
    # A few may be placeholders.
    turns = np.abs(heading[np.isfinite(heading)])
    largest = np.quantile(turns, 0.99) if len(turns) else 0.0
    unit = said or ("deg" if largest > FULL_TURN["rad"] else "rad")
    if said:
        form["heading_unit"] = said
    elif unit == "deg":
        words = "check: headings exceed a full turn in rad; wrapped = false if they are in rad"
        doubts["heading_unit"] = ("deg", words)
    if largest > FULL_TURN[unit]:
        doubts["wrapped"] = (False, "check: headings exceed a full turn")
