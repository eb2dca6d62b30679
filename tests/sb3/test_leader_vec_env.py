"""Law: LeaderVecEnv keeps stable-baselines3's conventions, one slot per leader."""

import pickle

import gymnasium
import numpy as np
import pytest

import flockenv

sb3 = pytest.importorskip("stable_baselines3")

from stable_baselines3 import PPO  # noqa: E402

from flockenv.sb3 import LeaderVecEnv  # noqa: E402

from .conftest import started, steps  # noqa: E402

OPTIONS = {"n_boats": 9, "episode_s": 2.0}
STEPS = 20


def make(num_flocks=3, n_leaders=2, **options):
    return LeaderVecEnv(num_flocks, n_leaders=n_leaders, **{**OPTIONS, **options})


def actions_of(venv, step):
    random = np.random.default_rng(step)
    return random.uniform(-1, 1, (venv.num_envs, 1)).astype(np.float32)


def test_end_of_an_episode():
    venv = make()
    reference = gymnasium.make_vec("flockenv/Leaders-v0", num_envs=3, n_leaders=2, **OPTIONS)
    started(venv, seed=4)
    reference.reset(seed=4)
    for step in range(STEPS):
        actions = actions_of(venv, step)
        observations, _, dones, infos = venv.step(actions)
        last, *_ = reference.step(actions.reshape(3, 2))
        assert dones.all() == (step == STEPS - 1)
    for slot, info in enumerate(infos):
        assert info["TimeLimit.truncated"] is True
        row = last.reshape(6, -1)[slot]
        np.testing.assert_array_equal(info["terminal_observation"], row)
        assert info["episode_summary"]["steps"] == STEPS
        assert info["terminal_state"] in venv.state_space
    fresh = reference.step(actions.reshape(3, 2))[0].reshape(6, -1)
    np.testing.assert_array_equal(observations, fresh)
    assert len(venv.reset_infos) == 6


def test_seed_gives_flock_i_the_seed_s_plus_i():
    venv = make(num_flocks=3, n_leaders=[1, 2, 3])
    assert venv.seed(10) == [10, 11, 11, 12, 12, 12]
    observations = venv.reset()
    for flock, k in enumerate([1, 2, 3]):
        env = flockenv.LeadersEnv(n_leaders=k, **OPTIONS)
        expected, _ = env.reset(seed=10 + flock)
        np.testing.assert_array_equal(observations[venv.flock_of_slot == flock].ravel(), expected)
    assert (venv.reset() != observations).any()
    venv.seed(10)
    np.testing.assert_array_equal(venv.reset(), observations)


def test_leader_counts_mix():
    venv = make(num_flocks=5, n_leaders=[1, 3])
    assert venv.num_envs == 1 + 3 + 1 + 3 + 1
    assert venv.get_attr("leader_index") == [0, 0, 1, 2, 0, 0, 1, 2, 0]
    venv.reset()
    venv.step(actions_of(venv, 0))
    assert venv.state().shape == (9, *venv.state_space.shape)


def test_set_options_refuses_what_it_does_not_know_and_forgets_it():
    venv = started(make(num_flocks=2))
    for options in (
        {"n_boats": 9},
        {"bw": 0.5},
        {"pose": np.zeros((9, 3))},
        {"reset_mask": np.ones(2, bool)},
        [{"target": "cw", "C0": 1}] * 4,
    ):
        with pytest.raises(flockenv.ParameterError, match="not a reset option"):
            venv.set_options(options)
        venv.reset()
    # It may be meant for a wrapper.
    venv.set_options({"anything": 1})
    venv.reset()
    venv.set_options({"bw_s": -1.0})
    venv.seed(5)
    with pytest.raises(flockenv.ParameterError, match="bw_s"):
        venv.reset()
    # The seed stays, the option does not.
    venv.reset()
    assert [info["flock_seed"] for info in venv.reset_infos] == [5, 5, 6, 6]
    venv.set_options({"target": each} for each in ("cw", "cw", "ccw", "ccw"))
    venv.reset()
    assert [info["target"] for info in venv.reset_infos] == ["cw", "cw", "ccw", "ccw"]


