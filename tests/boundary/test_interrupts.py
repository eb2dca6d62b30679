"""Law: Ctrl-C ends long work at once, as a `KeyboardInterrupt`, and leaves everything as it was."""

import signal

import numpy as np
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


#: Each substep takes long, and all of them together take minutes.
HEAVY = FlockParameters(n_boats=300, n_leaders=1, speed_cm_s=1e5, c1=6.0)


@pytest.mark.parametrize(
    "work",
    [
        lambda: Flock(HEAVY, 1).advance(60.0),
        lambda: flockenv.simulate(HEAVY, 1, 60.0),
        lambda: flockenv.simulate(HEAVY, 1, 60.0, policy="damped law"),
    ],
)
def test_costly_substeps_can_be_interrupted(work, signaled_in_the_core):
    with pytest.raises(KeyboardInterrupt), signaled_in_the_core(signal.SIGINT):
        work()


def test_a_step_of_a_batch_can_be_interrupted_and_asks_for_a_reset(signaled_in_the_core):
    envs = flockenv.LeadersVectorEnv(8, params=HEAVY, control_hz=0.1)
    envs.reset(seed=1)
    actions = np.zeros(envs.action_space.shape, np.float32)
    with pytest.raises(KeyboardInterrupt), signaled_in_the_core(signal.SIGINT):
        envs.step(actions)
    with pytest.raises(flockenv.EpisodeError, match="reset"):
        envs.step(actions)
    envs.reset(seed=1)
