"""The render modes behind the environments' `render`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from flockenv._io.arguments import listed
from flockenv.errors import ParameterError, short_repr
from flockenv.rendering.frames import DEFAULT_SIZE, frame, renderer
from flockenv.rendering.window import Window, require_pygame

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from flockenv.flock import Flock

#: Render modes of environments with one flock; environments with many have only "rgb_array".
RENDER_MODES = ("human", "rgb_array")


class RenderMode:
    """The render mode of an environment, the size of its frames, and its window if it has one.

    Copies and unpickled objects have the same mode and size, and no window until they render.
    """

    def __init__(
        self,
        mode: str | None,
        size: object,
        fps: float,
        modes: tuple[str, ...] = RENDER_MODES,
    ) -> None:
        if mode is not None and mode not in modes:
            names = ", ".join(repr(name) for name in modes)
            raise ParameterError(f"render_mode = {short_repr(mode)} is not accepted: None, {names}")
        size = listed(size)
        if not isinstance(size, tuple | list) or len(size) != 2:
            raise ParameterError(
                f"render_size = {short_repr(size)} is not accepted: (width, height)"
            )
        self.mode = mode
        self.size = (size[0], size[1])
        self.fps = fps
        self._window: Window | None = None
        #: Time of the flock in s when it was last shown.
        self._shown_s: float | None = None
        self._closed = False
        # Raise the errors for wrong sizes and missing extras before anything is simulated.
        if mode is not None or self.size != DEFAULT_SIZE:
            renderer(*self.size)
        if mode == "human":
            require_pygame()

    @property
    def is_live(self) -> bool:
        """Whether every step is shown in a window."""
        return self.mode == "human" and not self._closed

    def frame(self, flock: Flock) -> NDArray[np.uint8]:
        """Return a flock's frame, (height, width, 3)."""
        return frame(flock, *self.size)

    def show(self, flock: Flock) -> None:
        """Show a flock in the window, which opens if needed, but never again after `close`."""
        if self._closed:
            return
        if self._window is None:
            self._window = Window(*self.size, fps=self.fps)
        self._window.show(flock)
        self._shown_s = flock.time_s
        if not self._window.is_open:
            self.close()

    def render(self, flock: Flock) -> NDArray[np.uint8] | None:
        """Render the flock, as `render` of an environment with one flock does."""
        if self.mode == "rgb_array":
            return self.frame(flock)
        # Showing waits for the next frame's time, so a step is shown only once.
        if self._window is None or flock.time_s != self._shown_s:
            self.show(flock)
        return None

    def close(self) -> None:
        """Close the window; it is never opened again."""
        self._closed = True
        if self._window is not None:
            self._window.close()
            self._window = None

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_window": None}
