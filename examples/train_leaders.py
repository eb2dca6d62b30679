"""Train three leaders with PPO: `python examples/train_leaders.py SEED FLOCK_HOURS TEST_FLOCKS`."""

import sys
import time

import pandas as pd
from stable_baselines3 import PPO
from stable_baselines3.common.logger import configure

from flockenv import FlockParameters
from flockenv.comparison import compare_leaders
from flockenv.policies import LeaningLaw
from flockenv.runs.seeds import POLICY_SEEDS, release_seeds
from flockenv.sb3 import LeaderVecEnv, SharedNoisePolicy, shared_noise

seed, hours, tests = map(int, sys.argv[1:] + ["0", "500", "512"][len(sys.argv) - 1 :])
out, flock = f"results/train_leaders/{seed}", {"pool": "wide", "n_boats": 27, "bw_s": 0.31}
off = {"own": False, "phase": False, "target": False, "neighbors": 0, "order": False}
task = {"observation": {**off, "lean_features": True}, "action_mode": "lean", "target": "random"}
task |= {"mirror_to_target": True, "decision_period_s": 1.0, "reward_horizon_s": 40.0}
task |= {"reward": {"signed_order": 1.0, "contact_alignment": 30.0}, "episode_s": 480.0}
env = LeaderVecEnv(128, n_leaders=3, physics="training", **flock, **task)
policy = {**shared_noise(env, hold_s=240.0), "log_std_init": -2.4, "squash_output": True}
policy |= {"net_arch": {"pi": [], "vf": [64, 64]}}
ppo = {"n_steps": 240, "batch_size": 11520, "n_epochs": 4, "gamma": 0.995, "gae_lambda": 0.9875}
ppo |= {"learning_rate": lambda left: 2e-3 * left, "use_sde": True, "device": "cpu"}
model = PPO(SharedNoisePolicy, env, policy_kwargs=policy, seed=seed, stats_window_size=384, **ppo)
model.set_logger(configure(out, ["csv"]))
env.seed(POLICY_SEEDS["training"].seeds(1, run=seed)[0])
model.policy.log_std.requires_grad_(False)  # the exploration stays as wide as it starts
model.learn(3 * 3600 * hours).logger.close()  # three leaders decide every second
law = LeaningLaw.from_model(model, "wide")  # its copy decides at every control step:
LeaningLaw("wide", law.bias, law.weights).save(f"{out}/policy.json")
print(f"{time.process_time() / 60:.1f} minutes of one core")
ladder = {"paper's law": "paper's law", "tuned law": "tuned law", "mine": f"{out}/policy.json"}
fresh, flock = release_seeds("train_leaders", tests), FlockParameters(**flock)
orders = compare_leaders(flock, [3], ladder, fresh, 480.0).groupby("policy")["signed_order"]
print(orders.agg(["mean", "sem"]).round(4))
log = pd.read_csv(f"{out}/progress.csv")
log.plot("time/total_timesteps", "rollout/ep_rew_mean").figure.savefig(f"{out}/curve.png")
