"""Frames: pictures of a flock, drawn in Rust without a screen."""

from functools import lru_cache, singledispatch

import numpy as np
from numpy.typing import NDArray

from flockenv._core import FrameRenderer
from flockenv.errors import short_repr
from flockenv.flock import Flock
from flockenv.recording import Recording

#: Width and height of a frame in pixels.
DEFAULT_SIZE = (600, 600)


@singledispatch
def frame(
    flock: object,
    width: int = DEFAULT_SIZE[0],
    height: int = DEFAULT_SIZE[1],
    *,
    colors: str = "direction",
    caption: str = "",
) -> NDArray[np.uint8]:
    """Return a picture of a flock in its present state, or of a recording at a time.

    ``frame(flock)`` shows a flock, ``frame(recording, time_s)`` the last sample of a recording up
    to a time in s. Both take a width and a height.

    The picture shows the pool (in open water the part where the boats are) and the boats, with a
    mark towards the bow. Boats that head clockwise are blue, counter-clockwise ones orange, and
    those that head along the radius (outward in a jam) gray. Leaders have an amber ring. If leaders
    have opposite targets, those with a counter-clockwise target have a plum ring. The corners show
    the time and phase, the target and bw, Ψ_o and the signed order. Without a common target, the
    rotation Ψ_o·sin φ_o, positive clockwise, replaces the signed order. Several threads may draw at
    the same time. Raises ParameterError for a size out of range, unknown colors, and a time outside
    the recording.

    Parameters
    ----------
    flock
        A `Flock`, or a `Recording` followed by a time. The same flock gives the same bytes.
    width, height
        Size in pixels, 64 to 4096 each.
    colors
        The property that color shows: "direction", or "role" (leaders amber or plum, other boats
        blue). In open water there is nothing to circle around: color always shows the role.
    caption
        Text above the time, cut to fit its corner.

    Returns
    -------
    numpy.ndarray
        Shape (height, width, 3), uint8: red, green, blue.
    """
    if not isinstance(flock, Flock):
        raise TypeError(f"a frame is of a Flock or a Recording, not of {short_repr(flock)}")
    return renderer(width, height).draw(flock._in_core, colors, caption)


@frame.register
def _frame_of_recording(
    recording: Recording,
    time_s: float,
    width: int = DEFAULT_SIZE[0],
    height: int = DEFAULT_SIZE[1],
    *,
    colors: str = "direction",
    caption: str = "",
) -> NDArray[np.uint8]:
    return renderer(width, height).draw(recording.flock_at(time_s)._in_core, colors, caption)


@lru_cache(maxsize=4)
def renderer(width: int, height: int) -> FrameRenderer:
    """Return a renderer for frames of this size; it caches background and letters."""
    return FrameRenderer(width, height)
