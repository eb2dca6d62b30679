"""Law: with mirror_to_target both directions are one task, by the physics' mirror symmetry."""

import numpy as np
import pytest

import flockenv
from flockenv.envs.observation import observation_entries, state_entries

BLOCKS = {"obstacles": 2}
#: The disc is its own mirror image.
ARENA = {"n_boats": 12, "n_leaders": 3, "observation": BLOCKS, "discs": [(140.0, 0.0, 10.0)]}
QUIET = {**ARENA, "c4": 0.0, "episode_s": 20.0, "mirror_to_target": True}
FLIP = np.array([1.0, -1.0, -1.0])


def start():
    """A moving flock, some of it in contact, and its mirror image in the x axis."""
    env = flockenv.LeadersEnv(**QUIET)
    env.reset(seed=4)
    for _ in range(40):
        env.step(np.array([0.5, -0.5, 1.0]))
    state = {"pose": env.flock.pose, "velocity": env.flock.velocity, "time_s": env.flock.time_s}
    mirrored = {**state, "pose": state["pose"] * FLIP, "velocity": state["velocity"] * FLIP}
    return state, mirrored


def pair(**options):
    """The clockwise task, and the counter-clockwise one from the mirror image."""
    envs = [flockenv.LeadersEnv(**{**QUIET, **options}) for _ in range(2)]
    observations = [
        env.reset(seed=0, options={"state": state, "target": target})[0]
        for env, state, target in zip(envs, start(), ("cw", "ccw"), strict=True)
    ]
    return envs, observations


@pytest.mark.parametrize("options", [{}, {"rudder_levels": 7}, {"rudder_lag_s": 0.2}])
def test_mirror_images_are_one_task(options):
    envs, observations = pair(**options)
    envs[0].action_space.seed(1)
    touched = 0
    for _ in range(100):
        np.testing.assert_allclose(*observations, atol=2e-5)
        np.testing.assert_allclose(envs[0].state(), envs[1].state(), atol=2e-5)
        action = envs[0].action_space.sample()
        results = [env.step(action) for env in envs]
        observations = [result[0] for result in results]
        assert results[0][1] == pytest.approx(results[1][1], abs=1e-6)
        touched += len(envs[0].flock.contacts().force.nonzero()[0])
    assert touched > 50
    np.testing.assert_allclose(envs[0].flock.pose * FLIP, envs[1].flock.pose, atol=1e-5)


def signs_of(entries):
    return np.array([-1.0 if each.mirrored else 1.0 for each in entries], np.float32)


SIGNS, STATE_SIGNS = signs_of(observation_entries(BLOCKS)), signs_of(state_entries(12))
TERMS = {"signed_order": 1.0, "leader_velocity": 0.25, "rudder_effort": 0.125, "jam": 2.0}


@pytest.mark.parametrize("target", ["ccw", "random", "alternate"])
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"rudder_levels": 4},
        {"rudder_lag_s": 0.3, "rudder_rate_per_s": 2.0},
        {"dropout_rate": 0.3, "delay_frames": 1},
    ],
)
def test_mirroring_reflects_what_its_table_says_bit_for_bit(target, options):
    parameters = {**ARENA, "episode_s": 8.0, "reward": TERMS, "target": target}
    plain = flockenv.LeadersEnv(**parameters, **options)
    mirrored = flockenv.LeadersEnv(**parameters, **options, mirror_to_target=True)
    seen, _ = plain.reset(seed=3)
    reflected, _ = mirrored.reset(seed=3)
    mirrored.action_space.seed(0)
    for _ in range(80):
        turn = plain.episode()["target"] == "ccw"
        signs, state_signs = (SIGNS, STATE_SIGNS) if turn else (1.0, 1.0)
        np.testing.assert_array_equal(seen.reshape(3, -1) * signs, reflected.reshape(3, -1))
        np.testing.assert_array_equal(plain.state() * state_signs, mirrored.state())
        action = mirrored.action_space.sample()
        other_side = 3 - action if "rudder_levels" in options else -action
        seen, reward, _, _, info = plain.step(other_side if turn else action)
        reflected, *rest, mirrored_info = mirrored.step(action)
        assert reward == rest[0]
        np.testing.assert_equal(info, mirrored_info)  # NaN equals NaN.
    assert plain.flock.snapshot() == mirrored.flock.snapshot()
