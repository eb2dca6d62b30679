"""Law: with a target per leader, each leader's side of every interface is as if all had its own.

The core's part of it is in tests/environment/leader_targets.rs.
"""

import numpy as np
import pytest

import flockenv
from flockenv import FlockParameters
from flockenv.policies import DampedLaw, StraightAhead

SMALL = {"n_boats": 9, "n_leaders": 3, "episode_s": 6.0, "pool": "narrow"}
MIXED = ("cw", "ccw", "cw")


def test_the_joint_reward_is_the_mean_over_leaders():
    env = flockenv.LeadersEnv(**SMALL, target=MIXED)
    assert env.reset(seed=0)[1]["target"] == MIXED
    _, reward, _, _, info = env.step(np.zeros(3))
    order = env.flock.order_parameters()
    signed = order.psi_o * np.sin(order.phi_o)
    assert reward == pytest.approx(signed / 3, rel=1e-12)
    assert info["reward_terms"]["signed_order"] == pytest.approx(reward, rel=1e-12)


def test_vector_environment_and_slots_have_each_leaders_rewards():
    pytest.importorskip("stable_baselines3")
    from flockenv.sb3 import LeaderVecEnv

    parallel = flockenv.parallel_env(**SMALL, target=MIXED)
    venv = flockenv.LeadersVectorEnv(2, **SMALL, target=MIXED)
    slots = LeaderVecEnv(2, **SMALL, target=MIXED)
    parallel.reset(seed=4)
    venv.reset(seed=4)
    slots.seed(4)
    slots.reset()
    for _ in range(60):
        observations, rewards, *_, infos = parallel.step(
            {agent: np.array([0.3]) for agent in parallel.agents}
        )
        joint = venv.step(np.full((2, 3), 0.3))
        slots.step_async(np.full((6, 1), 0.3))
        _, paid, dones, slot_infos = slots.step_wait()
        assert joint[1][0] == pytest.approx(np.mean(list(rewards.values())), rel=1e-12)
        np.testing.assert_array_equal(paid[:3], np.float32(list(rewards.values())))
    assert dones.all()
    for slot, (agent, row) in enumerate(observations.items()):
        np.testing.assert_array_equal(slot_infos[slot]["terminal_observation"], row)
        summaries = (each["episode_summary"] for each in (slot_infos[slot], infos[agent]))
        assert len({each["signed_order"] for each in summaries}) == 1


def test_flock_features_of_slots_are_towards_their_own_targets():
    pytest.importorskip("stable_baselines3")
    from flockenv.sb3 import LeaderVecEnv

    def features(target):
        venv = LeaderVecEnv(1, **SMALL, target=target)
        venv.seed(1)
        venv.reset()
        for _ in range(60):
            venv.step_async(np.full((3, 1), 0.5))
            *_, infos = venv.step_wait()
        return venv.flock_features(), [each["terminal_flock_features"] for each in infos]

    now, last = features(MIXED)
    for leader, word in enumerate(MIXED):
        own_now, own_last = features(word)
        np.testing.assert_array_equal(now[leader], own_now[leader])
        np.testing.assert_array_equal(last[leader], own_last[leader])
    assert (now[0] != now[1]).any()


@pytest.mark.parametrize("mirror_to_target", [False, True])
def test_policies_steer_each_leader_to_its_own_target(mirror_to_target):
    def rudders(policy, target):
        parameters = FlockParameters(n_boats=9, n_leaders=3, pool="wide", target=target)
        # The first decision is held when the second sample is taken.
        run = flockenv.simulate(parameters, 6, 0.1, policy=policy, control_hz=1.0)
        return run.rudder[1]

    for policy in (
        DampedLaw(mirror_to_target=mirror_to_target),
        flockenv.policies.load("learned", pool="wide"),
        StraightAhead(mirror_to_target=mirror_to_target),
    ):
        cw, ccw, mixed = (rudders(policy, target) for target in ("cw", "ccw", MIXED))
        np.testing.assert_array_equal(mixed, [cw[0], ccw[1], cw[2]])
        if not isinstance(policy, StraightAhead):
            assert cw[1] != ccw[1]


def test_a_list_is_of_flocks_and_a_tuple_of_leaders_where_both_would_fit():
    venv = flockenv.LeadersVectorEnv(3, **SMALL)
    for given, found in ((list(MIXED), [*MIXED]), (MIXED, [MIXED] * 3)):
        _, infos = venv.reset(seed=1, options={"target": given})
        assert [each if isinstance(each, str) else tuple(each) for each in infos["target"]] == found
