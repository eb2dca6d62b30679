"""Law: while a flock moves, other Python threads run; a flock in use elsewhere says so.

Threads may not take the interpreter from each other for a minute: this one goes on only where the
other one releases it. How long the other one takes does not matter.
"""

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

import flockenv


@contextmanager
def beside(work: Callable[[], object]) -> Iterator[threading.Event]:
    """Start `work` in a thread, which sets the event once it has returned."""
    finished = threading.Event()

    def run() -> None:
        work()
        finished.set()

    interval = sys.getswitchinterval()
    sys.setswitchinterval(60.0)
    try:
        thread = threading.Thread(target=run)
        thread.start()
        yield finished
    finally:
        sys.setswitchinterval(interval)
        thread.join()


def test_work_that_keeps_the_interpreter_ends_before_others_run():
    with beside(lambda: sum(range(1_000_000))) as finished:
        assert finished.is_set()


def test_advance_lets_other_threads_run(flock):
    with beside(lambda: flock.advance(600.0)) as finished:
        assert not finished.is_set()


def test_simulate_lets_other_threads_run(parameters):
    with beside(lambda: flockenv.simulate(parameters, 1, 1000.0, 1.0)) as finished:
        assert not finished.is_set()


def test_one_flock_in_two_threads_is_an_error_and_no_more(flock):
    with beside(lambda: flock.advance(600.0)), pytest.raises(RuntimeError, match="borrowed"):
        flock.advance(0)
    assert flock.time_s == 600.0
