"""Law: a model with the wrapper that made what it observes steers as it would in that wrapper."""

import gymnasium
import numpy as np
import pytest

import flockenv
from flockenv import ParameterError
from flockenv.comparison import compare_leaders, run_episodes
from flockenv.policies import WrappedPolicy, policy

sb3 = pytest.importorskip("stable_baselines3")

from stable_baselines3 import PPO  # noqa: E402
from stable_baselines3.common.vec_env import VecFrameStack, VecNormalize  # noqa: E402

from flockenv.sb3 import LeaderVecEnv  # noqa: E402

PARAMETERS = flockenv.FlockParameters(n_boats=6, n_leaders=2, pool="narrow")
OPTIONS = {"params": PARAMETERS, "episode_s": 8.0, "mirror_to_target": True, "control_hz": 5.0}


class Cut(gymnasium.ObservationWrapper):
    """The first numbers of what is observed, twice as large."""

    def __init__(self, env):
        super().__init__(env)
        self.observation_space = gymnasium.spaces.Box(-9.0, 9.0, (12,), np.float32)

    def observation(self, observation):
        return 2.0 * observation[..., :12]


def stacked(venv):
    return VecFrameStack(venv, 3)


def remembering(env):
    return gymnasium.wrappers.FlattenObservation(
        gymnasium.wrappers.FrameStackObservation(Cut(env), 4)
    )


def of_rows(wrap=stacked):
    venv = LeaderVecEnv(2, **OPTIONS)
    return WrappedPolicy(PPO("MlpPolicy", wrap(venv), seed=1, device="cpu"), stacked, venv)


def of_flocks():
    env = gymnasium.make("flockenv/Leaders-v0", **OPTIONS)
    return WrappedPolicy(PPO("MlpPolicy", remembering(env), seed=1, device="cpu"), remembering, env)


def by_hand_of_rows(model):
    """Signed orders of two flocks that the model steers in its own environment."""
    venv = stacked(LeaderVecEnv(2, **OPTIONS))
    venv.seed(4)
    seen, ends = venv.reset(), np.zeros(4, bool)
    while not ends.any():
        seen, _, ends, infos = venv.step(model.predict(seen, deterministic=True)[0])
    return [infos[slot]["episode_summary"]["signed_order"] for slot in (0, 2)]


def by_hand_of_flocks(model):
    orders = []
    for seed in (4, 5):
        env = remembering(gymnasium.make("flockenv/Leaders-v0", **OPTIONS))
        (seen, _), over = env.reset(seed=seed), False
        while not over:
            seen, _, _, over, info = env.step(model.predict(seen, deterministic=True)[0])
        orders.append(info["episode_summary"]["signed_order"])
    return orders


@pytest.mark.parametrize(
    ("made", "by_hand"), [(of_rows, by_hand_of_rows), (of_flocks, by_hand_of_flocks)]
)
def test_it_steers_as_in_its_own_environment(made, by_hand):
    own = made()
    expected = by_hand(own.model)
    for _ in range(2):  # What a wrapper remembers starts again with each run.
        found = run_episodes(PARAMETERS, own, [4, 5], 8.0)["signed_order"]
        assert found == pytest.approx(expected, abs=1e-6)
    table = compare_leaders(PARAMETERS, [2], {"mine": own}, [4, 5], 8.0)
    assert table["signed_order"].tolist() == found.tolist()
    steered = policy(own)
    assert (steered.control_hz, steered.mirror_to_target) == (5.0, True)
    # Through `simulate` the same flock moves alike.
    run = flockenv.simulate(PARAMETERS, 4, 8.0, policy=own)
    late = run.in_analysis_window & (run.time_s > 0.8)
    measured = run.order.signed_order("cw")[late]
    assert measured.mean() == pytest.approx(expected[0], abs=0.05)


def test_memory_counts():
    """A stack that forgets everything is another policy."""
    own = of_rows()
    rows = np.random.default_rng(0).normal(size=(4, own._space.shape[0])).astype(np.float32)
    _, state = own.predict(rows)
    later, _ = own.predict(2.0 * rows, state)
    alone, _ = own.predict(2.0 * rows)
    assert np.abs(later - alone).max() > 1e-4
    again, _ = own.predict(2.0 * rows, state, episode_start=np.ones(4, bool))
    np.testing.assert_array_equal(again, alone)


def test_what_is_normalized_is_normalized_last():
    own = of_rows(lambda venv: VecNormalize(stacked(venv)))
    plain = of_rows()
    rows = np.ones((2, own._space.shape[0]), np.float32)
    own.model.get_vec_normalize_env().obs_rms.mean += 3.0
    plain.model.policy.load_state_dict(own.model.policy.state_dict())
    assert (own.predict(rows)[0] != plain.predict(rows)[0]).all()


