"""A window that shows a flock while it moves."""

import os
import time
from typing import Any

import numpy as np

from flockenv._io.extras import require
from flockenv._io.interrupts import end_if_interrupted
from flockenv.errors import ParameterError, shown
from flockenv.flock import Flock
from flockenv.rendering.frames import renderer

__all__ = ["Window", "require_pygame"]


def require_pygame() -> Any:
    """Return pygame.

    Raises
    ------
    MissingExtraError
        If the extra ``render`` is not installed.
    """
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    return require("pygame", "render")


class Window:
    """A window that shows a flock in real time.

    Keys: space pauses and continues; right arrow takes one step; + and - double and halve the
    speed. A process has one window: a second one takes its place.

    Parameters
    ----------
    width, height
        Size in pixels.
    fps
        Frames per second of simulated time, which sets the speed in real time.

    Raises
    ------
    ParameterError
        For a size out of range, and a rate that is not positive and finite.
    MissingExtraError
        If the extra ``render`` is not installed.
    """

    #: Slowest and fastest speed.
    SPEEDS = (1 / 16, 64.0)
    #: Frames per second that are drawn at most; at higher speeds some are left out.
    FASTEST_DRAWN = 60.0

    def __init__(self, width: int, height: int, fps: float) -> None:
        self._pygame = require_pygame()
        if not 0.0 < fps < np.inf:
            raise ParameterError(f"fps = {shown(fps)} is not accepted: a positive rate")
        self._renderer = renderer(width, height)
        self._fps = fps
        self._due = self._drawn = -np.inf
        self._single_step = False
        self.speed = 1.0
        self.paused = False
        self.is_open = True
        self._pygame.display.init()
        self._size = (width, height)
        self._surface = self._pygame.display.set_mode(self._size)
        self._report()

    def show(self, flock: Flock) -> None:
        """Show a flock, and return when the next step is due; at once if the window is closed."""
        if not self._has_display():
            return
        now = time.perf_counter()
        if self.paused or self._single_step or now - self._drawn >= 1 / self.FASTEST_DRAWN:
            self._draw(flock)
        self._single_step = False
        # Time lost to a slow policy or a pause is not caught up.
        self._due = max(self._due + 1 / (self._fps * self.speed), now)
        self._handle_events()
        while self.is_open and self._is_waiting():
            end_if_interrupted()
            time.sleep(self._pause_s())
            self._handle_events()

    def close(self) -> None:
        """Close the window; showing is without effect from then on."""
        if self.is_open:
            self.is_open = False
            self._pygame.display.quit()

    def _has_display(self) -> bool:
        """Whether the window is open, and no other one has taken its place."""
        display = self._pygame.display
        is_there = display.get_init() and self._surface.get_size() == self._size
        self.is_open = self.is_open and is_there
        return self.is_open

    def _draw(self, flock: Flock) -> None:
        rows = self._renderer.draw(flock.core)
        # pygame counts columns first.
        self._pygame.surfarray.blit_array(self._surface, rows.swapaxes(0, 1))
        self._pygame.display.flip()
        self._drawn = time.perf_counter()

    def _is_waiting(self) -> bool:
        if self.paused:
            return not self._single_step
        return time.perf_counter() < self._due

    def _pause_s(self) -> float:
        left = 1 / self.FASTEST_DRAWN
        return left if self.paused else min(max(self._due - time.perf_counter(), 0.0), left)

    def _handle_events(self) -> None:
        if not self._has_display():
            return
        for event in self._pygame.event.get():
            if event.type == self._pygame.QUIT:
                self.close()
                return
            if event.type == self._pygame.KEYDOWN:
                self._handle_key(event.key)

    def _handle_key(self, key: int) -> None:
        pygame = self._pygame
        slowest, fastest = self.SPEEDS
        if key == pygame.K_SPACE:
            self.paused = not self.paused
        elif key == pygame.K_RIGHT:
            self.paused = self._single_step = True
        elif key in (pygame.K_PLUS, pygame.K_EQUALS, pygame.K_KP_PLUS):
            self.speed = min(2 * self.speed, fastest)
        elif key in (pygame.K_MINUS, pygame.K_KP_MINUS):
            self.speed = max(self.speed / 2, slowest)
        self._report()

    def _report(self) -> None:
        state = "paused" if self.paused else f"{self.speed:g}×"
        self._pygame.display.set_caption(f"flockenv, {state}")
