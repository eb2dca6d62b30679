"""Law: what is masked in an array is refused, or not there; it is never read as a number.

Nor are numbers whose columns have names, which would be ignored.
"""

import numpy as np
import pytest

import flockenv
from flockenv.statistics.structure import structure_series

PARAMETERS = flockenv.FlockParameters(n_boats=5, n_leaders=2)


def masked(array: np.ndarray, *place: int) -> np.ma.MaskedArray:
    found = np.ma.masked_array(array)
    found[place] = np.ma.masked
    return found


def test_masked_states_rudders_and_masks_are_refused():
    flock = flockenv.Flock(PARAMETERS, 0)
    env = flockenv.LeadersVectorEnv(2, params=PARAMETERS)
    env.reset(seed=0)
    before = flock.snapshot(), env.get_state()
    for call in (
        lambda: flock.set_state(masked(flock.pose, 1, 0), flock.velocity),
        lambda: flock.set_state(flock.pose, masked(flock.velocity, 1, 0)),
        lambda: flock.advance(1.0, masked(np.zeros(2), 1)),
        lambda: env.step(masked(np.zeros((2, 2)), 0, 1)),
    ):
        with pytest.raises(flockenv.ParameterError, match="is masked"):
            call()
    with pytest.raises(TypeError, match="reset_mask"):
        env.reset(options={"reset_mask": masked(np.array([True, True]), 1)})
    assert (flock.snapshot(), env.get_state()) == before
    flock.set_state(np.ma.masked_array(flock.pose), flock.velocity)
    own = {"reward": lambda env: masked(np.ones(env.num_envs), 1)}
    (paid := flockenv.LeadersVectorEnv(2, params=PARAMETERS, **own)).reset(seed=0)
    with pytest.raises(flockenv.ParameterError, match="masked"):
        paid.step(np.zeros((2, 2)))


def test_tables_are_no_arrays():
    pandas = pytest.importorskip("pandas")
    flock = flockenv.Flock(PARAMETERS, 0)
    before = flock.snapshot()
    table = pandas.DataFrame(flock.pose[:, ::-1], columns=["heading_rad", "y_cm", "x_cm"])
    seen = pandas.DataFrame(flockenv.envs.observation.observe(flock))
    env = flockenv.LeadersVectorEnv(2, params=PARAMETERS)
    env.reset(seed=0)
    for call in (
        lambda: flock.set_state(table, flock.velocity),
        lambda: flockenv.Flock.from_state(PARAMETERS, 0, {"pose": table}),
        lambda: flockenv.simulate(PARAMETERS, 0, 1.0, start={"pose": table}),
        lambda: env.step(pandas.DataFrame(np.zeros((2, 2)))),
        lambda: flockenv.policies.SteeringLaw().predict(seen),
        lambda: flockenv.tracks.recording_of([0.0], table, pool="wide"),
        lambda: flockenv.order_series(table, table),
    ):
        with pytest.raises((TypeError, flockenv.ParameterError), match=r"table's to_numpy\(\)"):
            call()
    assert flock.snapshot() == before
    assert flock.advance(0.1, pandas.Series([0.5, 0.5])) is None


def test_boats_that_are_masked_are_not_there():
    pose = flockenv.Flock(PARAMETERS, 0).pose[None]
    gone, velocity = pose.copy(), np.zeros_like(pose)
    gone[0, 1] = np.nan
    found = flockenv.order_series(masked(pose, 0, 1), velocity)
    assert found == flockenv.order_series(gone, velocity)
    by_mask = structure_series("on_outer_wall", PARAMETERS, masked(pose, 0, 1))
    assert by_mask == structure_series("on_outer_wall", PARAMETERS, gone)
    own = {"mine": lambda run: masked(run.time_s, 1), "time": lambda run: run.time_s}
    run = flockenv.simulate(PARAMETERS, 0, 1.0, quantities=own)
    assert np.isnan(run.quantities["mine"]).tolist() == [False, True] + [False] * 9
    assert not np.shares_memory(run.quantities["time"], run.time_s)


@pytest.mark.parametrize("policy", [flockenv.policies.SteeringLaw(), "model"])
def test_observations_that_are_masked_are_refused(policy):
    env = flockenv.LeadersEnv(params=PARAMETERS)
    seen, _ = env.reset(seed=0)
    if policy == "model":
        stable_baselines3 = pytest.importorskip("stable_baselines3")
        venv = flockenv.sb3.LeaderVecEnv(1, params=PARAMETERS)
        policy = flockenv.policies.ModelPolicy(stable_baselines3.PPO("MlpPolicy", venv, n_steps=32))
    for given in (masked(seen, 0), {"leader_0": masked(seen, 0)}):
        with pytest.raises(flockenv.ParameterError, match="observation is masked"):
            policy.predict(given)
    whole = np.ma.masked_array(seen)
    assert np.array_equal(policy.predict(whole)[0], policy.predict(seen)[0])
