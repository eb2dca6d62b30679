"""A first description of tracks, guessed from their table."""

import json
import os
import re
from pathlib import Path
from typing import Any

import numpy as np

from flockenv._io.atomic_write import write_text
from flockenv.errors import ParameterError
from flockenv.tracks.layout import TrackLayout, beside, columns_of
from flockenv.tracks.rows import FULL_TURN, long_table
from flockenv.tracks.table import column, numbers, read_table, text_of

Form = dict[str, Any]
Doubts = dict[str, tuple[Any, str]]

_THINGS = "body|boat|robot|animal|fish|individual|particle|agent|marker|tag|subject"
_MIDDLES = "pos(ition)?|cent(roid|er|re)|wcentroid"
_NAMES = {
    "frame": (
        *("time_s", "seconds?", "(trial_)?time", "t", "timestamp", "position_t", "step", "image"),
        *("frames?", "frame_?(idx|index|no|nr|number|id)"),
    ),
    "id": ("track_id", "track", f"({_THINGS})s?(_?(id|name|no|nr|number))?", "id|name|instance"),
    "x": (f"({_MIDDLES})_x", f"x(_?({_MIDDLES}))?"),
    "heading": ("heading", "theta|angle|orientation|yaw|alpha|direction"),
}
"""What columns are often called, in small letters without a unit, the better names first."""

_UNIT = re.compile(r"[\s_]*(?:\[(.*)\]|\((.*)\)|_(px|cm|mm|m|rad|deg|s|ms))\s*$")
_CM = {"cm": 1.0, "mm": 0.1, "m": 100.0}
_PER_S = {"s": None, "sec": None, "seconds": None, "ms": 1e3, "us": 1e6, "µs": 1e6, "ns": 1e9}
_HEAD = "head|nose|snout|bow|front"
_TAIL = "tail(_?base)?|stern|back|rear|abdomen"
_MIDDLE = "cent(er|re|roid)|body|thorax|mid(dle)?"


def guess_layout(path: str | os.PathLike[str]) -> list[str]:
    """Write a description of tracks beside their table, guessed from the table.

    The description is a TOML file with the table's name. The function returns the lines that it
    could not read from the table, each with what to check or to fill in. A ParameterError names a
    file that is no table, and a description that exists already.
    """
    path = Path(path)
    description = beside(path)
    if description.exists():
        raise ParameterError(f"{description} is there already: it may be written by hand")
    form, doubts = _spelling(path), Doubts()
    table = read_table(path, TrackLayout(pool="wide", **form))
    form |= _columns([str(each) for each in table])
    missing = [field for field in ("frame", "x", "y", "id") if field not in form]
    doubts |= {field: ("", f"fill in: no column looks like {field!r}") for field in missing}
    if missing in ([], ["id"]):
        fields = {name: form.get(name) for name in ("frame", "x", "y", "heading")}
        plain: Form = {n: tuple(v) if isinstance(v, list) else v for n, v in fields.items()}
        layout = TrackLayout(pool="wide", separator=";", decimal=form.get("decimal", "."), **plain)
        rows = long_table(table, layout) if layout.is_wide else table
        try:
            _guess_place(rows, layout, form, doubts)
        except ParameterError as error:
            raise ParameterError(f"{path}: {error}") from error
        _guess_time(rows, form, doubts)
        if isinstance(form.get("heading"), str):
            _guess_turn(numbers(rows, form["heading"], layout), form, doubts)
    else:
        doubts["pool"] = ("", "fill in: outer and inner radius in cm")
    if "confidence" in form:
        doubts["least_confidence"] = (0.6, "check: rows with less are left out")
    if "heading" not in form:
        doubts["heading"] = ("", "check: a column; without one headings are directions of motion")
    lines = [f"{name} = {_toml(value)}" for name, value in form.items() if name not in doubts]
    checks = [f"{name} = {_toml(value)}  # {words}" for name, (value, words) in doubts.items()]
    first = "# Guessed from the table beside this file. Check the lines that say so."
    write_text(description, "\n".join([first, *lines, *checks]) + "\n")
    return checks


