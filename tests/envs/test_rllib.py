"""Law: RLlib trains on the parallel environment. It pins an older gymnasium: `make test-rllib`."""

import math

import pytest

import flockenv

pytestmark = [
    pytest.mark.rllib,
    pytest.mark.timeout(900),
    # RLlib's own use of libraries that have moved on.
    pytest.mark.filterwarnings("ignore"),
]


def test_two_iterations_of_ppo():
    ray = pytest.importorskip("ray")
    from ray.rllib.algorithms.ppo import PPOConfig
    from ray.rllib.env.wrappers.pettingzoo_env import ParallelPettingZooEnv
    from ray.tune.registry import register_env

    options = {"n_boats": 6, "n_leaders": 2, "episode_s": 5.0}
    register_env("leaders", lambda config: ParallelPettingZooEnv(flockenv.parallel_env(**config)))
    ray.init(num_cpus=1, include_dashboard=False, configure_logging=False, log_to_driver=False)
    try:
        config = (
            PPOConfig()
            .environment("leaders", env_config=options)
            .env_runners(num_env_runners=0)
            .training(train_batch_size_per_learner=400, minibatch_size=100, num_epochs=2)
            .multi_agent(policies={"leader"}, policy_mapping_fn=lambda *args, **kwargs: "leader")
        )
        algorithm = config.build_algo()
        for _ in range(2):
            result = algorithm.train()
        returns = result["env_runners"]["episode_return_mean"]
        assert math.isfinite(returns)
        assert result["env_runners"]["episode_len_mean"] == 50
        algorithm.stop()
    finally:
        ray.shutdown()