def test_only_the_flock_that_fails_starts_anew():
    """One of its states is so fast that it might pass through a wall, a stub at the pool's edge."""
    venv = make(num_flocks=3, dt_s=0.1, walls=[(179.99, 0.0, 180.1, 0.0)])
    calm = make(num_flocks=3)
    pose = flockenv.Flock(calm.slots[0].parameters, 3).pose
    still = {"state": {"pose": pose}}
    fast = {"state": {"pose": pose, "velocity": np.full((9, 3), 1e5)}}
    for seeds, options in ((4, [*[still] * 4, *[fast] * 2]),):
        venv.seed(seeds)
        venv.set_options(options)
        venv.reset()
    with pytest.raises(flockenv.SolverError, match="flock"):
        steps(venv, STEPS)
    going = [episode["step"] for episode in venv.env_method("episode")]
    assert going[4:] == [0, 0]
    venv.state(), venv.poses(), venv.flock_features(), venv.reward_terms()
    assert venv._batch.running() == [True] * 3


@pytest.mark.parametrize("fails_at", [3, STEPS])
def test_a_reward_that_raises_does_not_end_the_training(fails_at):
    calls = []

    def reward(venv):
        calls.append(1)
        if len(calls) == fails_at:
            raise KeyError("mine")
        return np.ones(venv.num_envs)

    venv, plain = make(reward=reward, num_flocks=2), make(num_flocks=2)
    for env in (venv, plain):
        started(env, seed=3)
    steps(plain, fails_at)
    with pytest.raises(KeyError, match="mine"):
        steps(venv, fails_at)
    np.testing.assert_array_equal(venv.poses(), plain.poses())
    steps(plain, STEPS - fails_at)
    last = steps(venv, STEPS - fails_at)
    np.testing.assert_array_equal(venv.poses(), plain.poses())
    if last:
        # The step whose reward is not known is worth nothing.
        assert last[-1][3][0]["episode"]["r"] == STEPS - 1
    assert steps(venv, STEPS)[-1][3][0]["episode"]["r"] == STEPS


@pytest.mark.parametrize("value", [1e39, -1e39, np.finfo(np.float64).max])
def test_rewards_beyond_single_precision_are_refused(value):
    venv = started(make(reward=lambda venv: np.full(venv.num_envs, value)))
    with pytest.raises(flockenv.ParameterError, match="float32"):
        steps(venv, 1)
    steps(started(make(reward=[{"signed_order": 1e6}] * 2)), 1)


def test_discrete_rudders():
    venv = make(rudder_levels=5)
    assert venv.action_space == gymnasium.spaces.Discrete(5)
    venv.reset()
    venv.step(np.arange(6) % 5)
    np.testing.assert_array_equal(venv._batch.core.rudders().ravel(), [-1, -0.5, 0, 0.5, 1, -1])
    PPO("MlpPolicy", venv, n_steps=8, batch_size=16, n_epochs=1, device="cpu").learn(100)


def test_pickle_and_clone():
    venv = started(make(), seed=0)
    venv.step(actions_of(venv, 0))
    for copy in (venv.clone(), pickle.loads(pickle.dumps(venv))):
        assert copy.get_state() == venv.get_state()
        assert copy.get_attr("flock_index") == venv.get_attr("flock_index")
        assert copy.slots[0]._env is copy
    copy = venv.clone()
    np.testing.assert_array_equal(
        venv.step(actions_of(venv, 1))[0], copy.step(actions_of(venv, 1))[0]
    )


def test_bad_input():
    venv = make()
    for _ in range(2):
        # The refused step starts no episode, so that a second one is refused, too.
        with pytest.raises(flockenv.EpisodeError):
            venv.step(np.zeros((6, 1)))
    venv.reset()
    before = venv.get_state()
    for actions in (np.full((6, 1), np.nan), np.zeros((5, 1)), np.zeros(6)):
        with pytest.raises(flockenv.ParameterError):
            venv.step(actions)
    with pytest.raises(flockenv.EpisodeError):
        venv.step_wait()
    assert venv.get_state() == before
    for bad in ({"num_flocks": 0}, {"n_leaders": []}, {"n_leaders": [0]}, {"n_leaders": 99}):
        with pytest.raises(flockenv.ParameterError):
            LeaderVecEnv(**bad)


def test_counts_and_seeds_are_checked():
    assert make(n_leaders=np.array([1, 3])).num_envs == 1 + 3 + 1
    for bad in ("3", True, None):
        with pytest.raises(TypeError, match="num_flocks must be an integer"):
            make(num_flocks=bad)
    assert make(num_flocks=3.0, n_leaders=np.array([1.0, 2.0])).num_envs == 1 + 2 + 1
    for bad in ({"num_flocks": 2.5}, {"n_leaders": [1, 1.5]}):
        with pytest.raises(flockenv.ParameterError, match=r"\.5 is not accepted: a whole number"):
            make(**bad)
    for bad in ("12", [1, "a"], [1, None], {1, 2}, [[1]]):
        with pytest.raises(TypeError, match="n_leaders must be an integer"):
            make(n_leaders=bad)
    venv = make()
    for bad in (-1, 2**64 - 2):
        with pytest.raises(flockenv.ParameterError, match="seed = "):
            venv.seed(bad)
    started(venv, seed=2**64 - 3)


