"""Law: while a flock moves, other Python threads run; a flock in use elsewhere says so."""

import threading
import time

import flockenv


def counted_while(work) -> int:
    """How often this thread looks up while `work` runs in another."""
    thread = threading.Thread(target=work)
    thread.start()
    turns = 0
    while thread.is_alive():
        time.sleep(0.001)
        turns += 1
    thread.join()
    return turns


def test_advance_lets_other_threads_run(flock):
    assert counted_while(lambda: flock.advance(600.0)) > 10


def test_simulate_lets_other_threads_run(parameters):
    assert counted_while(lambda: flockenv.simulate(parameters, 1, 1000.0, 1.0)) > 10


def test_one_flock_in_two_threads_is_an_error_and_no_more(flock):
    thread = threading.Thread(target=flock.advance, args=(2000.0,))
    thread.start()
    refusals = 0
    while thread.is_alive():
        try:
            flock.advance(0)
        except RuntimeError as error:
            refusals += "borrowed" in str(error)
    thread.join()
    assert refusals > 0
    assert flock.time_s == 2000.0
