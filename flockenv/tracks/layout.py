"""How tracks lie in a file: columns, units, scale; written in TOML beside the file."""

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Self

from flockenv._io.toml import read_toml_file
from flockenv.errors import ParameterError, refuse_unknown, shown
from flockenv.parameters import FlockParameters


def _is_positive(value: Any) -> bool:
    return _are_numbers((value,), 1) and value > 0.0


def _are_numbers(values: Any, count: int) -> bool:
    kinds = all(isinstance(each, int | float) and not isinstance(each, bool) for each in values)
    return kinds and len(values) == count and all(map(math.isfinite, values))


def _are_words(values: Any) -> bool:
    return isinstance(values, tuple) and all(isinstance(each, str) for each in values)


_COLUMN = "the name of a column", lambda value: isinstance(value, str)
_TRUTH = "true or false", lambda value: isinstance(value, bool)
_POSITIVE = "a positive number", _is_positive
_PAIR = "two numbers", lambda value: isinstance(value, tuple) and _are_numbers(value, 2)
_CHECKS: Mapping[str, tuple[str, Callable[[Any], bool]]] = {
    "frame": _COLUMN,
    "id": _COLUMN,
    "x": _COLUMN,
    "y": _COLUMN,
    "heading": (
        "a column, or the columns x, y of the tail and x, y of the head",
        lambda value: isinstance(value, str | None) or (_are_words(value) and len(value) == 4),
    ),
    "heading_unit": ("rad or deg", lambda value: value in ("rad", "deg")),
    "wrapped": _TRUTH,
    "y_down": _TRUTH,
    "leaders": ("a list of names", _are_words),
    "hull": _PAIR,
    "center": _PAIR,
    "fps": ("a positive number", lambda value: value is None or _is_positive(value)),
    "cm_per_unit": _POSITIVE,
    "max_speed_cm_s": _POSITIVE,
}


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
        Nothing moves faster: a sample that it takes more to reach from both sides is left out, and
        no velocity is taken across a step that is faster.

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
        for name, (accepted, holds) in _CHECKS.items():
            if not holds(getattr(self, name)):
                value = shown(getattr(self, name))
                raise ParameterError(f"{name} = {value} is not accepted: {accepted}")
        FlockParameters(pool=self.pool)

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Self:
        """Return the layout of these fields; lists stand for tuples, "" for no heading.

        Raises
        ------
        ParameterError
            For unknown fields, a missing pool, and as for the class.
        """
        refuse_unknown(values, [each.name for each in fields(cls)], "field of a layout")
        if "pool" not in values:
            raise ParameterError(
                'pool is missing: "narrow", "wide", or the outer and the inner radius in cm'
            )
        plain: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value
            for name, value in values.items()
        }
        if plain.get("heading") == "":
            plain["heading"] = None
        if isinstance(plain.get("leaders"), tuple):
            plain["leaders"] = tuple(map(str, plain["leaders"]))
        return cls(**plain)


def layout_beside(path: str | os.PathLike[str]) -> TrackLayout:
    """Return the layout in the TOML file beside a file of tracks: ``a.toml`` for ``a.csv``.

    Raises
    ------
    ParameterError
        If it is not there, or no layout.
    """
    beside = Path(path).with_suffix(".toml")
    if not beside.exists():
        raise ParameterError(
            f"{beside} is missing: it names the columns and units of {Path(path).name}"
        )
    return read_layout(beside)


def read_layout(path: str | os.PathLike[str]) -> TrackLayout:
    """Return the layout in a TOML file.

    Raises
    ------
    ParameterError
        If it cannot be read, or is no layout; the message names the file.
    """
    try:
        return TrackLayout.from_dict(read_toml_file(path, str(path)))
    except (ParameterError, TypeError) as error:
        raise ParameterError(f"{path}: {error}") from error
