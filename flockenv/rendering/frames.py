"""Frames: pictures of a flock, drawn in Rust. They need no screen."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from flockenv._core import Flock, FrameRenderer

__all__ = ["DEFAULT_SIZE", "frame", "renderer"]

#: Width and height of a frame in pixels.
DEFAULT_SIZE = (600, 600)


def frame(
    flock: Flock, width: int = DEFAULT_SIZE[0], height: int = DEFAULT_SIZE[1]
) -> NDArray[np.uint8]:
    """Return a picture of a flock as it is now.

    It shows the pool (in open water the part where the boats are), the boats with a mark towards
    the bow, leaders in amber, and in the corners the time and phase, the target and noise level,
    Ψ_o and the signed order towards the target.

    Parameters
    ----------
    flock
        The flock; the same flock gives the same bytes.
    width, height
        Size in pixels, 64 to 4096 each.

    Returns
    -------
    numpy.ndarray
        Shape (height, width, 3), uint8: red, green, blue.

    Raises
    ------
    ParameterError
        For a size out of range.
    """
    return renderer(width, height).draw(flock)


@lru_cache(maxsize=4)
def renderer(width: int, height: int) -> FrameRenderer:
    """Return what draws frames of a size, with its background and letters."""
    return FrameRenderer(width, height)
