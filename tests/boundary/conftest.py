"""A small flock that every file here starts from."""

import gc
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest

import flockenv


@pytest.fixture
def parameters() -> flockenv.FlockParameters:
    return flockenv.FlockParameters.preset("simulation").replace(
        n_boats=12, n_leaders=2, pool="narrow"
    )


@pytest.fixture
def flock(parameters) -> flockenv.Flock:
    return flockenv.Flock(parameters, seed=7)


#: If Python's last frame is of these folders, it was the core that let go of the interpreter.
CALLERS = tuple(str(Path(each).parent) for each in (flockenv.__file__, __file__))


@pytest.fixture
def signaled_in_the_core() -> Callable[[int], AbstractContextManager[None]]:
    """Send a signal within a `with` block, once the core has let go of the interpreter.

    Threads may not take it from each other for a minute, so that no time decides when that is. No
    garbage is collected meanwhile: a callback of the collector that got the signal would keep it.
    """

    @contextmanager
    def signaled(number: int) -> Iterator[None]:
        ready, ended, worker = threading.Event(), threading.Event(), threading.get_ident()

        def send() -> None:
            ready.wait()
            while not ended.is_set():
                if sys._current_frames()[worker].f_code.co_filename.startswith(CALLERS):
                    return signal.raise_signal(number)
                time.sleep(0)  # The worker was reading a module: let it go on.
            return None

        thread, interval = threading.Thread(target=send), sys.getswitchinterval()
        thread.start()
        gc.disable()
        sys.setswitchinterval(60.0)
        ready.set()
        try:
            yield
        finally:
            ended.set()
            sys.setswitchinterval(interval)
            gc.enable()
            thread.join()

    return signaled
