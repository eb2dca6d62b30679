"""Law: a choice of physics is a step and a tolerance, and nothing else."""

import numpy as np
import pytest

import flockenv
from flockenv import FlockParameters

PARAMETERS = {"n_boats": 9, "n_leaders": 2, "bw_s": 0.3, "episode_s": 2.0}
SAME = {
    "training": {"dt_s": 0.1, "tolerance_cm": 1e-4},
    "publication": {"dt_s": 0.01, "tolerance_cm": 1e-6},
    "default": {},
}


def _episode(**options):
    env = flockenv.LeadersEnv(**PARAMETERS, **options)
    observation, _ = env.reset(seed=5)
    steps = [observation]
    for _ in range(20):
        observation, reward, *_ = env.step(np.array([0.5, -0.5]))
        steps.append(np.append(observation, reward))
    env.close()
    return np.concatenate([np.ravel(step) for step in steps])


@pytest.mark.parametrize("physics", SAME)
def test_physics_are_fields_of_the_parameters(physics):
    np.testing.assert_array_equal(_episode(physics=physics), _episode(**SAME[physics]))


@pytest.mark.parametrize("physics", ["training", "publication"])
def test_no_other_physics_is_the_default(physics):
    assert not np.array_equal(_episode(physics=physics), _episode())


def test_parameters_that_are_given_are_stepped_as_chosen():
    params = FlockParameters(**{k: PARAMETERS[k] for k in ("n_boats", "n_leaders", "bw_s")})
    env = flockenv.LeadersEnv(params=params, episode_s=2.0, physics="training")
    assert env.parameters.dt_s == 0.1
    assert env.parameters.tolerance_cm == 1e-4
    env.close()
