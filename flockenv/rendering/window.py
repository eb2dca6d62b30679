"""A window that shows a flock while it moves."""

import os
from types import ModuleType

from flockenv._io.extras import require
from flockenv.flock import Flock
from flockenv.rendering.frames import renderer


def require_pygame() -> ModuleType:
    """Return pygame, of the extra ``render``."""
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    return require("pygame", "render")


class Window:
    """A window that shows a flock in real time. A process has only one: a new one replaces it.

    Parameters
    ----------
    width, height
        Size in pixels.
    fps
        Frames per second, both of real and of simulated time.

    Raises
    ------
    ParameterError
        For a size out of range.
    MissingExtraError
        If the extra ``render`` is not installed.
    """

    def __init__(self, width: int, height: int, fps: float) -> None:
        self._pygame = require_pygame()
        self._renderer = renderer(width, height)
        self._size, self._fps = (width, height), fps
        self._pygame.display.init()
        self._surface = self._pygame.display.set_mode(self._size)
        self._pygame.display.set_caption("flockenv")
        self._clock = self._pygame.time.Clock()
        self.is_open = True

    def show(self, flock: Flock) -> None:
        """Show a flock and return when the next step is due, or at once if the window is closed."""
        display = self._pygame.display
        # A newer window may have closed or replaced this one.
        has_display = display.get_init() and self._surface.get_size() == self._size
        self.is_open = self.is_open and has_display
        if self.is_open and self._pygame.event.get(self._pygame.QUIT):
            self.close()
        if not self.is_open:
            return
        picture = self._renderer.draw(flock._in_core)
        # The first axis of pygame's arrays is x.
        self._pygame.surfarray.blit_array(self._surface, picture.swapaxes(0, 1))
        display.flip()
        self._pygame.event.pump()
        self._clock.tick(self._fps)

    def close(self) -> None:
        """Close the window; `show` does nothing afterwards."""
        if self.is_open:
            self.is_open = False
            self._pygame.display.quit()