def test_what_is_normalized_first_is_normalized_first():
    """As in the training: each frame by itself, before frames are stacked."""
    venv = LeaderVecEnv(2, **OPTIONS)
    training = VecNormalize(venv)
    model = PPO("MlpPolicy", stacked(training), seed=1, device="cpu")
    training.obs_rms.mean += 0.3
    own = WrappedPolicy(model, stacked, venv)
    rows = np.random.default_rng(0).normal(size=(4, own._space.shape[0])).astype(np.float32)
    found, _ = own.predict(rows)
    frames = training.normalize_obs(rows)
    seen = np.concatenate([np.zeros_like(frames)] * 2 + [frames], axis=1)
    np.testing.assert_allclose(found, model.predict(seen, deterministic=True)[0], atol=1e-6)


def test_wrappers_normalize_as_in_the_training_or_not_at_all(tmp_path):
    def trained(wrap):
        model = PPO("MlpPolicy", wrap(venv), n_steps=8, batch_size=8, seed=1, device="cpu")
        return model.learn(32)

    venv = LeaderVecEnv(2, **OPTIONS)
    own = WrappedPolicy(trained(lambda env: VecNormalize(stacked(env))), stacked, venv)
    own.model.save(tmp_path / "model")
    own.model.get_vec_normalize_env().save(str(tmp_path / "statistics"))
    alone = PPO.load(tmp_path / "model", device="cpu")
    for wrap, words in (
        (stacked, "trained in VecNormalize and loaded without it"),
        (lambda env: VecNormalize(stacked(env)), "normalizes without statistics"),
    ):
        with pytest.raises(ParameterError, match=words):
            WrappedPolicy(alone, wrap, venv)
    again = WrappedPolicy(
        alone, lambda env: VecNormalize.load(str(tmp_path / "statistics"), stacked(env)), venv
    )
    rows, state, stored = np.ones((4, own._space.shape[0]), np.float32), None, None
    for scale in (1.0, 2.0, 3.0):  # What it sees teaches it nothing.
        expected, stored = own.predict(scale * rows, stored)
        found, state = again.predict(scale * rows, state)
        np.testing.assert_allclose(found, expected, atol=1e-6)
    with pytest.raises(ParameterError, match="makes observations of shape"):
        WrappedPolicy(own.model, lambda env: VecFrameStack(env, 2), venv)
    with pytest.raises(ParameterError, match="normalizes without statistics"):
        WrappedPolicy(object(), gymnasium.wrappers.NormalizeObservation, flockenv.LeadersEnv())


class Levels(gymnasium.ActionWrapper):
    def __init__(self, env):
        super().__init__(env)
        self.action_space = gymnasium.spaces.Discrete(3)


class Asks(gymnasium.ObservationWrapper):
    def observation(self, observation):
        return observation * self.unwrapped.num_leaders


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"wrapper": VecFrameStack.__name__}, TypeError, "wrapper must be a function"),
        ({"env": None}, ParameterError, "env = None is not accepted: a LeaderVecEnv or flockenv/"),
        ({"env": gymnasium.make("CartPole-v1")}, ParameterError, "not accepted: a LeaderVecEnv"),
        ({"wrapper": Levels}, ParameterError, "action space Discrete.3. is not accepted"),
    ],
)
def test_other_wrappers_are_refused(arguments, error, words):
    env = flockenv.LeadersEnv(**OPTIONS)
    given = {"model": object(), "wrapper": Cut, "env": env}
    with pytest.raises(error, match=words):
        WrappedPolicy(**given | arguments)


def test_episodes_that_start_apart_and_questions_to_the_environment_are_refused():
    own = of_rows()
    rows = np.zeros((4, own._space.shape[0]), np.float32)
    with pytest.raises(ParameterError, match="episode_start of some flocks"):
        own.predict(rows, episode_start=np.array([True, False, False, False]))
    env = flockenv.LeadersEnv(**OPTIONS)
    asking = WrappedPolicy(PPO("MlpPolicy", Asks(env), device="cpu"), Asks, env)
    with pytest.raises(AttributeError, match="num_leaders"):
        asking.predict(np.zeros((1, env.observation_space.shape[0]), np.float32))


def test_a_wrapper_that_remembers_less_than_the_model_saw_is_refused():
    venv = LeaderVecEnv(2, **OPTIONS)
    model = PPO("MlpPolicy", stacked(venv), device="cpu")
    with pytest.raises(ParameterError, match="not accepted: the model takes"):
        WrappedPolicy(model, lambda env: VecFrameStack(env, 7), venv)


def test_a_model_in_a_wrapper_alone_is_told_what_takes_it():
    model = PPO("MlpPolicy", stacked(LeaderVecEnv(2, **OPTIONS)), device="cpu")
    with pytest.raises(ParameterError, match="WrappedPolicy takes it"):
        flockenv.simulate(PARAMETERS, 4, 1.0, policy=model)
