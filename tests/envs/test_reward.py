"""Law: the reward is the weighted sum of its named terms, and those say what their names say."""

import math

import numpy as np
import pytest

import flockenv

OPTIONS = {"n_boats": 6, "n_leaders": 2, "episode_s": 10.0}
ALL = {
    "signed_order": 1.0,
    "tangential_velocity": 0.5,
    "leader_velocity": 0.25,
    "rudder_effort": 0.125,
    "jam": 2.0,
}


def test_terms_follow_from_the_flock():
    env = flockenv.parallel_env(**OPTIONS, reward=ALL, target="ccw")
    env.reset(seed=0)
    rudders = np.random.default_rng(0).uniform(-1, 1, (100, 2))
    for row in rudders:
        actions = {agent: row[[place]] for place, agent in enumerate(env.agents)}
        _, rewards, _, _, infos = env.step(actions)
        order = env.flock.order_parameters()
        x, y, _ = env.flock.pose.T
        vx, vy, _ = env.flock.velocity.T
        clockwise = (vx * y - vy * x) / np.hypot(x, y)
        for place, agent in enumerate(rewards):
            terms = infos[agent]["reward_terms"]
            jam = order.psi_o * max(math.cos(order.phi_o), 0) * max(1 - order.psi_v / 15, 0)
            assert terms == pytest.approx(
                {
                    # What has a law of its own.
                    **terms,
                    "signed_order": order.psi_o * math.cos(order.phi_o + math.pi / 2),
                    "tangential_velocity": -clockwise[2:].mean() / 15,
                    "leader_velocity": -clockwise[place] / 15,
                    "rudder_effort": -(row[place] ** 2),
                    "jam": -jam,
                    # Without a weight nobody watches the contacts.
                    "contact_push": 0.0,
                    "contact_alignment": 0.0,
                    "touched_order": 0.0,
                },
                abs=1e-9,
            )
            assert rewards[agent] == pytest.approx(sum(ALL[name] * terms[name] for name in ALL))


def step_of_a_ring(turn, **options):
    """A step of boats around the pool, turned so much from outward.

    It lasts a millisecond: the flock has no time to leave its order.
    """
    angles = np.linspace(0, 2 * np.pi, 7)[:-1]
    pose = np.stack([140 * np.cos(angles), 140 * np.sin(angles), angles + turn], axis=1)
    env = flockenv.LeadersEnv(n_boats=6, n_leaders=2, control_hz=1000.0, episode_s=1.0)
    env.reset(seed=0, options={"state": {"pose": pose}, **options})
    return env.step(np.zeros(2))


def test_a_jam_heads_outward_and_stands():
    for turn, jam in ((0.0, -1.0), (np.pi, 0.0), (np.pi / 2, 0.0)):
        terms = step_of_a_ring(turn)[4]["reward_terms"]
        assert terms["jam"] == pytest.approx(jam, abs=0.01)


def test_perfect_order_pays_one_and_the_wrong_way_minus_one():
    for target, turn in (("cw", -np.pi / 2), ("ccw", np.pi / 2)):
        for chosen, expected in (("cw", 1.0), ("ccw", -1.0)):
            reward = step_of_a_ring(turn, target=chosen)[1]
            assert reward == pytest.approx(expected if target == "cw" else -expected, abs=1e-6)


def test_a_change_of_target_pays_by_the_target_that_held():
    env = flockenv.LeadersEnv(**{**OPTIONS, "target": "alternate", "episode_s": 8.0})
    env.reset(seed=0)
    for step in range(80):
        target = env.episode()["target"]
        _, reward, _, _, _ = env.step(np.zeros(2))
        order = env.flock.order_parameters()
        sign = 1 if target == "cw" else -1
        expected = order.psi_o * math.cos(order.phi_o - sign * math.pi / 2)
        assert reward == pytest.approx(expected, abs=1e-12), step


def test_leaders_alone_can_be_rewarded_for_their_own_motion():
    env = flockenv.LeadersEnv(
        n_boats=3, n_leaders=3, reward={"leader_velocity": 1.0}, observation={"order": False}
    )
    env.reset(seed=0)
    env.step(np.zeros(3))
    assert np.isnan(env._batch.core.order_parameters()).all()
