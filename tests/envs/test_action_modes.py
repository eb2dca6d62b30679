"""Law: a lean of 0 is the pool's tuned law and a heading of 0 is `DampedLaw()`, bit for bit.

An action held for a decision period is that action given in each of its control steps.
"""

import numpy as np
import pytest

import flockenv
from flockenv.envs.single import LeadersEnv
from flockenv.envs.vector import LeadersVectorEnv
from flockenv.errors import ParameterError
from flockenv.policies import DampedLaw, NetworkPolicy

POOLS = ("wide", "narrow")


def rolled(steps, actions=None, policy=None, **options):
    """Rewards and observations of flocks under fixed actions or a policy."""
    env = LeadersVectorEnv(3, n_boats=9, n_leaders=2, **options)
    seen, _ = env.reset(seed=5)
    rewards = []
    for _ in range(steps):
        given = np.full((3, 2), actions) if policy is None else policy.predict(seen)[0]
        seen, reward, *_ = env.step(given)
        rewards.append(reward)
    rudders = env._batch.core.rudders().ravel()
    return seen, np.array(rewards), rudders, env._batch.flock(1).pose


def same(one, other):
    return all(a.tobytes() == b.tobytes() for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize("pool", POOLS)
@pytest.mark.parametrize("mirror", [False, True])
@pytest.mark.parametrize("target", ["cw", "ccw"])
def test_a_lean_of_zero_is_the_tuned_law(pool, mirror, target):
    options = {"pool": pool, "mirror_to_target": mirror, "target": target}
    law = DampedLaw.tuned(pool, mirror_to_target=mirror)
    assert same(rolled(60, 0.0, action_mode="lean", **options), rolled(60, policy=law, **options))


def test_a_heading_of_zero_is_the_damped_law():
    options = {"pool": (100.0, 40.0), "dropout_rate": 0.3, "delay_frames": 1}
    law = rolled(60, policy=DampedLaw(), **options)
    assert same(rolled(60, 0.0, action_mode="heading", **options), law)


@pytest.mark.parametrize(
    ("mode", "largest", "gain"), [("lean", 1.2, 1.42), ("heading", np.pi, 6.0 / np.pi)]
)
@pytest.mark.parametrize(("target", "sign"), [("cw", 1.0), ("ccw", -1.0)])
def test_leaders_steer_outward_of_the_tangent_by_the_angle(mode, largest, gain, target, sign):
    params = flockenv.FlockParameters(n_boats=2, n_leaders=1, pool="wide", c4=0.0, c2=1.0)
    env = LeadersEnv(params=params, action_mode=mode, target=target)
    # At (-140, 0) outward is -x and clockwise +y: the leader heads along the tangent.
    pose = [[-140.0, 0.0, sign * np.pi / 2], [140.0, 0.0, 0.0]]
    env.reset(seed=0, options={"state": {"pose": pose}})
    angle = 0.3
    env.step([angle / largest])
    # Outward of a clockwise tangent is counter-clockwise, where positive rudders turn to.
    rudders = env._batch.core.rudders().ravel()
    assert rudders == pytest.approx([sign * gain * angle], rel=1e-6)
    for _ in range(18):
        env.step([angle / largest])
    x, y, heading = env.flock.pose[0]
    outward = np.angle(np.exp(1j * (heading - np.arctan2(y, x)))) * sign + np.pi / 2
    assert 0.05 < outward < 0.35


@pytest.mark.parametrize("mode", ["rudder", "heading", "lean"])
def test_a_held_action_is_the_action_in_each_control_step(mode):
    options = {"action_mode": mode, "pool": "narrow", "target": "alternate", "rudder_lag_s": 0.2}
    held = rolled(8, 0.4, decision_period_s=0.5, **options)
    each = rolled(40, 0.4, **options)
    assert held[0].tobytes() == each[0].tobytes()
    assert held[3].tobytes() == each[3].tobytes()
    np.testing.assert_allclose(held[1], each[1].reshape(8, 5, 3).sum(axis=1), rtol=1e-12)


def test_an_episode_that_ends_inside_a_period_has_its_own_length():
    options = {"n_boats": 6, "n_leaders": 2, "episode_s": 1.2, "pool": "narrow"}
    env = LeadersEnv(**options, decision_period_s=0.5)
    by_step = LeadersEnv(**options)
    env.reset(seed=3)
    by_step.reset(seed=3)
    ends, rewards, steps = [], [], []
    for _ in range(3):
        _, reward, terminated, truncated, info = env.step([0.3, -0.2])
        assert not terminated
        ends.append(truncated)
        rewards.append(reward)
        steps.append(env.episode()["step"])
    single = [by_step.step([0.3, -0.2]) for _ in range(12)]
    assert ends == [False, False, True]
    assert steps == [5, 10, 12]
    assert rewards[2] == pytest.approx(single[10][1] + single[11][1], rel=1e-12)
    assert info["reward_terms"]["signed_order"] == pytest.approx(rewards[2] / 2)
    assert info["episode_summary"] == single[-1][4]["episode_summary"]
    assert info["episode_summary"]["total_reward"] == pytest.approx(sum(rewards))
    with pytest.raises(flockenv.FlockError, match="reset"):
        env.step([0.0, 0.0])


@pytest.mark.parametrize("mode", ["next_step", "same_step"])
def test_autoreset_comes_with_the_step_that_ends(mode):
    env = LeadersVectorEnv(
        2,
        n_boats=6,
        n_leaders=1,
        episode_s=1.2,
        pool="narrow",
        decision_period_s=0.5,
        autoreset_mode=mode,
    )
    env.reset(seed=0)
    truncated = [env.step(np.zeros((2, 1)))[3].all() for _ in range(7)]
    # With "next_step" the fourth call only starts the next episode.
    expected = [2, 6] if mode == "next_step" else [2, 5]
    assert np.flatnonzero(truncated).tolist() == expected


def test_the_reward_horizon_makes_sums_over_it_means():
    options = {"n_boats": 6, "n_leaders": 2, "pool": "narrow", "decision_period_s": 0.4}
    plain, scaled = LeadersEnv(**options), LeadersEnv(**options, reward_horizon_s=20.0)
    plain.reset(seed=1)
    scaled.reset(seed=1)
    for _ in range(5):
        one, other = plain.step([0.5, 0.5]), scaled.step([0.5, 0.5])
        assert other[1] == pytest.approx(one[1] / 200.0, rel=1e-12)
        assert other[4]["reward_terms"] == one[4]["reward_terms"]


def lean_policy(period=0.5):
    return NetworkPolicy(
        [np.full((67, 1), 1e-2)], [[0.1]], action_mode="lean", decision_period_s=period
    )


def test_policies_of_another_action_mode_are_refused_by_name(tmp_path):
    from flockenv.comparison import compare_leaders

    parameters = flockenv.FlockParameters(n_boats=6, n_leaders=1, pool="narrow")
    policy = lean_policy()
    with pytest.raises(ParameterError, match=r"NetworkPolicy.*'lean'.*simulation.*'rudder'"):
        flockenv.simulate(parameters, 0, 1.0, policy=policy)
    path = tmp_path / "lean.npz"
    policy.save(path)
    with pytest.raises(ParameterError, match=r"'lean'.*'rudder'"):
        flockenv.simulate(parameters, 0, 1.0, policy=str(path))
    for made, mode in ((lambda: policy, "rudder"), (DampedLaw, "lean")):
        with pytest.raises(ParameterError, match="in this environment"):
            compare_leaders(
                parameters, [1], {"it": made}, [0], 5.0, environment={"action_mode": mode}
            )


def test_a_leaning_policy_is_compared_in_its_own_action_mode(tmp_path):
    from flockenv.comparison import run_episodes

    parameters = flockenv.FlockParameters(n_boats=6, n_leaders=1, pool="narrow")
    lean_policy().save(tmp_path / "lean.npz")
    read = flockenv.policies.load(tmp_path / "lean.npz")
    assert (read.action_mode, read.decision_period_s) == ("lean", 0.5)
    zero = NetworkPolicy([np.zeros((67, 1))], [[0.0]], action_mode="lean", decision_period_s=0.5)
    law = run_episodes(parameters, DampedLaw.tuned("narrow"), [0, 1], 20.0)
    leaning = run_episodes(parameters, zero, [0, 1], 20.0)
    np.testing.assert_array_equal(leaning["signed_order"], law["signed_order"])
    assert not np.array_equal(
        run_episodes(parameters, read, [0, 1], 20.0)["signed_order"], law["signed_order"]
    )


def test_levels_stand_for_leans_too():
    options = {"pool": "narrow", "action_mode": "lean"}
    levels = rolled(20, 3, rudder_levels=5, **options)
    assert same(levels, rolled(20, 0.5, **options))
