"""Law: every interface takes the same seeds and refuses the same, with the same kind of error."""

import gymnasium
import numpy as np
import pytest
from pettingzoo.utils.conversions import parallel_to_aec

import flockenv
from flockenv import ParameterError

OPTIONS = {"n_boats": 6, "n_leaders": 1, "episode_s": 2.0}
PARAMETERS = flockenv.FlockParameters(n_boats=6, n_leaders=1)


def poses_of(make, reset=lambda env, seed: env.reset(seed=seed)):
    """Return what starts an environment with a seed, and looks at its first flock."""

    def started(seed):
        env = make()
        reset(env, seed)
        return env.unwrapped._batch.flock(0).pose

    return started


def slots():
    pytest.importorskip("stable_baselines3")
    from flockenv.sb3 import LeaderVecEnv

    return LeaderVecEnv(1, **OPTIONS)


INTERFACES = [
    poses_of(lambda: flockenv.LeadersEnv(**OPTIONS)),
    poses_of(lambda: gymnasium.make("flockenv/Leaders-v0", **OPTIONS)),
    poses_of(lambda: flockenv.parallel_env(**OPTIONS)),
    poses_of(lambda: parallel_to_aec(flockenv.parallel_env(**OPTIONS))),
    poses_of(lambda: flockenv.LeadersVectorEnv(1, **OPTIONS)),
    poses_of(lambda: flockenv.LeadersVectorEnv(1, **OPTIONS), lambda env, s: env.reset(seed=[s])),
    poses_of(slots, lambda env, seed: (env.seed(seed), env.reset())),
]


@pytest.mark.parametrize("place", INTERFACES)
@pytest.mark.parametrize(
    "seed",
    [
        *(0, 7, 2**63, 2**64 - 1, np.int64(7), np.uint64(2**64 - 1), np.array(7)),
        *(3.0, 2.0**53, np.float64(1.0), np.float32(5.0), np.array(7.0)),
    ],
    ids=repr,
)
def test_seeds_that_are_taken(place, seed):
    np.testing.assert_array_equal(place(seed), flockenv.Flock(PARAMETERS, int(seed)).pose)


@pytest.mark.parametrize("place", [lambda seed: flockenv.Flock(PARAMETERS, seed), *INTERFACES])
@pytest.mark.parametrize(
    ("seed", "error"),
    [
        (-1, ParameterError),
        (2**64, ParameterError),
        (1.5, ParameterError),
        (2.0**64, ParameterError),
        (-1.0, ParameterError),
        (np.float64(1.5), ParameterError),
        (float("nan"), ParameterError),
        (True, TypeError),
        (np.True_, TypeError),
        ("1", TypeError),
        (b"1", TypeError),
        (np.float32(1.5), (ParameterError, TypeError)),
        (1 + 0j, TypeError),
        (np.array([[1]]), (ParameterError, TypeError)),
        ({}, TypeError),
    ],
    ids=repr,
)
def test_seeds_that_are_refused(place, seed, error):
    with pytest.raises((ParameterError, TypeError)) as caught:
        place(seed)
    assert isinstance(caught.value, error), caught.value
