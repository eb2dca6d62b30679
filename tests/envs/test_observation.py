"""Law: an observation says what the flock does, in LAP axes, by the table that the docs print."""

import math

import numpy as np
import pytest

import flockenv
from flockenv.envs.observation import observation_entries, observe, state_entries

OPEN = {"pool": (200.0, 0.0), "c4": 0.0}


def named(row, entries):
    """Numbers by (block, place, name)."""
    assert len(row) == len(entries)
    return {
        (entry.block, entry.place, entry.name): float(value)
        for entry, value in zip(entries, row, strict=True)
    }


def flock_of(pose, velocity=None, n_leaders=1, **fields):
    pose = np.array(pose, float)
    parameters = flockenv.FlockParameters(n_boats=len(pose), n_leaders=n_leaders).replace(
        **{**OPEN, **fields}
    )
    flock = flockenv.Flock(parameters, seed=0)
    flock.set_state(pose, np.zeros_like(pose) if velocity is None else velocity)
    return flock


def observed(flock, **blocks):
    return named(observe(flock, blocks)[0], observation_entries(blocks))


def test_a_boat_on_the_x_axis():
    # At (100, 0): outward is +x, clockwise is -y. It heads along -y (clockwise) and drifts outward.
    flock = flock_of([[100, 0, -math.pi / 2], [0, 30, 0]], [[3, -6, -0.5], [0, 0, 0]])
    seen = observed(flock)
    own = {name: value for (block, _, name), value in seen.items() if block == "own"}
    assert own == pytest.approx(
        {
            "radial_position": 2 * 100 / 195 - 1,
            "cos_orientation": 0.0,
            "sin_orientation": 1.0,
            "outward_velocity": 3 / 15,
            "clockwise_velocity": 6 / 15,
            "forward_velocity": 6 / 15,
            "clockwise_spin": 0.25,
            "rudder": 0.0,
        },
        abs=1e-6,
    )
    assert seen["target", 0, "target"] == 1.0


def test_phase_and_noise_level():
    flock = flock_of([[100, 0, 0], [0, 30, 0]], bw_s=0.4)
    for time_s, phase, left in ((0.5, "fw", 1.5), (2.25, "nop1", 0.75), (3.1, "bw", 0.3)):
        flock.set_state(flock.pose, flock.velocity, time_s)
        seen = observed(flock)
        flags = {name: seen["phase", 0, name] for name in ("fw", "nop1", "bw", "nop2")}
        assert flags == {name: float(name == phase) for name in flags}
        assert seen["phase", 0, "time_left"] == pytest.approx(left / 2)
        assert seen["phase", 0, "bw_duration"] == pytest.approx(0.4)


def test_neighbors_come_nearest_first_and_missing_ones_are_zero():
    # Seen from the leader at (100, 0): boat 1 is 30 cm outward, boat 2 (a leader) 20 cm clockwise.
    pose = [[100, 0, 0], [100, -20, math.pi / 2], [130, 0, -math.pi / 2]]
    velocity = [[0, 0, 0], [15, 0, 0], [0, -7.5, 0]]
    seen = observed(flock_of(pose, velocity, n_leaders=2), neighbors=3)
    near = [
        {name: value for (block, at, name), value in seen.items() if (block, at) == place}
        for place in (("neighbors", 0), ("neighbors", 1), ("neighbors", 2))
    ]
    names = [entry.name for entry in observation_entries() if entry.block == "neighbors"][:8]
    expected = (
        [1, 0, 20 / 30, 0, -1, 1, 0, 1],
        [1, 1, 0, 0, 1, 0, 0.5, 0],
        [0, 0, 0, 0, 0, 0, 0, 0],
    )
    for found, values in zip(near, expected, strict=True):
        assert found == pytest.approx(dict(zip(names, values, strict=True)), abs=1e-6)


def test_order_is_that_of_the_normal_boats():
    parameters = flockenv.FlockParameters(n_boats=12, n_leaders=3)
    flock = flockenv.Flock(parameters, seed=3)
    flock.advance(2.0)
    order, seen = flock.order_parameters(), observed(flock)
    found = [
        seen["order", 0, entry.name] for entry in observation_entries() if entry.block == "order"
    ]
    np.testing.assert_allclose(
        found,
        [
            order.psi_o * math.cos(order.phi_o),
            order.psi_o * math.sin(order.phi_o),
            order.psi_v * math.cos(order.phi_v) / 15,
            order.psi_v * math.sin(order.phi_v) / 15,
        ],
        atol=1e-7,
    )


