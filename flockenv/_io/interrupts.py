"""Ctrl-C handled for a while."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread
from types import FrameType
from typing import Any

__all__ = ["interrupt_held", "on_interrupt"]


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
def interrupt_held() -> Iterator[None]:
    """Hold a Ctrl-C back until the end of a `with` block; a second one acts at once.

    Packages that an exception cuts off anywhere raise others instead, as `zipfile` does amid an
    entry, and the Ctrl-C would be lost. Nothing changes outside of the main thread.
    """
    handler = signal.getsignal(signal.SIGINT)
    if not callable(handler) or current_thread() is not main_thread():
        yield
        return
    held: list[tuple[int, FrameType | None]] = []

    def hold(*arrived: Any) -> None:
        held.append(arrived)
        if len(held) > 1:
            held.clear()
            signal.signal(signal.SIGINT, handler)
            handler(*arrived)

    signal.signal(signal.SIGINT, hold)
    try:
        yield
    finally:
        if signal.getsignal(signal.SIGINT) is hold:
            signal.signal(signal.SIGINT, handler)
        if held:
            handler(*held[0])
