"""Any control rate gives the same physics, also where its period is not a whole number of ticks."""

import numpy as np
import pytest

import flockenv

CROWD = {"n_boats": 27, "n_leaders": 3, "pool": "narrow", "episode_s": 20.0}


@pytest.mark.parametrize("control_hz", [0.7, 3.0, 9.99, 15.0, 24.0, 30.0, 60.0, 144.0, 1000.0])
@pytest.mark.parametrize("scheme", ["leapfrog", "moreau"])
def test_no_control_rate_kicks_boats(control_hz, scheme):
    venv = flockenv.LeadersVectorEnv(2, control_hz=control_hz, scheme=scheme, **CROWD)
    venv.reset(seed=0)
    fastest, steps = 0.0, 0
    truncated = np.zeros(2, bool)
    while not truncated.any():
        _, _, _, truncated, _ = venv.step(np.zeros((2, 3)))
        steps += 1
        fastest = max(fastest, *(np.abs(venv._batch.flock(i).velocity).max() for i in (0, 1)))
    # The motors drive at 15 cm/s.
    assert fastest < 20.0
    assert steps == round(20.0 * control_hz)


def test_lengths_are_rounded_to_whole_control_steps():
    for episode_s, steps in ((0.96, 10), (1.04, 10), (0.06, 1), (1.06, 11)):
        env = flockenv.LeadersEnv(n_boats=5, n_leaders=1, episode_s=episode_s)
        env.reset(seed=0)
        count = 1
        while not env.step([0.0])[3]:
            count += 1
        assert count == steps
