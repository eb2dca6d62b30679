"""Moving pictures in a file."""

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv._core import AnimationEncoder
from flockenv._io.atomic_write import atomic_write
from flockenv.errors import ParameterError

__all__ = ["save_animation"]

_FORMATS = {".png": "apng", ".apng": "apng", ".gif": "gif"}


def save_animation(
    path: str | os.PathLike[str], frames: Iterable[NDArray[np.uint8]], fps: float
) -> None:
    """Write frames as a moving picture that repeats.

    Frames are compressed one by one as they come, so that an iterator needs little memory.

    Parameters
    ----------
    path
        A name that ends in ``.png`` or ``.apng`` (animated PNG: every color unchanged) or ``.gif``.
    frames
        Arrays (height, width, 3) of uint8, all of one shape.
    fps
        Frames per second, 0.1 to 100; many programs show GIF at 50 at most.

    Raises
    ------
    ParameterError
        For another ending, a rate out of range, no frames, or frames of different shapes.
    TypeError
        For frames that are not arrays of uint8 with three axes.
    OSError
        If the file cannot be written; what was there before is still there.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in _FORMATS:
        names = ", ".join(_FORMATS)
        raise ParameterError(f"path = {os.fspath(path)!r} is not accepted: a name in {names}")
    encoder = None
    for each in frames:
        if encoder is None:
            height, width = _rows_and_columns(each)
            encoder = AnimationEncoder(_FORMATS[suffix], width, height, fps)
        encoder.add(each)
    if encoder is None:
        raise ParameterError("frames are none: at least one")
    content = encoder.finish()
    with atomic_write(path) as file:
        file.write(content)


def _rows_and_columns(array: Any) -> tuple[int, int]:
    shape = np.shape(array)
    if len(shape) != 3:
        raise TypeError(f"frame must be an array (height, width, 3) of uint8, not of shape {shape}")
    return shape[0], shape[1]
