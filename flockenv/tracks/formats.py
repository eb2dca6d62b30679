"""Tables of other programs: their columns, usual names of columns, and marks of lost animals.

In a pattern ``{id}`` stands for the name of a boat, ``{n}`` for its number, ``{part}`` for a key
point and ``*`` for anything. The column of y is that of x with one letter exchanged.
"""

import re
from collections.abc import Iterable, Mapping, Set
from types import MappingProxyType
from typing import Any, NamedTuple


class Format(NamedTuple):
    """The table of one program."""

    program: str
    #: Columns by field of a layout; a table of the program has all of them.
    columns: Mapping[str, str]
    #: Other fields of a layout: the clock, the axes, the hull's columns.
    fields: Mapping[str, Any] = MappingProxyType({})
    #: First cells, in lower case, of a header in levels: in its first line, and in lines of names.
    levels: tuple[str, ...] = ()
    #: Names of columns that are written without a header; the last four may be missing.
    header: tuple[str, ...] = ()


_MOT = ("frame", "id", "bb_left", "bb_top", "bb_width", "bb_height", "conf", "x", "y", "z")
_BOX = {"box": _MOT[4:6], "heading": "", "y_down": True}
_MOTIVE = tuple(f"{{id}}.Rotation_{axis}" for axis in "XZYW")  # Its vertical axis is Y.
_ABOVE = {"quaternion": _MOTIVE, "heading_turns": "ccw", "y_down": True}
_BODIES_IN_LEVELS = ("type", "name", "", "frame")
_PARTS_IN_LEVELS = ("scorer", "individuals", "bodyparts", "coords")
_PLACE = {"x": "{id}.Position_X", "y": "{id}.Position_Z"}

FORMATS = (
    Format("MOT", {"frame": "frame", "id": "id", "x": "bb_left", "y": "bb_top"}, _BOX, (), _MOT),
    Format("OptiTrack Motive", {"frame": "Time (Seconds)", **_PLACE}, _ABOVE, _BODIES_IN_LEVELS),
    Format(
        "DeepLabCut, several animals",
        {"frame": "frame", "x": "{id}.{part}_x"},
        levels=_PARTS_IN_LEVELS,
    ),
    Format("DeepLabCut", {"frame": "frame", "x": "{part}_x", "confidence": "{part}_likelihood"}),
    Format("SLEAP", {"frame": "frame_idx", "id": "track", "x": "{part}.x"}),
    Format("movement", {"frame": "time", "id": "individual*", "x": "{part}_x"}),
    Format("TrackMate", {"frame": "FRAME", "id": "TRACK_ID", "x": "POSITION_X"}),
    Format("ROS", {"frame": "%time", "x": "*position.x"}, {"fps": 1e9}),
    Format("ROS 2", {"frame": "*rosbagTimestamp", "x": "*position.x"}, {"fps": 1e9}),
    Format("AnimalTA", {"frame": "Time", "x": "X_{id}"}),
    Format("EthoVision", {"frame": "Trial time", "x": "X center"}),
    Format("idtracker.ai", {"frame": "seconds", "x": "*x{n}*"}),
    Format("numbered columns", {"x": "*x{n}*"}),
    Format("key points of several", {"x": "{id}.{part}_x"}),
    Format("key points", {"x": "{part}_x"}),
    Format("key points", {"x": "{part}.x"}),
)
"""A row for each program, the more special ones first."""

NO_NUMBER = {"", "nan", "na", "n/a", "#n/a", "<na>", "none", "null", "-", "--", "-nan"}
"""Cells that stand for a missing number, in lower case."""

NOBODY = (
    *("-1", "nan", "none", "null", "<na>", "unassigned", "not assigned", "unknown"),
    *("unidentified", "untracked", "unlabeled", "?", "undefined", "lost"),
)
"""Names of detections that are not boats, in lower case."""

LOST = ([0.0, 0.0], [-1.0, -1.0])
"""Points that many programs write for a lost animal."""

