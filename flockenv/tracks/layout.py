"""Layouts of tracks in a table: columns, units, scale; written in TOML beside the table."""

import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields
from numbers import Real
from pathlib import Path
from types import NoneType
from typing import Any, Literal, get_args, get_origin

from flockenv._io.toml import read_toml_file
from flockenv.errors import ParameterError, refuse_unknown, short_repr
from flockenv.parameters import FlockParameters
from flockenv.tracks.formats import NOBODY

_Columns = str | tuple[str, ...]
_Four = tuple[str, str, str, str]
_ACCEPTED: dict[Any, str] = {
    str: "the name of a column",
    _Columns: "the name of a column, or a list of them",
    bool: "true or false",
    int: "a number of lines up to 1000",
    float: "a positive number",
    tuple[float, float]: "two numbers",
    tuple[str, str]: "the columns of width and height",
    _Four: "the columns x, y, z and w of a quaternion",
    str | _Four: "a column, or the columns x, y of the tail and x, y of the head",
    tuple[str, ...]: "a list of names",
    tuple[tuple[float, float], ...]: "a list of points [x, y]",
}
"""Accepted values, for errors, by a field's annotation without None.

Literals list theirs, and `FlockParameters` checks fields of `Any`.
"""


def _matches(annotation: Any, value: Any, *, in_tuple: bool = False) -> bool:
    """Return whether a value has the type that a field's annotation names.

    Names must not be blank, and numbers must be positive, except in a tuple.
    """
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Literal:
        return value in arguments
    if origin is tuple:
        if not isinstance(value, tuple):
            return False
        types = arguments[:1] * len(value) if arguments[-1] is ... else arguments
        return len(value) == len(types) and all(
            _matches(item_type, item, in_tuple=True)
            for item_type, item in zip(types, value, strict=True)
        )
    if arguments:  # A union.
        return any(_matches(alternative, value) for alternative in arguments)
    if annotation is float:
        is_number = isinstance(value, Real) and not isinstance(value, bool)
        return is_number and math.isfinite(value) and (in_tuple or value > 0.0)
    if annotation is int:
        return type(value) is int and 0 <= value <= 1000
    if annotation is str:
        return isinstance(value, str) and (in_tuple or bool(value.strip()))
    return isinstance(value, annotation)


def _check(name: str, annotation: object, value: object) -> None:
    """Refuse a value that does not match the annotation of its field."""
    if annotation is Any or _matches(annotation, value):
        return
    if get_origin(annotation) is Literal:
        words = [word if word.isalpha() else repr(word) for word in get_args(annotation) if word]
        accepted = " or ".join(words)
    else:
        accepted = next(
            words for kind, words in _ACCEPTED.items() if annotation in (kind, kind | None)
        )
    raise ParameterError(f"{name} = {short_repr(value)} is not accepted: {accepted}")


