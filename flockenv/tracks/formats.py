"""Tables of other programs: their columns, usual names of columns, and marks of lost animals.

In a pattern ``{id}`` stands for the name of a boat, ``{n}`` for its number, ``{part}`` for a key
point and ``*`` for anything. The column of y is that of x with one letter exchanged.
"""

import re
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple


class Format(NamedTuple):
    """The table of one program."""

    program: str
    #: Patterns of columns by field of a layout; a table of the program has all of them.
    columns: Mapping[str, str]
    #: Other fields of the layout, such as the clock and the direction of y.
    fields: Mapping[str, Any] = MappingProxyType({})
    #: First cells, in lower case, of the lines of a multi-line header, from top to bottom.
    levels: tuple[str, ...] = ()
    #: Names of the columns of a file without a header; the last four columns may be missing.
    header: tuple[str, ...] = ()


_MOT = ("frame", "id", "bb_left", "bb_top", "bb_width", "bb_height", "conf", "x", "y", "z")
_BOX: dict[str, Any] = {"y": "bb_top", "box": _MOT[4:6], "heading": "", "y_down": True}
_ROTATION = tuple(f"{{id}}.Rotation_{axis}" for axis in "XZYW")  # Motive's vertical axis is Y.
_RIGID_BODY: dict[str, Any] = {"y": "{id}.Position_Z", "quaternion": _ROTATION}
_RIGID_BODY |= {"heading_turns": "ccw", "y_down": True}
_BODIES = ("type", "name", "", "frame")
_PARTS = ("scorer", "individuals", "bodyparts", "coords")

FORMATS = (
    Format("MOT", {"frame": "frame", "id": "id", "x": "bb_left"}, _BOX, header=_MOT),
    Format(
        "Motive", {"frame": "Time (Seconds)", "x": "{id}.Position_X"}, _RIGID_BODY, levels=_BODIES
    ),
    Format("ROS", {"frame": "%time", "x": "*position.x"}, {"fps": 1e9}),
    Format("ROS 2", {"frame": "*rosbagTimestamp", "x": "*position.x"}, {"fps": 1e9}),
    Format("AnimalTA", {"frame": "Time", "x": "X_{id}"}),
    Format("numbered columns, as of idtracker.ai", {"x": "*x{n}*"}),
    Format("DeepLabCut", {"x": "{id}.{part}_x"}, levels=_PARTS),
    Format("key points, as of DeepLabCut and movement", {"x": "{part}_x"}),
    Format("key points, as of SLEAP", {"x": "{part}.x"}),
)
"""Formats whose columns `WORDS` does not recognize. The first that fits is used, so special ones
come before general ones."""

NO_NUMBER = {"", "nan", "na", "n/a", "#n/a", "<na>", "none", "null", "-", "--", "-nan"}
"""Cells that stand for a missing number, in lower case."""

NOBODY = (
    *("-1", "nan", "none", "null", "<na>", "unassigned", "not assigned", "unknown"),
    *("unidentified", "untracked", "unlabeled", "?", "undefined", "lost"),
)
"""Names of detections that are not boats, in lower case."""

LOST = ([0.0, 0.0], [-1.0, -1.0])
"""Points that many programs write for a lost animal."""

