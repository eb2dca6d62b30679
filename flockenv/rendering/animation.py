"""Moving pictures in a file, written by Pillow."""

import os
import struct
from collections.abc import Iterable, Iterator
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.atomic_write import atomic_write
from flockenv._io.extras import require
from flockenv.errors import ParameterError, shown

if TYPE_CHECKING:
    from PIL.Image import Image

__all__ = ["save_animation"]

# Pillow's format of each suffix, and the unit in ms in which it stores how long a frame is shown.
_FORMATS = {".png": ("PNG", 1), ".apng": ("PNG", 1), ".gif": ("GIF", 10)}
_VIDEO = ".mp4"
_LONGEST_SIDE = 65_535  # GIF counts in 16 bits
_SLOWEST, _FASTEST = 0.1, 100.0


def save_animation(
    path: str | os.PathLike[str], frames: Iterable[NDArray[np.uint8]], fps: float
) -> None:
    """Write frames as a moving picture that repeats (extra ``render``).

    Frames in a row that are equal are stored as one that is shown for longer. Until the file is
    written, memory holds a byte per pixel and frame for GIF, and three for PNG.

    Parameters
    ----------
    path
        A name that ends in ``.png`` or ``.apng`` (animated PNG: every color unchanged), ``.gif``
        (256 colors per frame) or ``.mp4`` (H.264, which does not repeat; extra ``video``).
    frames
        Arrays (height, width, 3) of uint8, all of one shape.
    fps
        Frames per second, 0.1 to 100; many programs show GIF at 50 at most.

    Raises
    ------
    ParameterError
        For another ending, a rate out of range, no frames, frames of different shapes, and a
        picture that stands still for longer than the format can say (65 s of PNG, 655 s of GIF).
    TypeError
        For frames that are not arrays of uint8 with three axes.
    OSError
        If the file cannot be written; what was there before is still there.
    MissingExtraError
        If the extra ``render``, or for video ``video``, is not installed.
    """
    suffix = Path(path).suffix.lower()
    if suffix == _VIDEO:
        _save_video(path, frames, _rate(fps))
        return
    if suffix not in _FORMATS:
        names = ", ".join((*_FORMATS, _VIDEO))
        raise ParameterError(f"path = {os.fspath(path)!r} is not accepted: a name in {names}")
    name, unit_ms = _FORMATS[suffix]
    images = _images(frames, _rate(fps), unit_ms)
    first = next(images, None)
    if first is None:
        raise ParameterError("frames are none: at least one")
    content = BytesIO()
    # Pillow reads the frames of a GIF one after another, those of a PNG more than once.
    rest = images if name == "GIF" else list(images)
    try:
        first.save(content, name, save_all=True, append_images=rest, loop=0)
    except struct.error as error:
        accepted = f"a change at least every {unit_ms * 65.535:.0f} s"
        raise ParameterError(f"frames that stand still are not accepted: {accepted}") from error
    with atomic_write(path) as file:
        file.write(content.getbuffer())


def _save_video(
    path: str | os.PathLike[str], frames: Iterable[NDArray[np.uint8]], fps: float
) -> None:
    ffmpeg = require("imageio_ffmpeg", "video")
    shape: tuple[int, ...] | None = None
    with TemporaryDirectory() as folder:  # The encoder opens names, not files.
        made = Path(folder, "made.mp4")
        video = None
        for each in frames:
            shape = _checked(each, shape)
            if video is None:
                height, width, _ = shape
                video = ffmpeg.write_frames(str(made), (width, height), fps=fps, macro_block_size=2)
                video.send(None)
            video.send(np.ascontiguousarray(each))
        if video is None:
            raise ParameterError("frames are none: at least one")
        video.close()
        with atomic_write(path) as file:
            file.write(made.read_bytes())


def _rate(fps: Any) -> float:
    if isinstance(fps, bool) or not isinstance(fps, int | float | np.integer | np.floating):
        raise TypeError(f"fps must be a number, not {shown(fps)}")
    if not _SLOWEST <= fps <= _FASTEST:
        accepted = f"{_SLOWEST} to {_FASTEST:.0f} frames per second"
        raise ParameterError(f"fps = {shown(fps)} is not accepted: {accepted}")
    return float(fps)


def _images(frames: Iterable[Any], fps: float, unit_ms: int) -> "Iterator[Image]":
    """Yield Pillow's images, each with how long it is shown, so that the sum of all stays true."""
    image = require("PIL.Image", "render")
    shape: tuple[int, ...] | None = None
    shown_until = 0
    for count, frame in enumerate(frames, start=1):
        shape = _checked(frame, shape)
        picture = image.fromarray(np.ascontiguousarray(frame))
        end = round(count * 1000 / (fps * unit_ms)) * unit_ms
        picture.info["duration"] = end - shown_until
        shown_until = end
        yield picture


def _checked(frame: Any, shape: tuple[int, ...] | None) -> tuple[int, ...]:
    """Return the frame's shape, which is that of the frames before it."""
    if not isinstance(frame, np.ndarray) or frame.dtype != np.uint8 or frame.ndim != 3:
        kind = f"{frame.dtype} {frame.shape}" if isinstance(frame, np.ndarray) else type(frame)
        raise TypeError(f"frame must be an array (height, width, 3) of uint8, not {kind}")
    for name, side in zip(("height", "width"), frame.shape, strict=False):
        if not 1 <= side <= _LONGEST_SIDE:
            raise ParameterError(f"{name} = {side} is not accepted: 1 to {_LONGEST_SIDE} pixels")
    expected = shape or (*frame.shape[:2], 3)
    if frame.shape != expected:
        raise ParameterError(f"frame has shape {frame.shape}, expected {expected}")
    return expected