_BODIES = ("body", "boat", "robot", "animal", "fish", "individual", "particle", "agent")
_THINGS = (*_BODIES, "marker", "tag", "subject", "object", "insect", "rover", "vehicle", "blob")
WORDS: Mapping[str, tuple[str, ...]] = {
    "frame": (
        *("time_s", "seconds", "second", "trial_time", "time", "t", "timestamp", "position_t"),
        *("rosbagtimestamp", "*time", "*stamp", "step", "image", "frames", "frame", "frame_*"),
        *("time_*", "*_frame", "framenumber", "sample", "index"),
        *("zeit", "bild", "bild_*"),
    ),
    "id": (
        *("track_id", "track", *(f"{thing}{end}" for thing in _THINGS for end in ("", "s", "_*"))),
        *("id", "name", "instance", "oid", "trackid", "label"),
        *("boot", "roboter", "fisch", "tier"),
    ),
    "x": (
        *("pos_x", "position_x", "cent_x", "centroid_x", "center_x", "centre_x", "wcentroid_x"),
        *("x", "x_pos", "x_position", "x_centroid", "x_center", "x_wcentroid", "*position_x"),
    ),
    "heading": (
        *("heading", "theta", "angle", "orientation", "yaw", "alpha", "direction", "ang", "*yaw"),
        *("winkel", "richtung"),
    ),
}
"""Frequent names of columns, in lower case without a unit, the better names first."""

_PARTS = {
    "head": ("head", "nose", "snout", "bow", "front"),
    "tail": ("tail", "tail_base", "tailbase", "stern", "back", "rear", "abdomen"),
    "middle": ("center", "centre", "centroid", "body", "thorax", "mid", "middle", "bodycenter"),
}
CM = {"cm": 1.0, "mm": 0.1, "m": 100.0}
"""Units of length by their names, in cm."""

PER_S = {"s": 1.0, "sec": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e3, "us": 1e6, "µs": 1e6}
PER_S |= {"ns": 1e9, "min": 1 / 60, "minutes": 1 / 60, "h": 1 / 3600}
"""Units of time by their names in headers, per second."""

_LONGEST = 200
"""Longest name of a column that is compared: longer ones take time and match nothing."""

_TELLING = {"heading", "confidence", "quaternion", "box", "fps"}
"""Fields that make key points and numbered columns better than plain columns of x and y."""

_ANGLES = ("heading", "theta", "angle", "orientation", "alpha", "yaw")
_PLACEHOLDERS = {
    "{id}": r"(?P<id>.+?)",
    "{part}": r"(?P<part>[^.]+)",
    "{n}": r"[ _#.]?(?P<id>\d+)",
}
_UNIT = re.compile(r"[\s_]*(?:\[(.*)\]|\((.*)\)|_(px|cm|mm|m|rad|deg|s|ms))\s*$")


def plain(name: str) -> tuple[str, str]:
    """Return a column's name without its unit, in lower case, and the unit."""
    name = name[:_LONGEST]
    found = _UNIT.search(name)
    unit = next(filter(None, found.groups()), "") if found else ""
    base = re.sub(r"([a-z])([A-Z])", r"\1_\2", _UNIT.sub("", name)).lower()
    return re.sub(r"[^a-z0-9]+", "_", base).strip("_"), unit.strip().lower()


def unit_of(name: str) -> str:
    """Return the unit in the name of a column of times, perhaps its last word: time_min."""
    words, unit = plain(name)
    return unit or words.rpartition("_")[2]


def header_of(count: int) -> list[str]:
    """Return the columns of a program that writes `count` columns without a header, or none."""
    headers = (program.header for program in FORMATS if count <= len(program.header) <= count + 4)
    return [*next(headers, ())[:count]]


def _matches(pattern: str, names: Iterable[str]) -> list[re.Match[str]]:
    text = re.escape(pattern).replace(r"\*", ".*")
    for placeholder, expression in _PLACEHOLDERS.items():
        text = text.replace(re.escape(placeholder), expression)
    compiled = re.compile(text, re.IGNORECASE)
    return [found for name in names if (found := compiled.fullmatch(name))]


def _first(patterns: Iterable[str], names: Iterable[str]) -> re.Match[str] | None:
    """Return the first match of the first pattern that has one."""
    return next((found[0] for pattern in patterns if (found := _matches(pattern, names))), None)


def _as_written(found: re.Match[str]) -> str:
    """Return the name of a column with ``{id}`` in place of a boat's name or number."""
    if "id" not in found.groupdict():
        return found[0]
    return f"{found[0][: found.start('id')]}{{id}}{found[0][found.end('id') :]}"


def _as_y(name: str, names: Set[str], boat: str = "") -> str | None:
    """Return the y column that belongs to an x column, or None; `boat` stands in place of {id}."""
    swapped = name.replace("x", "y").replace("X", "Y")
    at = [index for index, letter in enumerate(name) if letter in "xX"]
    by_letter = [f"{name[:index]}{swapped[index]}{name[index + 1 :]}" for index in reversed(at)]
    others = (other for other in [*by_letter, swapped] if at)
    return next((other for other in others if other.replace("{id}", boat) in names), None)


