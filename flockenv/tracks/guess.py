"""A first description of tracks, guessed from their table."""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from flockenv._io.atomic_write import write_text
from flockenv.errors import ParameterError
from flockenv.tracks.clock import PER_S, unit_of
from flockenv.tracks.dataset import CM
from flockenv.tracks.formats import MOT, plain, recognized
from flockenv.tracks.layout import TrackLayout, description_of, naming
from flockenv.tracks.rows import FULL_TURN, names_nobody
from flockenv.tracks.table import (
    Table,
    check_ending,
    has_decimal,
    is_text,
    is_value,
    listed,
    read_table,
    text_of,
    usual_separator,
)

Form = dict[str, Any]
Doubts = dict[str, tuple[Any, str]]


def guess_layout(path: str | os.PathLike[str]) -> list[str]:
    """Write a description of tracks beside their table, guessed from the table.

    The description is a TOML file with the table's name. The function returns the lines that it
    could not read from the table, each with what to check or to fill in. A ParameterError names a
    file that is no table, and a description that exists already.
    """
    path = Path(path)
    description = description_of(path)
    check_ending(path)
    if description.exists():
        raise ParameterError(f"{description} is there already: it may be written by hand")
    doubts = Doubts()
    with naming(path):
        form = _spelling(path)
        table = read_table(path, TrackLayout(pool="wide", **form))
        if all(is_value(name) or name.startswith("unnamed") for name in table.names):
            form["header"] = _header(len(table.names), form, doubts)
            table = read_table(path, TrackLayout(pool="wide", **form))
        form |= recognized(table.names) if "header" not in doubts else {}
        _guess_fields(table, form, doubts)
    lines = [f"{name} = {_toml(value)}" for name, value in form.items() if name not in doubts]
    checks = [f"{name} = {_toml(value)}  # {words}" for name, (value, words) in doubts.items()]
    first = "# Guessed from the table beside this file. Check the lines that say so."
    write_text(description, "\n".join([first, *lines, *checks]) + "\n")
    return checks


def _toml(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)


def _guess_fields(table: Table, form: Form, doubts: Doubts) -> None:
    """Add fields that follow from the table's values to those from its columns' names."""
    missing = [name for name in ("frame", "x", "y", "id") if name not in form]
    words = f"fill in: one of the columns {listed(table.names)}"
    for name in missing:
        doubts[name], words = ("", words), "fill in: another column"
    if missing not in ([], ["id"]):
        doubts["pool"] = ("", "fill in: outer and inner radius in cm")
    else:
        layout = TrackLayout(pool="wide", **{"heading": "", **form, "confidence": ""})
        table = Table(table.rows, layout)
        if "id" in form and names_nobody(table):
            form["id"] = ""
        _guess_place(table, form, doubts)
        _guess_time(table, form, doubts)
        if form.get("heading") and isinstance(form["heading"], str):
            _guess_turn(table.numbers(form["heading"]), form, doubts)
    if "confidence" in form:
        doubts["least_confidence"] = (0.6, "check: rows with less are left out")
    if "heading" not in form:
        doubts["heading"] = ("", "check: a column; without one headings are directions of motion")


def _spelling(path: Path) -> Form:
    """Return separator, decimal and lines to skip of a text file, if they are not usual."""
    if not is_text(path):
        return {}
    lines = text_of(path).splitlines()[:100] or [""]
    widths = {mark: [len(line.split(mark)) for line in lines] for mark in (";", "\t", "|", ",")}
    if max(map(max, widths.values()), default=0) < 3:  # Names may hold blanks, too.
        widths[" "] = [len(line.split()) for line in lines]
    mark = max(widths, key=lambda mark: max(widths[mark]))
    # The header is the first line with as many cells as the following ones.
    is_motive = [line.startswith(f"{mark}Type{mark}") for line in lines[:4]]
    skip = is_motive.index(True) if any(is_motive) else widths[mark].index(max(widths[mark]))
    form: Form = {}
    if mark != usual_separator(path):
        form["separator"] = mark
    form |= {"skip": skip} if skip else {}
    cells = (cell.strip() for line in lines[1:] for cell in line.split(mark))
    if mark != "," and any(has_decimal(cell, ",") for cell in cells):
        form["decimal"] = ","
    return form


