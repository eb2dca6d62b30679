"""Law: RLlib trains on the native vector environment, and on the parallel one, flock by flock.

It pins an older gymnasium: `make test-rllib`.
"""

import math

import numpy as np
import pytest

import flockenv
from flockenv.errors import ParameterError

pytestmark = [
    pytest.mark.rllib,
    pytest.mark.timeout(900),
    # RLlib's own use of libraries that have moved on.
    pytest.mark.filterwarnings("ignore"),
]

ray = pytest.importorskip("ray")
torch = pytest.importorskip("torch")

from ray.rllib.algorithms.ppo import PPOConfig  # noqa: E402 - after the check above
from ray.rllib.core.columns import Columns  # noqa: E402
from ray.rllib.core.rl_module.rl_module import RLModuleSpec  # noqa: E402
from ray.rllib.env.wrappers.pettingzoo_env import ParallelPettingZooEnv  # noqa: E402
from ray.tune.registry import register_env  # noqa: E402

from flockenv.rllib import LeadersModule  # noqa: E402

SMALL = {"n_boats": 6, "n_leaders": 2, "episode_s": 5.0}


@pytest.fixture(scope="module", autouse=True)
def cluster():
    ray.init(num_cpus=1, include_dashboard=False, configure_logging=False, log_to_driver=False)
    yield
    ray.shutdown()


def native(num_envs=8, model_config=None, **options):
    """Return PPO on the native vector environment."""
    return (
        PPOConfig()
        .environment("flockenv/Leaders-v0", env_config={**SMALL, **options})
        .env_runners(
            num_env_runners=0,
            num_envs_per_env_runner=num_envs,
            gym_env_vectorize_mode="vector_entry_point",
        )
        .rl_module(rl_module_spec=RLModuleSpec(LeadersModule, model_config=model_config))
        .training(train_batch_size_per_learner=400, minibatch_size=100, num_epochs=2)
        .debugging(seed=0)
    )


def module(model_config=None, **options):
    env = flockenv.LeadersVectorEnv(2, **{**SMALL, **options})
    spec = RLModuleSpec(
        LeadersModule,
        observation_space=env.single_observation_space,
        action_space=env.single_action_space,
        model_config=model_config,
    )
    return spec.build()


def test_ppo_on_the_native_vector_environment(tmp_path):
    algorithm = native().build_algo()
    try:
        assert isinstance(algorithm.env_runner.env.unwrapped, flockenv.LeadersVectorEnv)
        for _ in range(2):
            result = algorithm.train()["env_runners"]
        assert math.isfinite(result["episode_return_mean"])
        assert result["episode_len_mean"] == 50
        trained = algorithm.get_module()
        trained.network_policy({"learner": "RLlib"}).save(tmp_path / "policy.npz")
        # What is sampled with is what was learned.
        sampling = algorithm.env_runner.module.mean[0].weight
        torch.testing.assert_close(sampling, trained.mean[0].weight)
        first = module().mean[0].weight
        assert not torch.equal(sampling, first)
    finally:
        algorithm.stop()
    policy = flockenv.policies.load(tmp_path / "policy.npz")
    env = flockenv.LeadersVectorEnv(4, **SMALL)
    observations, _ = env.reset(seed=1)
    with torch.no_grad():
        batch = {Columns.OBS: torch.from_numpy(observations)}
        distribution = trained.get_inference_action_dist_cls().from_logits(
            trained.forward_inference(batch)[Columns.ACTION_DIST_INPUTS]
        )
    expected = distribution.to_deterministic().sample().clamp(-1, 1).numpy()
    np.testing.assert_allclose(policy.predict(observations)[0], expected, atol=1e-6)
    # Any number of leaders, as the network saw one at a time.
    assert policy.predict(observations.reshape(8, -1))[0].shape == (8, 1)


def test_leaders_that_observe_the_same_act_the_same():
    network = module({"hidden": (16,), "activation": "relu", "first_log_std": -0.5})
    row = torch.randn(1, network.observation_space.shape[0] // 2)
    swapped = torch.cat([torch.zeros_like(row), row], dim=1)
    inputs = torch.cat([torch.cat([row, torch.zeros_like(row)], dim=1), swapped])
    outputs = network.forward_train({Columns.OBS: inputs})[Columns.ACTION_DIST_INPUTS]
    assert outputs.shape == (2, 4)
    torch.testing.assert_close(outputs[0, :2], outputs[1, :2].flip(0))
    assert (outputs[:, 2:] == -0.5).all()
    assert network.compute_values({Columns.OBS: inputs}).shape == (2,)


def test_ppo_on_the_parallel_environment():
    register_env("leaders", lambda config: ParallelPettingZooEnv(flockenv.parallel_env(**config)))
    config = (
        PPOConfig()
        .environment("leaders", env_config=SMALL)
        .env_runners(num_env_runners=0)
        .training(train_batch_size_per_learner=400, minibatch_size=100, num_epochs=2)
        .multi_agent(policies={"leader"}, policy_mapping_fn=lambda *args, **kwargs: "leader")
    )
    algorithm = config.build_algo()
    try:
        for _ in range(2):
            result = algorithm.train()
        assert math.isfinite(result["env_runners"]["episode_return_mean"])
        assert result["env_runners"]["episode_len_mean"] == 50
    finally:
        algorithm.stop()


@pytest.mark.parametrize(
    ("model_config", "options", "message"),
    [
        ({"hiddens": (8,)}, {}, "did you mean 'hidden'"),
        ({"activation": "gelu"}, {}, "'gelu' is not an activation"),
        ({}, {"rudder_levels": 3}, "with continuous actions"),
    ],
)
def test_bad_configurations_are_named(model_config, options, message):
    with pytest.raises(ParameterError, match=message):
        module(model_config, **options)


def test_other_environments_are_refused():
    with pytest.raises(ParameterError, match="take flockenv/Leaders-v0 with continuous"):
        RLModuleSpec(
            LeadersModule,
            observation_space=flockenv.LeadersVectorEnv(1).flock_feature_space,
            action_space=flockenv.LeadersVectorEnv(1).single_action_space,
        ).build()
