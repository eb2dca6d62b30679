"""Ctrl-C handled for a while."""

import signal
import sys
from _thread import interrupt_main
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Timer, current_thread, main_thread
from types import FrameType
from typing import Any

__all__ = ["held_interrupts", "interrupts_wait_for_imports", "on_interrupt"]

_PATIENCE_S = 0.02


class _AfterImports:
    """A handler that takes an action as soon as the main thread imports nothing.

    Compiled packages do not expect a Ctrl-C while they are imported: one in matplotlib's aborted
    the interpreter.
    """

    def __init__(self, action: Callable[[int, FrameType | None], Any]) -> None:
        self._action = action
        self._waits = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        if self._waits:
            return
        if not _importing():
            self._action(number, frame)
            return
        self._waits = True
        again = Timer(_PATIENCE_S, self._again)
        again.daemon = True
        again.start()

    def _again(self) -> None:
        self._waits = False
        if sys.platform == "win32":
            interrupt_main()
        else:
            # Unlike `interrupt_main`, it wakes a main thread that waits for a lock.
            signal.pthread_kill(main_thread().ident or 0, signal.SIGINT)


def _importing() -> bool:
    frame: FrameType | None = sys._getframe()
    while frame is not None:
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            return True
        frame = frame.f_back
    return False


_RAISING = _AfterImports(signal.default_int_handler)


@contextmanager
def interrupts_wait_for_imports() -> Iterator[None]:
    """Let a Ctrl-C within a `with` block raise `KeyboardInterrupt`, but not amid an import.

    Nothing changes elsewhere than in the main thread, nor where somebody handles Ctrl-C already.
    """
    before = signal.getsignal(signal.SIGINT)
    if before is not signal.default_int_handler or current_thread() is not main_thread():
        yield
        return
    signal.signal(signal.SIGINT, _RAISING)
    try:
        yield
    finally:
        if signal.getsignal(signal.SIGINT) is _RAISING:
            signal.signal(signal.SIGINT, before)


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
        As `signal.signal` takes it; a function is not called amid an import. It may set the default
        handler again.
    """
    before = signal.getsignal(signal.SIGINT)
    ours = before is _RAISING or before is signal.default_int_handler
    if not ours or current_thread() is not main_thread():
        yield
        return
    handler = action if isinstance(action, signal.Handlers) else _AfterImports(action)
    signal.signal(signal.SIGINT, handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


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