def _header(count: int, form: Form, doubts: Doubts) -> list[str]:
    """Return names of the columns of a file without a header, where names look like numbers."""
    if 6 <= count <= len(MOT) and "separator" not in form:
        return [*MOT[:count]]
    names = [f"column {n}" for n in range(count)]
    doubts["header"] = (names, "fill in: names of the columns, which the file lacks")
    return names


def _guess_place(table: Table, form: Form, doubts: Doubts) -> None:
    """Guess the pool, its center and the scale from all positions."""
    names = [table.layout.columns[axis][0] for axis in ("x", "y")]
    points = np.stack([table.numbers(name) for name in names], axis=-1)
    points = points[np.isfinite(points).all(axis=1)]
    lost = []
    for mark in ([0.0, 0.0], [-1.0, -1.0]):
        is_mark = (points == mark).all(axis=1)
        if 1 < is_mark.sum() < len(points):
            lost.append(mark)
            points = points[~is_mark]
    if len(points) == 0:
        raise ParameterError("no row has a position")
    low, high = points.min(axis=0), points.max(axis=0)
    center = (low + high) / 2
    unit = plain(names[0])[1]
    radius = float(np.hypot(*(points - center).T).max()) * 1.02 * CM.get(unit, 1.0) or 1.0
    doubts["pool"] = (
        [round(radius, 1), 0.0],
        "check: outer and inner radius in cm, here about all positions",
    )
    doubts["center"] = (
        [round(float(coordinate), 2) for coordinate in center],
        "check: the pool's, in units of the file, here of all positions",
    )
    if unit in CM:
        form["cm_per_unit"] = CM[unit]
    else:
        word = "fill in" if unit else "check"
        doubts["cm_per_unit"] = (1.0, f"{word}: how many cm a unit of x and y has")
    # Pictures count from their upper left corner.
    is_down = form.get("y_down", bool((low >= 0.0).all()))
    words = "check: whether y points down; compare `analyze --plot` with the video"
    doubts["y_down"] = (is_down, words)
    if lost:
        doubts["lost"] = (lost, "check: points that stand for a boat that is not there")


def _guess_time(table: Table, form: Form, doubts: Doubts) -> None:
    if "fps" in form:
        return
    name, per_s = plain(form["frame"])[0], PER_S.get(unit_of(form["frame"]))
    try:
        counts = table.numbers(form["frame"])
    except ParameterError:  # Dates and clock times.
        return
    is_whole = (counts[np.isfinite(counts)] % 1 == 0).all()
    if per_s and (per_s != 1.0 or is_whole):
        form["fps"] = per_s
    elif is_whole and name.startswith(("frame", "step", "image", "bild")):
        doubts["fps"] = (25.0, "check: frames per second")
    elif is_whole:
        doubts["fps"] = (25.0, "fill in: how many of its units a second has")


def _guess_turn(heading: Any, form: Form, doubts: Doubts) -> None:
    unit = plain(form["heading"])[1]
    # A few may be placeholders.
    turns = np.abs(heading[np.isfinite(heading)])
    largest = np.quantile(turns, 0.99) if len(turns) else 0.0
    if unit.startswith(("deg", "°")):
        form["heading_unit"] = "deg"
    elif largest > FULL_TURN["rad"] and not unit.startswith("rad"):
        words = "check: headings exceed a full turn in rad; wrapped = false if they are in rad"
        doubts["heading_unit"] = ("deg", words)
    is_deg = "heading_unit" in form or "heading_unit" in doubts
    if largest > FULL_TURN["deg" if is_deg else "rad"]:
        doubts["wrapped"] = (False, "check: headings exceed a full turn")
