"""Law: what a user's notebook relies on keeps its meaning."""

import gymnasium
import numpy as np
import pytest

import flockenv

PARAMETERS = flockenv.FlockParameters(n_boats=4, n_leaders=1, pool="narrow")
#: An environment takes each of these; fields of the parameters stand for all of theirs.
ENVIRONMENT_OPTIONS = {
    "preset": {"preset": "paper"},
    "params": {"params": PARAMETERS},
    "fields": {"n_boats": 5, "bw_s": 0.4, "pool": "narrow"},
    "target": {"target": "random"},
    "episode_s": {"episode_s": 960.0},
    "control_hz": {"control_hz": 5.0},
    "reward": {"reward": {"signed_order": 1.0, "leader_velocity": 0.5}},
    "observation": {"observation": {"neighbors": 4, "order": False}},
    "action_mode": {"action_mode": "lean"},
    "decision_period_s": {"decision_period_s": 0.5},
    "physics": {"physics": "training"},
    "render_mode": {"render_mode": "rgb_array"},
}


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


@pytest.mark.parametrize("name", ENVIRONMENT_OPTIONS)
def test_environments_take_their_options_in_every_form(name):
    option = ENVIRONMENT_OPTIONS[name]
    flockenv.parallel_env(**option)
    gymnasium.make("flockenv/Leaders-v0", **option)
    gymnasium.make_vec("flockenv/Leaders-v0", num_envs=1, **option)
    if name != "render_mode":
        flockenv.sb3.LeaderVecEnv(1, **option)


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