def quaternion(names: Iterable[str]) -> list[str] | None:
    """Return the columns x, y, z and w of the first quaternion among names, or None."""
    by_key = {name.casefold(): name for name in names}
    for key in by_key:
        for index in (at for at, letter in enumerate(key) if letter == "w"):
            four = [by_key.get(f"{key[:index]}{axis}{key[index + 1 :]}", "") for axis in "xyzw"]
            if all(four):
                return four
    return None


def key_points(
    stems: Mapping[str, str], present: Set[str] = frozenset(), boat: str = ""
) -> dict[str, Any]:
    """Return the fields x, y, heading and confidence that follow from key points.

    The center is a point in the middle, or the middle of head and tail, or the only point. If there
    are several others, the center is ambiguous, and no fields are returned. The column of a
    confidence must be in `present`, with `boat` in place of {id}.
    """
    by_part = {
        part: next((stem for name, stem in stems.items() if plain(name)[0] in words), None)
        for part, words in _PARTS.items()
    }
    ends = [by_part["tail"], by_part["head"]]
    ends = [] if None in ends else ends
    used = [by_part["middle"]] if by_part["middle"] else ends or [*stems.values()]
    if used is not ends and len(used) > 1:
        return {}
    form: dict[str, Any] = {axis: [f"{stem}{axis}" for stem in used] for axis in "xy"}
    if len(used) == 1:
        form = {axis: columns[0] for axis, columns in form.items()}
    if ends:
        form["heading"] = [f"{stem}{axis}" for stem in ends for axis in "xy"]
    for word in ("likelihood", "score", "confidence"):
        sure = sorted(f"{stem}{word}" for stem in {*used, *ends})
        if {column.replace("{id}", boat) for column in sure} <= present:
            form["confidence"] = sure
    return form


def _fields_of(program: Format, names: list[str], present: Set[str]) -> dict[str, Any] | None:
    """Return the fields of a layout if the table is this program's, otherwise None."""
    columns = dict(program.columns)
    y, x_pattern = columns.pop("y", None), columns.pop("x")
    found = {field: _first([pattern], names) for field, pattern in columns.items()}
    pairs = [match for match in _matches(x_pattern, names) if y or _as_y(match[0], present)]
    if not pairs or None in found.values():
        return None
    first = pairs[0]
    groups, x = first.groupdict(), _as_written(first)
    boat = groups.get("id", "")
    form = {field: match[0] for field, match in found.items() if match} | dict(program.fields)
    form |= {"id": ""} if "id" in groups else {}
    if "part" in groups:
        form.pop("confidence", None)
        own = [match for match in pairs if match.groupdict().get("id", "") == boat]
        stems = {match["part"]: _as_written(match)[:-1] for match in own}
        return form | key_points(stems, present, boat)
    form |= {"x": x, "y": y or _as_y(x, present, boat)}
    angle = _first([f"*{word}{{n}}*" for word in _ANGLES], names) if "id" in groups else None
    return form | ({"heading": _as_written(angle)} if angle else {})


def recognized(names: list[str]) -> dict[str, Any]:
    """Return the fields of a layout that follow from names of columns; some may be empty."""
    names = [name for name in names if len(name) <= _LONGEST]
    present, by_plain = set(names), dict[str, str]()
    for name in names:
        by_plain.setdefault(plain(name)[0], name)
    found = {field: _first(words, by_plain) for field, words in WORDS.items()}
    form: dict[str, Any] = {field: by_plain[match[0]] for field, match in found.items() if match}
    if y := _as_y(form.get("x", ""), present):
        form["y"] = y
    else:
        form.pop("x", None)
    for program in FORMATS:
        known = _fields_of(program, names, present)
        # Any pair of columns looks like a key point of the general formats.
        if known is None or ("id" in form and _may_be_box(known, names)):
            continue
        if "y" not in form or "{" not in program.columns["x"] or _TELLING & known.keys():
            form |= known
            break
    if "heading" not in form and "quaternion" not in form and (four := quaternion(names)):
        form["quaternion"] = four
    return form | ({"heading": ""} if "quaternion" in form else {})


def _may_be_box(known: Mapping[str, Any], names: list[str]) -> bool:
    """Return whether x1, y1, x2 and y2 may be a box around a named boat instead of two boats."""
    x = known.get("x", "")
    if "{id}" not in x:
        return False
    return {match["id"] for match in _matches(x.replace("{id}", "{n}"), names)} == {"1", "2"}