@pytest.mark.parametrize("indices", ["0", [True, False], [99], [-99], {0: 1}, "all"])
def test_slots_are_whole_numbers(indices):
    venv = make()
    for reach in (
        lambda: venv.get_attr("bw_s", indices),
        lambda: venv.set_attr("bw_s", 0.2, indices),
        lambda: venv.env_method("state", indices=indices),
        lambda: venv.env_is_wrapped(gymnasium.Wrapper, indices),
    ):
        with pytest.raises((TypeError, IndexError), match="indices"):
            reach()
    assert venv.get_attr("bw_s", iter([0, -1])) == venv.get_attr("bw_s", [0, 1])


def test_a_flocks_leaders_share_the_options_of_a_reset():
    venv = make(num_flocks=2)
    venv.set_options([{"target": word} for word in ("cw", "cw", "ccw", "ccw")])
    venv.reset()
    assert [info["target"] for info in venv.reset_infos] == ["cw", "cw", "ccw", "ccw"]
    state = {"pose": flockenv.Flock(venv.slots[0].parameters, 9).pose}
    venv.set_options([{"state": {"pose": state["pose"].copy()}} for _ in range(4)])
    venv.reset()
    np.testing.assert_array_equal(venv.poses(), [state["pose"]] * 2)
    for options in (
        [{"target": word} for word in ("cw", "ccw", "cw", "cw")],
        [{"target": "cw"}, {}, {"target": "cw"}, {"target": "cw"}],
    ):
        with pytest.raises(flockenv.ParameterError, match="set_options: the"):
            venv.set_options(options)
    venv.set_options([{"target": "ccw"}, {"target": "ccw"}, {"bw_s": 0.1}, {"bw_s": 0.1}])
    venv.reset()
    assert [info["target"] for info in venv.reset_infos] == ["ccw", "ccw", "cw", "cw"]
    assert [info["bw_s"] for info in venv.reset_infos] == [0.3, 0.3, 0.1, 0.1]
    for options in ([{}], [None] * 4, 7, "target"):
        with pytest.raises(TypeError, match="a list of one for each slot"):
            venv.set_options(options)


def test_a_function_of_the_environment_is_its_reward():
    """It sees the last state of an episode, and its sum is the episode's return."""

    def outward(venv: LeaderVecEnv) -> np.ndarray:
        pose = venv.poses()[:, :2, :2]
        return np.hypot(pose[..., 0], pose[..., 1]) + venv.velocities()[:, :2, 2]

    venv, plain = make(reward=outward, num_flocks=2), make(num_flocks=2)
    for env in (venv, plain):
        started(env, seed=3)
    total = np.zeros(4)
    for step in range(STEPS):
        actions = actions_of(venv, step)
        observations, rewards, dones, infos = venv.step(actions)
        np.testing.assert_array_equal(observations, plain.step(actions)[0])
        total += rewards
        if not dones.all():
            np.testing.assert_allclose(rewards, outward(venv).ravel(), rtol=1e-6)
    assert dones.all()
    returns = [infos[slot]["episode"]["r"] for slot in (0, 2)]
    assert returns == pytest.approx(total.reshape(2, 2).mean(axis=1), rel=1e-6)
    last = infos[0]["terminal_state"]
    assert (last != venv.state()[0]).any()
    assert rewards[0] != pytest.approx(outward(venv).ravel()[0])


def test_images_are_those_of_the_flocks():
    pictures = {"render_mode": "rgb_array", "render_size": (100, 80)}
    venv = started(LeaderVecEnv(3, n_boats=8, n_leaders=2, **pictures), seed=1)
    images = venv.get_images()
    assert [image.shape for image in images] == [(80, 100, 3)] * 3
    assert (images[0] != images[1]).any()
    assert venv.render().dtype == np.uint8
    assert venv.metadata == {"render_modes": ["rgb_array"], "render_fps": 10.0}
    assert LeaderVecEnv(n_boats=8, n_leaders=2).get_images() == [None, None]
