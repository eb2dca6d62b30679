"""Law: while a flock moves, other Python threads run; a flock in use elsewhere says so.

Threads may not take the interpreter from each other for a minute: this one continues only where the
other one releases it. How long the other one takes does not matter.
"""

import copy
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import pytest

import flockenv
from flockenv import Flock, InUseError, LeadersEnv


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


@pytest.mark.parametrize("use", [lambda each: each.advance(0), Flock.snapshot, copy.copy, repr])
def test_one_flock_in_two_threads_is_an_error_and_no_more(flock, use):
    message = "the flock is in use in another thread: each thread needs one of its own"
    with beside(lambda: flock.advance(600.0)), pytest.raises(InUseError, match=message):
        use(flock)
    assert flock.time_s == 600.0


@pytest.mark.parametrize(
    "use", [lambda env: env.step(np.zeros(2)), lambda env: env.reset(seed=1), LeadersEnv.get_state]
)
def test_one_environment_in_two_threads_is_an_error_and_no_more(use):
    env = LeadersEnv(n_boats=400, n_leaders=2, control_hz=0.1, episode_s=1e5)
    env.reset(seed=1)
    with beside(lambda: env.step(np.zeros(2))), pytest.raises(InUseError, match="the environment"):
        use(env)
