"""Law: a model of stable-baselines3 steers wherever a policy goes, as it would on its own."""

import base64
import json
import os
import pickle
import zipfile
from contextlib import nullcontext
from types import SimpleNamespace

import gymnasium
import numpy as np
import pytest

import flockenv
from flockenv import ParameterError
from flockenv.comparison import compare_leaders, run_episodes
from flockenv.envs.observation import BLOCKS
from flockenv.policies import ModelPolicy, SteeringLaw

sb3 = pytest.importorskip("stable_baselines3")

from stable_baselines3 import A2C, DQN, PPO, SAC  # noqa: E402
from stable_baselines3.common.vec_env import VecFrameStack, VecNormalize  # noqa: E402

from flockenv.sb3 import LeaderVecEnv  # noqa: E402

PARAMETERS = flockenv.FlockParameters(n_boats=6, n_leaders=2, pool="narrow")
OPTIONS = {"params": PARAMETERS, "episode_s": 2.0}
FEW = {"observation": {"neighbors": 2, "order": False}, "mirror_to_target": True, "control_hz": 5.0}


def rows_env(**options):
    return LeaderVecEnv(2, **{**OPTIONS, **options})


def joined_env(**options):
    return gymnasium.make("flockenv/Leaders-v0", **{**OPTIONS, **options})


MODELS = {
    "rows": (PPO, rows_env, {}),
    "joined": (PPO, joined_env, {}),
    "rows, few blocks": (PPO, rows_env, FEW),
    "joined, few blocks": (SAC, joined_env, FEW),
    "levels": (DQN, rows_env, {"rudder_levels": 5}),
    "joined levels": (A2C, joined_env, {"rudder_levels": 3}),
}


@pytest.fixture(scope="module", params=MODELS, ids=str)
def model(request):
    algorithm, make, options = MODELS[request.param]
    model = algorithm("MlpPolicy", make(**options), seed=3, device="cpu")
    model.given = options
    return model


@pytest.fixture
def file(model, tmp_path):
    model.save(tmp_path / "model.zip")
    return tmp_path / "model.zip"


def by_hand(model, observations):
    """What the model itself does with leaders' observations, shape (flocks, 2 * size)."""
    joined = model.observation_space.shape[0] == observations.shape[1]
    rows = observations if joined else observations.reshape(2 * len(observations), -1)
    actions = np.asarray(model.predict(rows, deterministic=True)[0]).reshape(-1, 2)
    levels = model.given.get("rudder_levels")
    return actions if levels is None else 2.0 * actions / (levels - 1) - 1.0


def test_a_file_steers_as_the_model(model, file):
    own, read = ModelPolicy(model), flockenv.policies.load(file, trust=True)
    assert (own.observation, own.mirror_to_target) == (read.observation, read.mirror_to_target)
    assert own.control_hz == read.control_hz == model.given.get("control_hz", 10.0)
    assert own.leaders == read.leaders
    assert len(read.provenance["sha256"]) == 64
    venv = flockenv.LeadersVectorEnv(3, **{**OPTIONS, **model.given, "rudder_levels": None})
    observations, _ = venv.reset(seed=0)
    expected = by_hand(model, observations)
    for policy in (own, read):
        rudders, _ = policy.predict(observations)
        assert (rudders.shape, rudders.dtype) == ((3, 2), np.float32)
        np.testing.assert_allclose(rudders, expected, atol=1e-6)
    many = np.random.default_rng(5).standard_normal((64, observations.shape[1]))
    assert own.predict(many)[0].tolist() == [own.predict(each)[0].tolist() for each in many]


def test_every_interface_gets_the_same_rudders(model):
    policy = ModelPolicy(model)
    options = {**OPTIONS, **model.given, "rudder_levels": None}
    single = flockenv.LeadersEnv(**options)
    observation, _ = single.reset(seed=5)
    rudders, _ = policy.predict(observation)
    np.testing.assert_allclose(rudders, by_hand(model, observation[None])[0], atol=1e-6)
    parallel = flockenv.parallel_env(**options)
    by_agent, _ = policy.predict(parallel.reset(seed=5)[0])
    np.testing.assert_array_equal(np.concatenate(list(by_agent.values())), rudders)
    slots = LeaderVecEnv(2, **options)
    slots.seed(5)
    of_slots, _ = policy.predict(slots.reset())
    assert of_slots.shape == (4, 1)
    np.testing.assert_allclose(of_slots[:2, 0], rudders, atol=1e-6)
    single.step(rudders)
    parallel.step(by_agent)
    slots.step(of_slots)


