"""One rule for Ctrl-C: a command finishes the work under way, keeps it, and ends.

While a command runs the signal is only noted. Work calls `end_if_interrupted` where nothing is half
done, and executors start no further run. A second signal ends the process at once. A request to
end, such as Slurm's before a job's time is over, counts as Ctrl-C, as does the end of the terminal.
Both the system and the shell report the end of a terminal, so this second signal does not end the
process at once.
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
_NOTED = b"\nEnding when the work under way is done. Ctrl-C again does not wait.\n"
_SHOW_CURSOR = b"\x1b[?25h"

_is_noted = False


def interrupted() -> bool:
    """Return whether Ctrl-C was noted, so that nothing more may be started."""
    return _is_noted


def end_if_interrupted() -> None:
    """Raise KeyboardInterrupt if Ctrl-C was noted; called only where no work is half done."""
    if _is_noted:
        raise KeyboardInterrupt


@contextmanager
def noted_interrupts() -> Iterator[None]:
    """Note Ctrl-C within a `with` block; a second one ends the process and its temporary files.

    Outside the main thread, or if Ctrl-C is ignored as under nohup, nothing changes.
    """
    global _is_noted
    found = {number: signal.getsignal(number) for number in _SIGNALS}
    before = {number: now for number, now in found.items() if now not in (signal.SIG_IGN, None)}
    if _note in before.values() or current_thread() is not main_thread():
        yield
        return
    for number in before:
        signal.signal(number, _note)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        _is_noted = False


def _note(number: int, frame: object) -> None:
    global _is_noted
    if not _is_noted or number == _HANGUP:
        _is_noted = True
        _write(_NOTED)
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