def _toml(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)


def _spelling(path: Path) -> Form:
    """Return separator, decimal and lines to skip of a CSV file, as far as they are not usual."""
    if path.suffix.lower() != ".csv" or not path.is_file():
        return {}
    lines, most, found = text_of(path).splitlines()[:100], 0, Form()
    for mark in (";", "\t", "|", ",", " "):
        counts = [len(line.split(None if mark == " " else mark)) for line in lines]
        # Blanks stand in names, too.
        if max(counts, default=0) > most and (mark != " " or most < 3):
            most = max(counts)
            # The header is the first line as wide as those that follow it.
            found = {"separator": mark, "skip": counts.index(most) if most > 1 else 0}
    if found.get("separator", ",") != "," and re.search(r"\d,\d", "".join(lines[1:])):
        found["decimal"] = ","
    return {name: value for name, value in found.items() if value not in (",", 0) or name[0] == "d"}


def _plain(name: str) -> tuple[str, str]:
    """Return what a column is called without its unit, in small letters, and the unit."""
    found = _UNIT.search(name)
    unit = next(filter(None, found.groups()), "") if found else ""
    base = re.sub(r"([a-z])([A-Z])", r"\1_\2", _UNIT.sub("", name)).lower()
    return re.sub(r"[^a-z0-9]+", "_", base).strip("_"), unit.strip().lower()


def _columns(names: list[str]) -> Form:
    """Return the fields that names of columns tell."""
    plain = {name: _plain(name)[0] for name in names}

    def first(patterns: tuple[str, ...]) -> str | None:
        found = (n for each in patterns for n in names if re.fullmatch(each, plain[n]))
        return next(found, None)

    form: Form = {field: first(_NAMES[field]) for field in ("frame", "id", "heading", "x")}
    as_y = re.sub(r"(?<![a-z])x(?![a-z])", "y", plain.get(form["x"], ""))
    form["y"] = next((n for n in names if as_y and plain[n] == as_y), None)
    points = _key_points(names, form["id"] is not None)
    if None in (form["x"], form["y"]) or {"heading", "confidence"} & points.keys():
        form |= {"x": None, "y": None} | (_wide(names) or points)
    return {field: value for field, value in form.items() if value is not None}


def _as_y(name: str) -> str:
    return name.replace("x", "y").replace("X", "Y")


def _wide(names: list[str]) -> Form | None:
    """Return the fields of a table with a pair of numbered columns for each boat."""
    for name in names:
        found = re.fullmatch(r"([^xX]*[xX][ _#.]?)(\d+)(.*)", name)
        if found and _as_y(name) in names:
            x = f"{found[1]}{{id}}{found[3]}"
            angle = rf"((?:heading|theta|angle|orientation|alpha)[ _#.]?){found[2]}"
            angles = filter(None, (re.fullmatch(angle, each, re.IGNORECASE) for each in names))
            heading = next((f"{each[1]}{{id}}" for each in angles), None)
            return {"x": x, "y": _as_y(x), "id": "", "heading": heading}
    return None