def _plain(name: str, value: object) -> object:
    """Return lists as tuples, and numbers in a list of names as texts."""
    if not isinstance(value, list | tuple):
        return value
    holds_names = name in ("leaders", "unassigned", "missing")
    # The items have no field of their own: a list inside a list is never one of names.
    plain = (_plain("", item) for item in value)
    return tuple(str(v) if holds_names and type(v) in (int, float) else v for v in plain)


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackLayout:
    """The layout of tracks in a table with one row per frame and animal, robot or boat.

    Names of columns match in any case. In a table with one row per frame, ``{id}`` stands for the
    boat's name: ``x = "x{id}"`` takes x1, x2 and so on. In a dataset of movement, key points are
    columns such as ``nose_x``, and unset fields follow from the key points' names. A list becomes a
    tuple, and "" becomes None. Raises ParameterError for a value out of range or of another kind.
    """

    pool: Any  #: As for `recording_of`.
    hull: tuple[float, float] = (5.0, 0.5)  #: As for `recording_of`.
    leaders: tuple[str, ...] = ()  #: Names of the leaders.
    target: Any = "cw"  #: As for `recording_of`.
    #: Column of frame numbers, or of times in s if `fps` is None. Dates, clock times and durations
    #: are converted. Rows may be in any order.
    frame: str = "frame"
    #: Units of that column per second: frames per second, 1000 if it counts ms, 1/60 if it counts
    #: minutes. Whole numbers need it, for example 1 if they count seconds.
    fps: float | None = None
    #: Column of the boats' names. None if the table has one boat, or if the boats' names stand in
    #: the columns' names. If no row has a name, all rows belong to one boat.
    id: str | None = "id"
    x: _Columns = "x"  #: Column of the center's x, or several columns, whose mean is taken.
    y: _Columns = "y"  #: Column or columns of y, as many as of x.
    #: Columns of width and height, if x and y are the least corner of a box around the boat.
    box: tuple[str, str] | None = None
    #: Column of headings, or four columns: x, y of the tail and x, y of the head, two key points.
    #: None takes the direction of motion, which is wrong for robots that are pushed sideways.
    heading: str | _Four | None = "heading"
    #: Columns x, y, z and w of a rotation, in place of `heading`; z is the vertical. In a system in
    #: which y is up, name the columns x, z, y and w.
    quaternion: _Four | None = None
    heading_unit: Literal["rad", "deg", "turn"] = "rad"  #: "turn" is a full turn.
    #: Where heading 0 points in the picture: "right", "up" (a compass's north), "left", "down".
    heading_zero: Literal["right", "up", "left", "down"] = "right"
    #: The direction in which headings grow in the picture. None: from x to y of the file, clockwise
    #: if y points down.
    heading_turns: Literal["cw", "ccw", None] = None
    #: Whether headings are axes without a bow, such as those of ellipses. The bow is then the end
    #: toward which a boat mostly moves, so a boat must not move backward for longer than forward.
    axis: bool = False
    wrapped: bool = True  #: Whether headings are within a full turn.
    #: Length in cm of a unit in the file, such as a pixel. None: 1, or what a dataset says.
    cm_per_unit: float | None = None
    center: tuple[float, float] = (0.0, 0.0)  #: Center of the pool in units of the file.
    y_down: bool = False  #: Whether y points down, as in pictures.
    max_speed_cm_s: float = 200.0  #: Highest speed; a faster step gives no velocity.
    confidence: _Columns | None = None  #: Columns of the confidence in a row.
    least_confidence: float | None = None  #: Rows with less confidence are left out.
    unassigned: tuple[str, ...] = NOBODY  #: Names of detections that are not boats, in any case.
    #: Points, in units of the file, that stand for a missing boat.
    lost: tuple[tuple[float, float], ...] = ()
    missing: tuple[str, ...] = ()  #: Further texts and numbers that stand for a missing value.
    #: What separates the cells of a text file. None: tabs in a file that ends in .tsv, else commas.
    separator: Literal[",", ";", "\t", " ", "|", None] = None
    decimal: Literal[".", ","] = "."  #: The decimal mark of a text file.
    skip: int = 0  #: Lines before the header of a text file.
    header: tuple[str, ...] = ()  #: Names of the columns of a text file without a header.

    def __post_init__(self) -> None:
        for field in fields(self):
            value = _plain(field.name, getattr(self, field.name))
            accepts_none = bool({None, NoneType} & {*get_args(field.type)})
            if value == "" and accepts_none:
                value = None
            _check(field.name, field.type, value)
            object.__setattr__(self, field.name, value)
        if not 0 < len(columns_of(self.x)) == len(columns_of(self.y)):
            raise ParameterError(f"x = {self.x!r} and y = {self.y!r} are not as many columns")
        if (self.confidence is None) != (self.least_confidence is None):
            raise ParameterError("confidence and least_confidence need each other")
        radius_cm, shape = self.hull
        values: dict[str, Any] = {"n_leaders": len(self.leaders), "n_boats": len(self.leaders) + 1}
        values |= {"boat_radius_cm": radius_cm, "boat_shape": shape}
        try:
            flock = FlockParameters(**values, pool=self.pool, target=self.target)
        except TypeError as error:
            raise ParameterError(str(error)) from error
        # An iterator can be read only once, so the fields keep what was read.
        object.__setattr__(self, "pool", flock.pool)
        object.__setattr__(self, "target", flock.target)

    @property
    def is_wide(self) -> bool:
        """Whether the table has one row per frame, with columns for each boat."""
        return "{id}" in columns_of(self.x)[0]

    @property
    def has_headings(self) -> bool:
        """Whether the table has headings; otherwise they are directions of motion."""
        return self.heading is not None or self.quaternion is not None

    @property
    def columns(self) -> dict[str, tuple[str, ...]]:
        """The names of the columns of numbers, by field; all columns but times and names."""
        heading = self.heading if self.quaternion is None else None
        values = {"x": self.x, "y": self.y, "box": self.box, "heading": heading}
        values |= {"quaternion": self.quaternion, "confidence": self.confidence}
        return {name: columns_of(value) for name, value in values.items()}


def columns_of(value: _Columns | None) -> tuple[str, ...]:
    """Return the names in a field that holds None, a name or several names."""
    return (value,) if isinstance(value, str) else value or ()


def description_of(path: Path) -> Path:
    """Return the path of a table's description: ``a.toml`` for ``a.csv`` and ``a.csv.gz``."""
    if not path.name:
        raise ParameterError(f"{os.fspath(path)!r} is not the name of a table")
    uncompressed = path.with_suffix("") if path.suffix.lower() == ".gz" else path
    return uncompressed.with_suffix(".toml")


def read_layout(path: str | os.PathLike[str]) -> TrackLayout:
    """Return the layout in a TOML file, in which "" means None and a pool is needed.

    Raises ParameterError for a file that cannot be read or is not a layout.
    """
    values = read_toml_file(path, str(path))
    with naming(path):
        refuse_unknown(values, [field.name for field in fields(TrackLayout)], "field of a layout")
        if "pool" not in values:
            raise ParameterError('pool is missing: "narrow", "wide", or two radii in cm')
        return TrackLayout(**values)


@contextmanager
def naming(path: str | os.PathLike[str]) -> Iterator[None]:
    """Put the name of a file before the message of a ParameterError about its content."""
    try:
        yield
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error
