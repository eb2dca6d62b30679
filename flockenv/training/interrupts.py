"""Ctrl-C held back where stopping in the middle would break what is at work."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from flockenv._io.interrupts import on_interrupt

__all__ = ["held_interrupts"]


@contextmanager
def held_interrupts() -> Iterator[Callable[[], None]]:
    """Hold back a Ctrl-C within a `with` block; it is raised at the block's end.

    An interrupt in the middle of tensorboard's writing leaves a queue whose closing waits for
    ever, and one in torch's backward pass leaves gradients off. A second Ctrl-C is not held back.

    Yields
    ------
    Callable
        Raises what is held back, if anything: for places within the block that can be left.

    Raises
    ------
    KeyboardInterrupt
        At the end of the block, if one was held back.
    """
    held = False

    def hold(number: int, frame: FrameType | None) -> None:
        nonlocal held
        held = True
        signal.signal(signal.SIGINT, signal.default_int_handler)

    def release() -> None:
        if held:
            raise KeyboardInterrupt

    with on_interrupt(hold):
        yield release
    release()
