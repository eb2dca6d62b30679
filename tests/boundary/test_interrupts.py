"""Law: Ctrl-C ends long work at once, as a `KeyboardInterrupt`, and leaves everything as it was."""

import signal
import threading

import pytest

import flockenv
from flockenv import Flock, FlockParameters

#: Nearly as many boats as the pool holds: placing them takes seconds.
CROWD = FlockParameters(n_boats=5000, pool=(560.0, 10.0))


@pytest.fixture
def pressed():
    """Ctrl-C, 0.3 s from now."""
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    yield
    timer.cancel()


@pytest.mark.parametrize(
    "work",
    [
        lambda: Flock(CROWD, 1),
        lambda: flockenv.simulate(CROWD, 1, 1.0),
        lambda: flockenv.LeadersEnv(params=CROWD.replace(n_leaders=1)).reset(seed=1),
        lambda: flockenv.LeadersVectorEnv(3, params=CROWD.replace(n_leaders=1)).reset(seed=1),
    ],
)
def test_placement_can_be_interrupted(work, pressed):
    with pytest.raises(KeyboardInterrupt):
        work()