def test_leaders_by_name_of_many_flocks_are_those_of_each_flock(model):
    policy = ModelPolicy(model)
    options = {**OPTIONS, **model.given, "rudder_levels": None}
    observations, _ = flockenv.LeadersVectorEnv(3, **options).reset(seed=5)
    rudders, _ = policy.predict(observations)
    first, last = np.split(observations, 2, axis=1)
    by_agent, _ = policy.predict({"leader_0": first, "leader_1": last})
    assert {name: each.shape for name, each in by_agent.items()} == {
        "leader_0": (3, 1),
        "leader_1": (3, 1),
    }
    np.testing.assert_array_equal(np.concatenate([*by_agent.values()], axis=1), rudders)


def test_simulations_and_episodes_take_the_model_itself(model):
    # As by the policy, and in an episode the same as in the environment, step by step.
    run = flockenv.simulate(PARAMETERS, 7, 2.0, policy=model)
    assert run == flockenv.simulate(PARAMETERS, 7, 2.0, policy=ModelPolicy(model))
    assert run != flockenv.simulate(PARAMETERS, 7, 2.0, policy=SteeringLaw())
    found = run_episodes(PARAMETERS, model, [4, 5], 2.0)
    venv = flockenv.LeadersVectorEnv(2, **{**OPTIONS, **model.given, "rudder_levels": None})
    observations, _ = venv.reset(seed=4)
    over = np.zeros(2, bool)
    while not over.any():
        observations, _, _, over, infos = venv.step(by_hand(model, observations))
    np.testing.assert_allclose(
        found["signed_order"], infos["episode_summary"]["signed_order"], atol=1e-6
    )


def test_files_are_not_read_without_trust(file, tmp_path):
    class Evil:
        def __reduce__(self):
            return os.mkdir, (str(tmp_path / "executed"),)

    with zipfile.ZipFile(file) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    data = json.loads(parts["data"])
    data["policy_kwargs"] = {":serialized:": base64.b64encode(pickle.dumps(Evil())).decode()}
    parts["data"] = json.dumps(data).encode()
    with zipfile.ZipFile(file, "w") as archive:
        for name, content in parts.items():
            archive.writestr(name, content)
    for read in (
        lambda: flockenv.policies.load(file),
        lambda: flockenv.simulate(PARAMETERS, 0, 1.0, policy=str(file)),
    ):
        with pytest.raises(ParameterError, match=r"reading it executes the code in it.*trust=True"):
            read()
    assert not (tmp_path / "executed").exists()
    with pytest.raises(ParameterError, match="is not a model that can be read"):
        flockenv.policies.load(file, trust=True)
    # The test would notice.
    assert (tmp_path / "executed").exists()


