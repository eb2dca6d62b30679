"""Law: Ctrl-C ends long work at once, as a `KeyboardInterrupt`, and leaves everything as it was."""

import signal

import pytest

import flockenv
from flockenv import Flock, FlockParameters

#: Nearly as many boats as the pool holds: placing them takes seconds.
CROWD = FlockParameters(n_boats=5000, pool=(560.0, 10.0))


@pytest.mark.parametrize(
    "work",
    [
        lambda: Flock(CROWD, 1),
        lambda: flockenv.simulate(CROWD, 1, 1.0),
        lambda: flockenv.LeadersEnv(params=CROWD.replace(n_leaders=1)).reset(seed=1),
        lambda: flockenv.LeadersVectorEnv(3, params=CROWD.replace(n_leaders=1)).reset(seed=1),
    ],
)
def test_placement_can_be_interrupted(work, signaled_in_the_core):
    with pytest.raises(KeyboardInterrupt), signaled_in_the_core(signal.SIGINT):
        work()
