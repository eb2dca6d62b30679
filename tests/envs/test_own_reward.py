"""Law: the vector environment gives each leader's reward, all boats' states, and takes a reward."""

import numpy as np
import pytest

import flockenv
from flockenv import EpisodeError, LeadersVectorEnv, ParameterError

SMALL = {"n_boats": 8, "n_leaders": 2, "pool": "narrow", "episode_s": 0.5}
ACTIONS = np.array([[0.5, -0.5], [1.0, 0.0], [0.0, 0.0]])


def started(**options) -> LeadersVectorEnv:
    env = LeadersVectorEnv(3, **SMALL, **options)
    env.reset(seed=4)
    return env


def test_opposed_leaders_have_opposite_rewards_of_their_own():
    env = started(target=["cw", "ccw"])
    with pytest.raises(EpisodeError, match="before the first step"):
        env.leader_rewards()
    _, rewards, *_ = env.step(ACTIONS)
    own = env.leader_rewards()
    assert rewards == pytest.approx(np.zeros(3), abs=1e-15)
    assert own[:, 0] == pytest.approx(-own[:, 1], abs=1e-12)
    assert np.abs(own).max() > 0.01


def test_states_are_those_of_the_flocks():
    env = started()
    env.step(ACTIONS)
    assert env.poses().shape == env.velocities().shape == (3, 8, 3)
    for place in range(3):
        flock = flockenv.Flock(env._batch.parameters(place), 4 + place)
        flock.advance(0.1, ACTIONS[place])
        assert np.array_equal(env.poses()[place], flock.pose)
        assert np.array_equal(env.velocities()[place], flock.velocity)


def closeness(env: LeadersVectorEnv) -> np.ndarray:
    pose = env.poses()
    return -np.hypot(pose[:, 0, 0] - pose[:, 1, 0], pose[:, 0, 1] - pose[:, 1, 1])


def test_a_function_of_the_environment_is_its_reward():
    env, plain = started(reward=closeness), started()
    total = np.zeros(3)
    for _ in range(4):
        observations, rewards, *_ = env.step(ACTIONS)
        total += rewards
        assert np.array_equal(observations, plain.step(ACTIONS)[0])
        assert np.array_equal(rewards, closeness(plain))
        assert np.array_equal(env.leader_rewards(), np.stack([closeness(plain)] * 2, axis=1))
    _, rewards, _, truncated, infos = env.step(ACTIONS)
    assert truncated.all()
    assert infos["episode_summary"]["total_reward"] == pytest.approx(total + rewards)
    # The next step starts the next episode.
    assert not env.step(ACTIONS)[1].any()
    assert env.step(ACTIONS)[1].all()


def test_a_function_may_value_each_leader():
    env = started(reward=lambda env: env.poses()[:, :2, 0])
    _, rewards, *_ = env.step(ACTIONS)
    assert np.array_equal(env.leader_rewards(), env.poses()[:, :2, 0])
    assert rewards == pytest.approx(env.poses()[:, :2, 0].mean(axis=1))


@pytest.mark.parametrize("make", [LeadersVectorEnv.clone, lambda env: env])
def test_what_was_paid_is_a_part_of_the_state(make):
    env = started(reward=closeness)
    for _ in range(2):
        env.step(ACTIONS)
    other = make(started(reward=closeness))
    other.set_state(env.get_state())
    for _ in range(3):
        ends = [each.step(ACTIONS)[4] for each in (env, other)]
    totals = [each["episode_summary"]["total_reward"] for each in ends]
    assert np.array_equal(*totals)
    assert np.isfinite(totals).all()
    for state in (started().get_state(), b"", env.get_state()[:-1]):
        with pytest.raises(ParameterError):
            other.set_state(state)
    with pytest.raises(ParameterError):
        started().set_state(env.get_state())
    assert other.get_state() == env.get_state()


