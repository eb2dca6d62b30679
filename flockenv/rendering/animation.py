"""Moving pictures in files: GIFs by Pillow, videos by FFmpeg."""

import os
from collections.abc import Iterable, Iterator
from io import BytesIO
from itertools import chain
from numbers import Real
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.arguments import as_float
from flockenv._io.atomic_write import atomic_write
from flockenv._io.extras import require
from flockenv.errors import ParameterError, short_repr

_LONGEST_SIDE = 65_535  # GIF stores sizes in 16 bits.
_SLOWEST, _FASTEST = 0.1, 100.0


def save_animation(
    path: str | os.PathLike[str], frames: Iterable[NDArray[np.uint8]], fps: float
) -> None:
    """Write frames as a moving picture to a file.

    Parameters
    ----------
    path
        A name that ends in ``.gif`` (256 colors per frame, repeats; extra ``render``) or ``.mp4``
        (H.264; extra ``video``).
    frames
        Arrays (height, width, 3) of uint8, all of one shape.
    fps
        Frames per second, 0.1 to 100; many programs show GIF at 50 at most.

    Raises
    ------
    ParameterError
        For another ending, a rate out of range, no frames, and frames of different shapes.
    TypeError
        For frames that are not such arrays.
    OSError
        If the file cannot be written; an old file is then unchanged.
    MissingExtraError
        If the extra is not installed.
    """
    writers = {".gif": _gif, ".mp4": _video}
    write = writers.get(Path(path).suffix.lower())
    if write is None:
        names = ", ".join(writers)
        raise ParameterError(f"path = {os.fspath(path)!r} is not accepted: a name in {names}")
    rate: object = fps
    if not isinstance(rate, Real) or not _SLOWEST <= as_float(rate) <= _FASTEST:
        accepted = f"{_SLOWEST} to {_FASTEST:.0f} frames per second"
        raise ParameterError(f"fps = {short_repr(fps)} is not accepted: {accepted}")
    content = write(_checked(frames), float(fps))
    with atomic_write(path) as file:
        file.write(content)


def _gif(frames: Iterator[NDArray[np.uint8]], fps: float) -> bytes:
    """Return the content of a GIF file."""
    image = require("PIL.Image", "render")

    def timed_pictures() -> Iterator[Any]:
        for index, frame in enumerate(frames):
            picture = image.fromarray(frame)
            # GIF stores durations in whole hundredths of a second. Start and end are rounded, not
            # the duration, so that rounding errors do not add up.
            start, end = round(100 * index / fps), round(100 * (index + 1) / fps)
            picture.info["duration"] = 10 * (end - start)  # Pillow takes milliseconds.
            yield picture

    pictures = timed_pictures()
    content = BytesIO()
    next(pictures).save(content, "GIF", save_all=True, append_images=pictures, loop=0)
    return content.getvalue()


def _video(frames: Iterator[NDArray[np.uint8]], fps: float) -> bytes:
    """Return the content of an MP4 file."""
    ffmpeg = require("imageio_ffmpeg", "video")
    first = next(frames)
    with TemporaryDirectory() as folder:  # The encoder opens paths, not open files.
        file = Path(folder, "video.mp4")
        width_and_height = first.shape[1::-1]
        encoder = ffmpeg.write_frames(str(file), width_and_height, fps=fps, macro_block_size=2)
        encoder.send(None)
        for frame in chain([first], frames):
            encoder.send(frame)
        encoder.close()
        return file.read_bytes()


def _checked(frames: Iterable[Any]) -> Iterator[NDArray[np.uint8]]:
    """Yield the frames; refuse other values, frames of different shapes, and having no frame."""
    shape: tuple[int, ...] | None = None
    for frame in frames:
        if not isinstance(frame, np.ndarray) or frame.dtype != np.uint8 or frame.ndim != 3:
            raise TypeError("frames must be arrays (height, width, 3) of uint8")
        height, width, _ = frame.shape
        if not 1 <= min(height, width) <= max(height, width) <= _LONGEST_SIDE:
            raise ParameterError(
                f"a frame of {width} × {height} pixels is not accepted: 1 to 65535"
            )
        expected = (height, width, 3) if shape is None else shape
        if frame.shape != expected:
            raise ParameterError(f"frame has shape {frame.shape}, expected {expected}")
        shape = expected
        yield np.ascontiguousarray(frame)
    if shape is None:
        raise ParameterError("frames is empty: at least one frame is needed")
