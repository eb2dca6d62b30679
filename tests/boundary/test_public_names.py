"""Law: what a user's notebook relies on keeps its meaning."""

import gymnasium
import numpy as np
import pytest

import flockenv

PARAMETERS = flockenv.FlockParameters(n_boats=4, n_leaders=1, pool="narrow")


def test_environments_are_made_as_they_were():
    options = {"n_boats": 4, "n_leaders": 2, "target": "random", "episode_s": 1.0, "control_hz": 2}
    agents = flockenv.parallel_env(**options)
    agents.reset(seed=0)
    assert agents.agents == ["leader_0", "leader_1"]
    single = gymnasium.make("flockenv/Leaders-v0", **options)
    assert single.action_space.shape == (2,)
    several = gymnasium.make_vec("flockenv/Leaders-v0", num_envs=3, **options)
    assert isinstance(several.unwrapped, flockenv.LeadersVectorEnv)
    observations, _ = single.reset(seed=0)
    assert np.isfinite(flockenv.policies.SteeringLaw().predict(observations)[0]).all()


@pytest.mark.parametrize(
    ("target", "steps"), [("cw", 48), ("ccw", 48), ("random", 48), ("alternate", 96)]
)
def test_an_episode_lasts_eight_minutes_and_sixteen_where_targets_alternate(target, steps):
    env = flockenv.parallel_env(n_boats=2, n_leaders=1, target=target, control_hz=0.1)
    env.reset(seed=0)
    taken = 0
    while env.agents:
        env.step({"leader_0": np.zeros(1)})
        taken += 1
    assert taken == steps


def test_errors_are_of_their_classes():
    assert {flockenv.FlockError, ValueError} <= {*flockenv.ParameterError.__mro__}
    assert {flockenv.FlockError, RuntimeError} <= {*flockenv.SolverError.__mro__}
