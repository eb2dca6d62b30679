"""How tracks lie in a file: columns, units, scale; written in TOML beside the file."""

import math
import os
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

from flockenv._io.toml import read_toml_file
from flockenv.errors import ParameterError, refuse_unknown, shown
from flockenv.parameters import FlockParameters


def _is_number(value: Any) -> bool:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return is_number and math.isfinite(value)


def _is_positive(value: Any) -> bool:
    return _is_number(value) and value > 0.0


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _are(holds: Callable[[Any], bool], values: Any, count: int | None = None) -> bool:
    is_long_enough = isinstance(values, tuple) and count in (None, len(values))
    return is_long_enough and all(map(holds, values))


_CHECKS: tuple[tuple[str, Callable[[Any], bool], tuple[str, ...]], ...] = (
    ("the name of a column", _is_text, ("frame", "id", "x", "y")),
    ("true or false", lambda value: isinstance(value, bool), ("wrapped", "y_down")),
    ("rad or deg", lambda value: value in ("rad", "deg"), ("heading_unit",)),
    ("a positive number", _is_positive, ("cm_per_unit", "max_speed_cm_s")),
    ("a positive number", lambda value: value is None or _is_positive(value), ("fps",)),
    ("two numbers", lambda value: _are(_is_number, value, 2), ("hull", "center")),
    ("a list of names", lambda value: _are(_is_text, value), ("leaders",)),
    (
        "cw, ccw, or one of them per leader",
        lambda value: _is_text(value) or _are(_is_text, value),
        ("target",),
    ),
    (
        "a column, or the columns x, y of the tail and x, y of the head",
        lambda value: value is None or _is_text(value) or _are(_is_text, value, 4),
        ("heading",),
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackLayout:
    """How tracks lie in a table with one row per frame and animal, robot or boat.

    Attributes
    ----------
    pool : str or tuple of float
        As for `recording_of`.
    hull : tuple of float
        As for `recording_of`.
    leaders : tuple of str
        Names of those that lead.
    target : str or tuple of str
        As for `recording_of`.
    frame : str
        Column of frame numbers, or of times in s where `fps` is None.
    fps : float or None
        Frames per second.
    id, x, y : str
        Columns.
    heading : str, or tuple of four str, or None
        Column of headings; or the columns x, y of the tail and x, y of the head, two key points
        that the heading joins; or None for the direction of motion, which is no heading where
        something is pushed sideways.
    heading_unit : str
        "rad" or "deg".
    wrapped : bool
        Whether headings are within a full turn. Then larger ones in "rad" are refused, since they
        are degrees most likely.
    cm_per_unit : float
        How many cm a unit of length in the file has, such as a pixel.
    center : tuple of float
        Center of the pool in units of the file.
    y_down : bool
        Whether y points down, as in pictures; headings then turn clockwise with rising angle.
    max_speed_cm_s : float
        Nothing moves faster: no velocity is taken across a step that is.

    Raises
    ------
    ParameterError
        For a value out of range or of another kind.
    """

    pool: Any
    hull: tuple[float, float] = (5.0, 0.5)
    leaders: tuple[str, ...] = ()
    target: str | tuple[str, ...] = "cw"
    frame: str = "frame"
    fps: float | None = None
    id: str = "id"
    x: str = "x"
    y: str = "y"
    heading: str | tuple[str, str, str, str] | None = "heading"
    heading_unit: str = "rad"
    wrapped: bool = True
    cm_per_unit: float = 1.0
    center: tuple[float, float] = (0.0, 0.0)
    y_down: bool = False
    max_speed_cm_s: float = 200.0

    def __post_init__(self) -> None:
        for accepted, holds, names in _CHECKS:
            for name in names:
                value = getattr(self, name)
                if not holds(value):
                    raise ParameterError(f"{name} = {shown(value)} is not accepted: {accepted}")
        try:
            FlockParameters(pool=self.pool)
        except TypeError as error:
            raise ParameterError(str(error)) from error


def read_layout(path: str | os.PathLike[str]) -> TrackLayout:
    """Return the layout in a TOML file: its fields, where "" is no heading and a pool is needed.

    A ParameterError names a file that cannot be read, or is no layout.
    """
    values = read_toml_file(path, str(path))
    try:
        refuse_unknown(values, [each.name for each in fields(TrackLayout)], "field of a layout")
        if "pool" not in values:
            raise ParameterError(
                'pool is missing: "narrow", "wide", or the outer and the inner radius in cm'
            )
        if isinstance(values.get("leaders"), list):
            values["leaders"] = list(map(str, values["leaders"]))
        plain: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value
            for name, value in values.items()
        }
        return TrackLayout(**{**plain, "heading": plain.get("heading", "heading") or None})
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error
