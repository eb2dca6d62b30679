"""One rule for Ctrl-C: a command finishes the work under way, keeps it, and ends.

While a command runs, the first signal is only noted. Executors then start no further run, and the
command ends at its next call of `end_if_interrupted`, between two pieces of work. A second signal
ends the process at once. A request to end (SIGTERM, such as Slurm's before a job's time is over)
counts as Ctrl-C, as does the end of the terminal (SIGHUP). Both the system and the shell send
SIGHUP, so a second SIGHUP does not end the process at once.
"""

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from threading import current_thread, main_thread

from flockenv._io.atomic_write import remove_temporary_files

INTERRUPTED = 130
"""Exit code after Ctrl-C."""

_HANGUP = getattr(signal, "SIGHUP", None)  # None on Windows.
_SIGNALS = (signal.SIGINT, signal.SIGTERM, *(() if _HANGUP is None else (_HANGUP,)))
_ENDING_SOON = b"\nEnding when the work under way is done. Ctrl-C again does not wait.\n"
_SHOW_CURSOR = b"\x1b[?25h"

_is_noted = False


def interrupted() -> bool:
    """Return whether Ctrl-C was noted; if so, no further run may be started."""
    return _is_noted


def end_if_interrupted() -> None:
    """Raise KeyboardInterrupt if Ctrl-C was noted; to be called between two pieces of work."""
    if _is_noted:
        raise KeyboardInterrupt


@contextmanager
def noted_interrupts() -> Iterator[None]:
    """Note Ctrl-C within a `with` block; a second one removes temporary files and ends the process.

    Blocks inside another such block, and blocks outside the main thread, change nothing. Signals
    that are ignored, as under nohup, stay ignored.
    """
    global _is_noted
    present_handlers = {number: signal.getsignal(number) for number in _SIGNALS}
    to_restore = {
        number: handler
        for number, handler in present_handlers.items()
        if handler not in (signal.SIG_IGN, None)
    }
    is_nested = _note in to_restore.values()
    if is_nested or current_thread() is not main_thread():
        yield
        return
    for number in to_restore:
        signal.signal(number, _note)
    try:
        yield
    finally:
        for number, handler in to_restore.items():
            signal.signal(number, handler)
        _is_noted = False


def _note(number: int, frame: object) -> None:
    """Handle a signal: note the first one, and end the process at the second one."""
    global _is_noted
    if not _is_noted or number == _HANGUP:
        _is_noted = True
        _write(_ENDING_SOON)
        return
    try:
        remove_temporary_files()
        if os.isatty(2):
            _write(_SHOW_CURSOR)
    finally:
        os._exit(INTERRUPTED)


def _write(text: bytes) -> None:
    # The interruption may have hit Python's own streams.
    with suppress(OSError):
        os.write(2, text)
