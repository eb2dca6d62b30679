"""Ctrl-C handled for a while."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread
from types import FrameType
from typing import Any

__all__ = ["held_interrupts", "on_interrupt"]


@contextmanager
def on_interrupt(
    action: Callable[[int, FrameType | None], None] | signal.Handlers,
) -> Iterator[None]:
    """Let Ctrl-C do something else than raise `KeyboardInterrupt` within a `with` block.

    Nothing changes elsewhere than in the main thread, where none arrives, nor where somebody
    ignores Ctrl-C (as nohup does) or handles it already.

    Parameters
    ----------
    action
        As `signal.signal` takes it. It may set the default handler again.
    """
    ours = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if not ours or current_thread() is not main_thread():
        yield
        return
    signal.signal(signal.SIGINT, action)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@contextmanager
def held_interrupts() -> Iterator[Callable[[], None]]:
    """Hold back a Ctrl-C within a `with` block; it acts at the block's end, a second one at once.

    Packages do not expect one everywhere: amid an entry of an archive `zipfile` raises a ValueError
    in its place, one in the middle of tensorboard's writing leaves a queue whose closing waits for
    ever, and one in torch's backward pass leaves gradients off. Nothing changes outside of the main
    thread, nor where somebody ignores Ctrl-C. An error within the block takes the Ctrl-C's place.

    Yields
    ------
    Callable
        Lets what is held back act, if anything: for places within the block that can be left.

    Raises
    ------
    KeyboardInterrupt
        At the end of the block, if one was held back.
    """
    handler = signal.getsignal(signal.SIGINT)
    if not callable(handler) or current_thread() is not main_thread():
        yield lambda: None
        return
    held: list[Any] = []

    def hold(*arrived: Any) -> None:
        if held:
            held.clear()
            signal.signal(signal.SIGINT, handler)
            handler(*arrived)
        held.append(arrived)

    def release() -> None:
        if held:
            signal.signal(signal.SIGINT, handler)
            handler(*held.pop())

    signal.signal(signal.SIGINT, hold)
    try:
        yield release
    finally:
        if signal.getsignal(signal.SIGINT) is hold:
            signal.signal(signal.SIGINT, handler)
    release()
