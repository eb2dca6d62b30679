"""Pictures of a flock: frames, moving pictures in a file, and a window."""

from flockenv.rendering.animation import save_animation
from flockenv.rendering.frames import frame
from flockenv.rendering.window import Window

__all__ = ["Window", "frame", "save_animation"]