def test_damaged_files_are_refused(file, tmp_path):
    whole = file.read_bytes()
    for place in (100, len(whole) // 2, len(whole) - 30):
        (tmp_path / "part.zip").write_bytes(whole[:place])
        with pytest.raises(ParameterError, match=r"part\.zip"):
            flockenv.policies.load(tmp_path / "part.zip", trust=True)
    with zipfile.ZipFile(tmp_path / "other.zip", "w") as archive:
        archive.writestr("policy.pth", b"")
    with pytest.raises(ParameterError, match=r"other.zip is not a model"):
        flockenv.policies.load(tmp_path / "other.zip", trust=True)


@pytest.mark.parametrize(
    ("name", "default"),
    [
        ("mirror_to_target", False),
        ("control_hz", 10.0),
        ("action_mode", "rudder"),
        ("decision_period_s", None),
        ("observation", dict(BLOCKS)),
    ],
)
def test_an_option_that_is_younger_than_the_file_has_its_default(name, default, tmp_path):
    model = PPO("MlpPolicy", rows_env(), device="cpu")
    del model.observation_space.options[name]
    model.save(tmp_path / "older.zip")
    read = flockenv.policies.load(tmp_path / "older.zip", trust=True)
    assert getattr(read, name) == default


def test_blocks_and_options_of_other_builds_are_defaults_or_refused_by_name(tmp_path):
    model = PPO("MlpPolicy", rows_env(), device="cpu")
    options = model.observation_space.options
    options["observation"] = {**options["observation"]}
    del options["observation"]["obstacles"]
    model.save(tmp_path / "older.zip")
    read = flockenv.policies.load(tmp_path / "older.zip", trust=True)
    assert read.observation == BLOCKS
    for more in (options, options["observation"]):
        more["new_option"] = 3
        model.save(tmp_path / "newer.zip")
        with pytest.raises(
            ParameterError, match=r"newer\.zip is not accepted: 'new_option' is not"
        ):
            flockenv.policies.load(tmp_path / "newer.zip", trust=True)
        del more["new_option"]


def test_models_of_other_things_are_refused():
    def ppo(env):
        return PPO("MlpPolicy", env, device="cpu")

    with pytest.raises(ParameterError, match="observation space"):
        ModelPolicy(ppo(VecFrameStack(rows_env(), 2)))
    env = joined_env()
    halves = gymnasium.spaces.Box(env.observation_space.low / 2, env.observation_space.high / 2)
    halved = gymnasium.wrappers.TransformObservation(env, lambda seen: seen / 2, halves)
    with pytest.raises(ParameterError, match="observation space"):
        ModelPolicy(ppo(halved))
    with pytest.raises(ParameterError, match="observation space"):
        flockenv.simulate(PARAMETERS, 0, 1.0, policy=ppo("CartPole-v1"))
    first_action = gymnasium.wrappers.TransformAction(
        joined_env(),
        lambda action: np.repeat(action, 2),
        gymnasium.spaces.Box(-1.0, 1.0, (1,), np.float32),
    )
    with pytest.raises(ParameterError, match="action space"):
        ModelPolicy(ppo(first_action))


def test_a_model_of_two_leaders_steers_no_other_number():
    model = PPO("MlpPolicy", joined_env(), device="cpu")
    three = PARAMETERS.replace(n_leaders=3)
    for call in (
        lambda: flockenv.simulate(three, 0, 1.0, policy=model),
        lambda: compare_leaders(PARAMETERS, [2, 3], {"mine": lambda: model}, [0], 1.0),
        lambda: ModelPolicy(model).predict(flockenv.LeadersEnv(params=three).reset(seed=0)[0]),
    ):
        with pytest.raises(ParameterError, match="leaders at once"):
            call()
    rows = PPO("MlpPolicy", rows_env(), device="cpu")
    assert len(flockenv.simulate(three, 0, 1.0, policy=rows)) == 11


def test_normalized_observations_are_normalized_wherever_it_steers():
    venv = VecNormalize(rows_env())
    model = PPO("MlpPolicy", venv, n_steps=8, batch_size=8, seed=0, device="cpu").learn(64)
    observations, _ = flockenv.LeadersEnv(**OPTIONS).reset(seed=1)
    rudders, _ = ModelPolicy(model).predict(observations)
    rows = venv.normalize_obs(observations.reshape(2, -1))
    np.testing.assert_allclose(rudders, model.predict(rows, deterministic=True)[0][:, 0])
    assert np.abs(rudders - model.predict(observations.reshape(2, -1))[0][:, 0]).max() > 1e-3


def test_files_of_models_in_vec_normalize_are_refused(tmp_path):
    model = PPO("MlpPolicy", VecNormalize(rows_env()), n_steps=8, batch_size=8, device="cpu")
    model.learn(32).save(tmp_path / "model.zip")
    with pytest.raises(ParameterError, match="was trained in VecNormalize, and its file does not"):
        flockenv.policies.load(tmp_path / "model.zip", trust=True)
    plain = PPO("MlpPolicy", rows_env(), n_steps=8, batch_size=8, device="cpu")
    plain.learn(32).save(tmp_path / "plain.zip")
    assert flockenv.policies.load(tmp_path / "plain.zip", trust=True).leaders == 1


@pytest.mark.parametrize(("algorithm", "options"), [(SAC, {}), (DQN, {"rudder_levels": 3})])
def test_off_policy_models_are_refused_only_if_they_were_trained_in_vec_normalize(
    algorithm, options, tmp_path
):
    """Without VecNormalize, too, they store their last original observations."""
    for wrap, is_refused in ((lambda env: env, False), (VecNormalize, True)):
        training = wrap(rows_env(**options))
        model = algorithm("MlpPolicy", training, learning_starts=8, device="cpu").learn(32)
        model.save(tmp_path / "model.zip")
        alone = algorithm.load(tmp_path / "model.zip", device="cpu")
        expected = pytest.raises(ParameterError, match="trained in VecNormalize")
        for load in (
            lambda alone=alone: ModelPolicy(alone),
            lambda: flockenv.policies.load(tmp_path / "model.zip", trust=True),
        ):
            with expected if is_refused else nullcontext():
                assert load().leaders == 1


def test_what_a_model_says_beyond_the_rudders_range_is_clipped():
    """Models of stable-baselines3 clip by themselves, others that have their spaces may not."""
    env = flockenv.parallel_env(n_boats=8, n_leaders=2)
    model = SimpleNamespace(
        observation_space=env.observation_space("leader_0"),
        action_space=env.action_space("leader_0"),
        predict=lambda rows, *_: (np.array([[3.0], [-7.5]])[: len(rows)], None),
    )
    observations, _ = env.reset(seed=1)
    rudders, _ = ModelPolicy(model).predict(np.concatenate([*observations.values()]))
    assert rudders.tolist() == [1.0, -1.0]
