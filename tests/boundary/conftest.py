"""A small flock that every file here starts from."""

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

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


@pytest.fixture
def signaled_in_the_core() -> Callable[[int], AbstractContextManager[None]]:
    """Send a signal within a `with` block, once this thread lets go of the interpreter.

    Threads may not take it from each other for a minute, so that no time decides when that is.
    """

    @contextmanager
    def signaled(number: int) -> Iterator[None]:
        ready = threading.Event()

        def send() -> None:
            ready.wait()
            signal.raise_signal(number)

        thread, interval = threading.Thread(target=send), sys.getswitchinterval()
        thread.start()
        sys.setswitchinterval(60.0)
        ready.set()
        try:
            yield
        finally:
            sys.setswitchinterval(interval)
            thread.join()

    return signaled
