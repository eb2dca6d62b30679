"""How a script ends early: in one line."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import flockenv


@contextmanager
def one_line_end(stored: Callable[[], str]) -> Iterator[None]:
    """Let Ctrl-C and named errors end a script in one line; `stored` returns what remains then."""
    try:
        yield
    except KeyboardInterrupt:
        sys.exit(f"Interrupted: {stored()}")
    except (flockenv.FlockError, OSError) as error:
        sys.exit(f"Error: {error}")
