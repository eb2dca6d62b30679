"""The console script: the command line, which Ctrl-C ends in a line before and after a command.

It stands beside the package, because importing anything in the package imports the package.
"""

import os
import signal
from types import FrameType

__all__ = ["main"]


def main() -> None:
    """Run the command line."""
    # Where Ctrl-C is ignored, as under nohup, it stays so.
    is_ours = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if is_ours:
        signal.signal(signal.SIGINT, _end)
    from flockenv.cli import main as command_line

    command_line()


def _end(number: int, frame: FrameType | None) -> None:
    """End at once, as nothing is at work; an exception would pass through half of an import."""
    os.write(2, b"Interrupted.\n")
    os._exit(130)
