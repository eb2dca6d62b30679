"""Train two leaders with PPO of RLlib, 64 flocks at once, and save a policy for every command.

    python examples/train_with_rllib.py        # 40 iterations; another number may follow

All leaders share one network. The critic sees what all leaders of a flock observe, and the reward
is their mean.
"""

import sys
from pathlib import Path

import ray
import torch
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.core.rl_module.rl_module import RLModuleSpec

from flockenv.rllib import LeadersModule

OPTIONS = {
    "n_boats": 9,
    "n_leaders": 2,
    "pool": "narrow",
    "action_mode": "lean",
    "decision_period_s": 2.0,
    "reward": {"contact_push": 1.0, "signed_order": 0.1},
    "reward_horizon_s": 40.0,
    "physics": "training",
    "episode_s": 40.0,
}
ITERATIONS = int([*sys.argv, "40"][1])  # the first argument, or 40
FILE = Path("results/train_with_rllib/policy.npz")

torch.set_num_threads(1)
ray.init(num_cpus=1, include_dashboard=False)
config = (
    PPOConfig()
    .environment("flockenv/Leaders-v0", env_config=OPTIONS)
    .env_runners(
        num_env_runners=0,
        num_envs_per_env_runner=64,
        gym_env_vectorize_mode="vector_entry_point",
    )
    .rl_module(rl_module_spec=RLModuleSpec(LeadersModule, model_config={"hidden": (64, 64)}))
    .training(
        train_batch_size_per_learner=1280,
        minibatch_size=320,
        num_epochs=4,
        lr=1e-3,
        gamma=0.95,
        lambda_=0.95,
        vf_loss_coeff=0.5,
        grad_clip=0.5,
    )
    .debugging(seed=1 << 31)  # RLlib takes seeds below 2^32
)
algorithm = config.build_algo()
for iteration in range(ITERATIONS):
    result = algorithm.train()["env_runners"]
    print(iteration + 1, "iterations, mean return", result["episode_return_mean"])
policy = algorithm.get_module().network_policy({"learner": "RLlib, PPO"})
FILE.parent.mkdir(parents=True, exist_ok=True)
policy.save(FILE)
algorithm.stop()
ray.shutdown()