@pytest.mark.parametrize(
    "returned", [np.zeros(2), np.zeros((3, 3)), np.full(3, np.nan), 1.0, ["a", "b", "c"], None]
)
def test_rewards_that_are_none_are_refused(returned):
    env = started(reward=lambda env: returned)
    with pytest.raises(ParameterError, match="the reward function"):
        env.step(ACTIONS)


def test_a_function_needs_the_end_of_an_episode_to_look_at():
    with pytest.raises(ParameterError, match="same_step"):
        LeadersVectorEnv(2, autoreset_mode="same_step", reward=closeness, **SMALL)


WEIGHTS = [{"leader_velocity": 2.0, "contact_push": 0.5}, {"signed_order": -1.0}]


@pytest.mark.parametrize(
    "options", [{}, {"decision_period_s": 0.2, "reward_horizon_s": 5.0, "target": ["cw", "ccw"]}]
)
def test_weights_of_each_leader_pay_it_as_the_same_weights_of_all(options):
    """Leader 0 of the first flock is paid as where all have its weights, and so is leader 1."""
    own = flockenv.parallel_env(**SMALL, reward=WEIGHTS, **options)
    same = [flockenv.parallel_env(**SMALL, reward=weights, **options) for weights in WEIGHTS]
    for env in (own, *same):
        env.reset(seed=4)
    total = np.zeros(2)
    while own.agents:
        actions = {"leader_0": [0.5], "leader_1": [-0.5]}
        steps = [env.step(actions) for env in (own, *same)]
        paid = np.array([steps[0][1][f"leader_{leader}"] for leader in range(2)])
        expected = [steps[1 + leader][1][f"leader_{leader}"] for leader in range(2)]
        assert paid == pytest.approx(expected, rel=1e-12)
        total += paid
    infos = steps[0][4]
    assert infos["leader_0"]["episode_summary"]["total_reward"] == pytest.approx(total.mean())


@pytest.mark.parametrize(
    ("reward", "words"),
    [
        (WEIGHTS[:1], "one for each of 2 leaders"),
        ([{}, {"signed_ordre": 1.0}], "signed_ordre.*is not accepted: one of .signed_order"),
        ([{}, {"signed_order": np.nan}], "-1e6 to 1e6"),
        ([{}, 1.0], "must be a dictionary of weights, or a list of dictionaries, one per leader"),
        ([{}, {"signed_order": "much"}], "reward must be a number"),
        ([{}, {"signed_order": True}], "reward must be a number"),
    ],
)
def test_weights_that_are_none_are_refused(reward, words):
    with pytest.raises((ParameterError, TypeError), match=words):
        flockenv.parallel_env(**SMALL, reward=reward)


@pytest.mark.parametrize("reward", ["function", "list"])
@pytest.mark.parametrize("mode", ["next_step", "disabled"])
def test_what_was_paid_starts_anew_with_each_episode(reward, mode):
    """After 2 of 5 steps flock 1 alone starts again, and the others end before it."""
    own = {
        "function": lambda env: np.ones(env.num_envs),
        "list": [{"rudder_effort": -1.0}, {"rudder_effort": -1.0}],
    }
    env = started(reward=own[reward], autoreset_mode=mode)
    still, mask = np.ones((3, 2)), np.array([False, True, False])
    for _ in range(2):
        env.step(still)
    env.reset(options={"reset_mask": mask})
    for _ in range(2):
        env.step(still)
    env.set_state(env.get_state())
    *_, truncated, infos = env.step(still)
    assert truncated.tolist() == [True, False, True]
    assert infos["episode_summary"]["total_reward"][~mask] == pytest.approx(5.0)
    if mode == "disabled":
        env.reset(options={"reset_mask": ~mask})
    ends = {}
    for step in range(12):
        *_, truncated, infos = env.step(still)
        for flock in np.flatnonzero(truncated).tolist():
            ends.setdefault(flock, (step, infos["episode_summary"]["total_reward"][flock]))
        if mode == "disabled" and truncated.any():
            env.reset(options={"reset_mask": truncated})
    assert {flock: total for flock, (_, total) in ends.items()} == pytest.approx(
        dict.fromkeys(range(3), 5.0)
    )