@pytest.mark.parametrize("off", ["own", "phase", "target", "neighbors", "order"])
def test_blocks_can_be_switched_off(off):
    flock = flockenv.Flock(flockenv.FlockParameters(n_boats=12, n_leaders=3), seed=3)
    entries = observation_entries()
    left = [place for place, entry in enumerate(entries) if entry.block != off]
    blocks = {off: 0 if off == "neighbors" else False}
    np.testing.assert_array_equal(observe(flock, blocks), observe(flock)[:, left])
    env = flockenv.LeadersEnv(observation=blocks)
    assert env.observation_space.shape == (3 * len(left),)
    env.reset(seed=0)


def test_a_block_at_the_end_leaves_the_others_where_they_are():
    parameters = flockenv.FlockParameters(n_boats=9, n_leaders=3, discs=[(140, 0, 10)])
    flock = flockenv.Flock(parameters, seed=4)
    plain, longer = observe(flock), observe(flock, {"obstacles": 2})
    assert longer[:, : plain.shape[1]].tobytes() == plain.tobytes()
    for count in (65, -1, 2.5, 10**30):
        with pytest.raises(flockenv.ParameterError, match="observation obstacles"):
            flockenv.LeadersEnv(observation={"obstacles": count})


def test_environment_and_flock_see_the_same():
    env = flockenv.LeadersEnv(episode_s=10.0)
    env.reset(seed=1)
    for step in range(30):
        rudder = np.random.default_rng(step).uniform(-1, 1, 3)
        observation = env.step(rudder)[0]
        np.testing.assert_array_equal(observation.reshape(3, -1), observe(env.flock, rudder=rudder))


def test_clip_rate_counts_what_is_clipped():
    # Boats at 30 cm/s are observed at their bound of 2: the state is given, so nothing slows them.
    env = flockenv.LeadersEnv(
        n_boats=4,
        n_leaders=1,
        episode_s=0.1,
        speed_cm_s=1.0,
        reverse_speed_cm_s=1.0,
        observation={"neighbors": 0, "order": False},
    )
    env.reset(seed=0)
    state = {"pose": env.flock.pose, "velocity": np.array([[20.0, 0, 0]] * 4)}
    observation, _ = env.reset(options={"state": state})
    assert np.abs(observation).max() == 2.0
    info = env.step(np.zeros(1))[4]
    assert 0.05 < info["episode_summary"]["clip_rate"] < 0.4
    assert observation in env.observation_space


def test_state_describes_every_boat():
    env = flockenv.LeadersEnv(n_boats=5, n_leaders=2, episode_s=10.0)
    env.reset(seed=0)
    for _ in range(25):
        env.step(np.array([0.5, -1.0]))
    state = env.state()
    assert state in env.state_space
    entries = named(state, state_entries(5))
    pose, velocity = env.flock.pose, env.flock.velocity
    for boat, ((x, y, heading), (vx, vy, spin)) in enumerate(zip(pose, velocity, strict=True)):
        theta = math.atan2(y, x)
        expected = {
            "cos_polar_angle": math.cos(theta),
            "sin_polar_angle": math.sin(theta),
            "cos_orientation": math.cos(theta - heading),
            "sin_orientation": math.sin(theta - heading),
            "outward_velocity": (vx * math.cos(theta) + vy * math.sin(theta)) / 15,
            "clockwise_velocity": (vx * math.sin(theta) - vy * math.cos(theta)) / 15,
            "clockwise_spin": -spin / 2,
            "rudder": [0.5, -1, 0, 0, 0][boat],
            "is_leader": float(boat < 2),
        }
        found = {name: entries["boat", boat, name] for name in expected}
        assert found == pytest.approx(expected, abs=1e-6)
    assert entries["clock", 0, "episode_elapsed"] == pytest.approx(0.25)


def test_infinite_pools_are_observed():
    env = flockenv.LeadersEnv(n_boats=6, n_leaders=1, pool=(math.inf, 0.0), episode_s=5.0)
    observation, _ = env.reset(seed=0)
    for _ in range(50):
        assert observation in env.observation_space
        observation = env.step(np.ones(1))[0]
