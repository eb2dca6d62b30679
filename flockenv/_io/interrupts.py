"""Ctrl-C handled for a while."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread
from types import FrameType

__all__ = ["on_interrupt"]


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