def _key_points(names: list[str], is_named: bool) -> Form:
    """Return the fields of a table of key points: of each the columns x, y and a confidence."""
    found = [re.fullmatch(r"(?:(.*)\.)?(.+)([._])x", name) for name in names]
    pairs = [each for each in found if each and f"{each[0][:-1]}y" in names]
    # Several animals stand beside each other, as "animal.part".
    prefix = "{id}." if any(each[1] for each in pairs) and not is_named else ""
    stems = {each[2]: f"{prefix}{each[2]}{each[3]}" for each in pairs}

    def part(pattern: str) -> str | None:
        return next((stems[name] for name in stems if re.fullmatch(pattern, name.lower())), None)

    head, tail, middle = part(_HEAD), part(_TAIL), part(_MIDDLE)
    ends = [tail, head] if head and tail else []
    used = [middle] if middle else ends or [*stems.values()][:1]
    if not used:
        return {}
    form: Form = {axis: [f"{stem}{axis}" for stem in used] for axis in "xy"}
    if len(used) == 1 or prefix:
        form = {axis: columns[0] for axis, columns in form.items()}
    if ends:
        form["heading"] = [f"{stem}{axis}" for stem in ends for axis in "xy"]
    sure = [f"{stem}{word}" for stem in {*used, *ends} for word in ("likelihood", "score")]
    sure = [name for name in sure if any(n.endswith(name.removeprefix(prefix)) for n in names)]
    return form | ({"id": ""} if prefix else {}) | ({"confidence": sorted(sure)} if sure else {})


def _guess_place(rows: Any, layout: TrackLayout, form: Form, doubts: Doubts) -> None:
    """Guess the pool, its center and the scale from all positions."""
    names = [columns_of(each)[0] for each in (layout.x, layout.y)]
    points = np.stack([numbers(rows, name, layout) for name in names], axis=-1)
    points = points[np.isfinite(points).all(axis=1)]
    marks = [[0.0, 0.0], [-1.0, -1.0]]
    lost = [point for point in marks if 1 < (points == point).all(axis=1).sum() < len(points)]
    points = points[~np.any([(points == point).all(axis=1) for point in [[np.nan] * 2, *lost]], 0)]
    if len(points) == 0:
        raise ParameterError("no row has a position")
    low, high = points.min(axis=0), points.max(axis=0)
    center = (low + high) / 2
    unit = _plain(names[0])[1]
    radius = float(np.hypot(*(points - center).T).max()) * 1.02 * _CM.get(unit, 1.0) or 1.0
    words = "check: outer and inner radius in cm, here about all positions"
    doubts["pool"] = ([round(radius, 1), 0.0], words)
    words = "check: the pool's, in units of the file, here of all positions"
    doubts["center"] = ([round(float(each), 2) for each in center], words)
    if unit in _CM:
        form["cm_per_unit"] = _CM[unit]
    else:
        word = "fill in" if unit else "check"
        doubts["cm_per_unit"] = (1.0, f"{word}: how many cm a unit of x and y has")
    # Pictures count from their upper left corner.
    is_down = bool((low >= 0.0).all())
    words = "check: whether y points down; compare `analyze --plot` with the video"
    doubts["y_down"] = (is_down, words)
    if lost:
        doubts["lost"] = (lost, "check: points that stand for a boat that is not there")


def _guess_time(rows: Any, form: Form, doubts: Doubts) -> None:
    name, unit = _plain(form["frame"])
    if unit in _PER_S:
        form |= {"fps": _PER_S[unit]} if _PER_S[unit] else {}
    elif column(rows, form["frame"]).dtype.kind in "iu":
        is_frame = re.match("frame|step|image", name)
        words = "frames per second" if is_frame else "how many of its units a second has"
        doubts["fps"] = (25.0, f"{'check' if is_frame else 'fill in'}: {words}")


def _guess_turn(heading: Any, form: Form, doubts: Doubts) -> None:
    unit = _plain(form["heading"])[1]
    # A few may stand for none.
    turns = np.abs(heading[np.isfinite(heading)])
    largest = np.quantile(turns, 0.99) if len(turns) else 0.0
    if unit.startswith(("deg", "°")):
        form["heading_unit"] = "deg"
    elif largest > FULL_TURN["rad"] and not unit.startswith("rad"):
        doubts["heading_unit"] = ("deg", "check: headings exceed a full turn in rad")
    is_deg = "heading_unit" in form or "heading_unit" in doubts
    if largest > FULL_TURN["deg" if is_deg else "rad"]:
        doubts["wrapped"] = (False, "check: headings exceed a full turn")