_ANIMALS = ("body", "boat", "robot", "animal", "fish", "individual", "particle", "agent")
_THINGS = (*_ANIMALS, "marker", "tag", "subject", "object", "insect", "rover", "vehicle", "blob")
WORDS: Mapping[str, tuple[str, ...]] = {
    "frame": (
        *("time_s", "seconds", "second", "trial_time", "time", "t", "timestamp"),
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

_POINTS = (
    ("tail", "tail_base", "tailbase", "stern", "back", "rear", "abdomen"),
    ("head", "nose", "snout", "bow", "front"),
    ("center", "centre", "centroid", "body", "thorax", "mid", "middle", "bodycenter"),
)
"""Names of the key points tail, head and middle."""

CM = {"cm": 1.0, "mm": 0.1, "m": 100.0}
"""Units of length by their names, in cm."""

PER_S = {"s": 1.0, "sec": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e3, "us": 1e6, "µs": 1e6}
PER_S |= {"ns": 1e9, "min": 1 / 60, "minutes": 1 / 60, "h": 1 / 3600}
"""Units of time by their names in headers, per second."""

_LONGEST = 200
"""Length of the longest column name that is compared with patterns, in characters."""

_PREFERRED = {"heading", "confidence", "quaternion", "box", "fps"}
"""Fields that make key points and numbered columns better than plain columns of x and y."""

_PLACEHOLDERS = {
    "{id}": r"(?P<id>.+?)",
    "{part}": r"(?P<part>[^.]+)",
    "{n}": r"[ _#.]?(?P<id>\d+)",
    "*": ".*",
}
Names = dict[str, None]
_UNIT = re.compile(r"[\s_]*(?:\[(.*)\]|\((.*)\)|_(px|cm|mm|m|rad|deg|s|ms))\s*$")


def plain(name: str) -> tuple[str, str]:
    """Return a column's name without its unit, in lower case, and the unit."""
    base, *units = _UNIT.split(name[:_LONGEST])
    base = re.sub(r"([a-z])([A-Z])", r"\1_\2", base).lower()
    unit = next(filter(None, units), "")
    return re.sub(r"[^a-z0-9]+", "_", base).strip("_"), unit.strip().lower()


def unit_of(name: str) -> str:
    """Return the unit in the name of a column of times, otherwise its last word, as in time_min."""
    words, unit = plain(name)
    return unit or words.rpartition("_")[2]


def header_of(count: int) -> list[str]:
    """Return the names of `count` columns that a program writes without a header, or []."""
    headers = (program.header for program in FORMATS if 0 <= len(program.header) - count <= 4)
    return [*next(headers, ())[:count]]


def _matches(pattern: str, names: Iterable[str]) -> list[re.Match[str]]:
    """Return the matches of a pattern of `FORMATS` among names, in any case."""
    text = re.escape(pattern)
    for placeholder, expression in _PLACEHOLDERS.items():
        text = text.replace(re.escape(placeholder), expression)
    matches = (re.fullmatch(text, name, re.IGNORECASE) for name in names)
    return [match for match in matches if match]


def _first(patterns: Iterable[str], names: Iterable[str]) -> re.Match[str] | None:
    """Return the first match of the first pattern that has one."""
    return next((match for pattern in patterns for match in _matches(pattern, names)), None)


def _siblings(name: str, letter: str, others: str, names: Names) -> list[str]:
    """Return the columns with each of the `others` in place of a letter: "pos_y" for "pos_x".

    One occurrence of the letter is replaced, the last one if its columns exist, otherwise an
    earlier one. If no such columns exist, all occurrences are replaced. Returns [] if none fits.
    """
    swaps = [str.maketrans(letter + letter.upper(), other + other.upper()) for other in others]
    spans = [(i, i + 1) for i in reversed(range(len(name))) if name[i].lower() == letter]
    for start, end in [*spans, (0, len(name))] if spans else []:
        siblings = [f"{name[:start]}{name[start:end].translate(s)}{name[end:]}" for s in swaps]
        if names.keys() >= {*siblings}:
            return siblings
    return []


def key_points(stems: Mapping[str, str], names: Names) -> dict[str, list[str]]:
    """Return the columns of x, y, heading and confidence that follow from key points.

    `stems` holds the start of the columns' names by key point, such as "nose_" for "nose". The
    center is the key point in the middle, or the mean of tail and head, or the only key point.
    Otherwise the center is ambiguous, and no fields are returned.
    """
    tail, head, middle = (
        [stem for name, stem in stems.items() if plain(name)[0] in words][:1] for words in _POINTS
    )
    ends = tail + head if tail and head else []
    center = middle or ends or [*stems.values()]
    if center != ends and len(center) > 1:
        return {}
    form = {axis: [f"{stem}{axis}" for stem in center] for axis in "xy"}
    if ends:
        form["heading"] = [f"{stem}{axis}" for stem in ends for axis in "xy"]
    for word in ("likelihood", "score", "confidence"):
        confidence = {f"{stem}{word}" for stem in (*center, *ends)}
        if names.keys() >= confidence:
            form["confidence"] = sorted(confidence)
    return form


def _with_id(boat: re.Match[str], name: str) -> str:
    """Return the name of a boat's column with ``{id}`` in place of the boat's name or number."""
    return f"{name[: boat.start('id')]}{{id}}{name[boat.end('id') :]}"


def _fields_of(program: Format, names: Names, *, has_ids: bool) -> dict[str, Any] | None:
    """Return the fields of a layout if the table is this program's, otherwise None."""
    matches = {field: _matches(pattern, names) for field, pattern in program.columns.items()}
    has_fixed_y = "y" in program.fields
    x_with_y = [x for x in matches["x"] if has_fixed_y or _siblings(x[0], "x", "y", names)]
    # In a table with names x1, y1, x2 and y2 may be a box around each boat instead of two boats.
    is_box = has_ids and sorted(str(x.groupdict().get("id")) for x in x_with_y) == ["1", "2"]
    if not x_with_y or not all(matches.values()) or is_box:
        return None
    first = x_with_y[0]
    known = {field: [field_matches[0][0]] for field, field_matches in matches.items()}
    if "part" in first.groupdict():
        boat = first.groupdict().get("id")
        points = [x for x in x_with_y if x.groupdict().get("id") == boat]
        del known["x"]
        # A name without its last letter, the axis, is the stem of the key point's columns.
        columns = key_points({point["part"]: point[0][:-1] for point in points}, names)
    else:
        columns = {"x": [first[0]], "y": _siblings(first[0], "x", "y", names)}
    if "id" in first.groupdict():
        columns = {field: [_with_id(first, name) for name in columns[field]] for field in columns}
        if columns and columns["x"] == columns["y"]:  # The axis was taken for a boat's name.
            return None
        known["id"] = [""]
        angle = _first([f"*{word}{{n}}*" for word in WORDS["heading"]], names)
        if angle and "part" not in first.groupdict():
            known["heading"] = [_with_id(angle, angle[0])]
    columns = known | columns
    form = {field: n[0] if len(n) == 1 else n for field, n in columns.items()}
    return form | {**program.fields}


def recognized(columns: Iterable[str]) -> dict[str, Any]:
    """Return the fields of a layout that follow from names of columns.

    The result lacks fields that do not follow, and "" stands for None.
    """
    names = dict.fromkeys(name for name in columns if len(name) <= _LONGEST)
    by_plain = dict[str, str]()
    for name in names:
        by_plain.setdefault(plain(name)[0], name)
    matches = {field: _first(words, by_plain) for field, words in WORDS.items()}
    form: dict[str, Any] = {field: by_plain[match[0]] for field, match in matches.items() if match}
    x = form.pop("x", "")
    if y := _siblings(x, "x", "y", names):
        form |= {"x": x, "y": y[0]}
    for program in FORMATS:
        known = _fields_of(program, names, has_ids="id" in form)
        # Plain columns of x and y also look like a key point of the general formats.
        is_needed = "y" not in form or "{" not in program.columns["x"]
        if known is not None and (is_needed or _PREFERRED & known.keys()):
            form |= known
            break
    if not {"heading", "quaternion"} & form.keys():
        quaternions = (_siblings(name, "w", "xyzw", names) for name in names)
        if quaternion := next(filter(None, quaternions), []):
            form["quaternion"] = quaternion
    return form | ({"heading": ""} if "quaternion" in form else {})
