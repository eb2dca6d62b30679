"""Law: ``physics="training"`` is dt_s = 0.1 s with one relinearization, and nothing else."""

import numpy as np
import pytest

import flockenv
from flockenv import FlockParameters

PARAMETERS = {"n_boats": 9, "n_leaders": 2, "bw_s": 0.3, "episode_s": 2.0}
SAME = {
    "training": {"dt_s": 0.1, "relinearizations": 1},
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


def test_training_is_not_the_default():
    assert not np.array_equal(_episode(physics="training"), _episode())


def test_parameters_that_are_given_are_stepped_as_chosen():
    params = FlockParameters(**{k: PARAMETERS[k] for k in ("n_boats", "n_leaders", "bw_s")})
    env = flockenv.LeadersEnv(params=params, episode_s=2.0, physics="training")
    assert env.parameters.dt_s == 0.1
    assert env.parameters.relinearizations == 1
    env.close()
