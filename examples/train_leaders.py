"""Train three leaders with PPO: `python examples/train_leaders.py SEED FLOCK_HOURS TEST_FLOCKS`.

`flockenv train` has the same settings, with a progress bar and checkpoints.
"""

import sys
import time
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd
from stable_baselines3 import PPO
from stable_baselines3.common.logger import configure
from stable_baselines3.common.utils import LinearSchedule

from flockenv import FlockParameters
from flockenv.comparison import compare_leaders
from flockenv.policies import LeaningLaw
from flockenv.runs.seeds import POLICY_SEEDS, release_seeds
from flockenv.sb3 import LeaderVecEnv, SharedNoisePolicy, shared_noise


@dataclass(frozen=True)
class Settings:
    """Amounts of training and testing."""

    seed: int = 0
    flock_hours: int = 500
    test_flocks: int = 512


@dataclass(frozen=True)
class Task:
    """The flocks and their leaders' task: options of LeaderVecEnv."""

    num_flocks: int = 128  # stepped together
    pool: str = "wide"
    bw_s: float = 0.31  # the critical noise of this pool
    n_boats: int = 27
    n_leaders: int = 3
    target: str = "random"
    mirror_to_target: bool = True
    action_mode: str = "lean"  # how far outward of the target's tangent a leader heads
    decision_period_s: float = 1.0
    episode_s: float = 480.0
    reward_horizon_s: float = 40.0
    physics: str = "training"


@dataclass(frozen=True)
class Learner:
    """Options of PPO."""

    n_steps: int = 240
    batch_size: int = 11_520
    n_epochs: int = 4
    gamma: float = 0.995
    gae_lambda: float = 0.9875
    use_sde: bool = True
    device: str = "cpu"


def environment(task: Task) -> LeaderVecEnv:
    """Return the flocks. Each leader is a slot, and observes only the lean features."""
    switched_off = {"own": False, "phase": False, "target": False, "neighbors": 0, "order": False}
    return LeaderVecEnv(
        **vars(task),
        observation={**switched_off, "lean_features": True},
        reward={"signed_order": 1.0, "contact_alignment": 30.0},
    )


def untrained(learner: Learner, env: LeaderVecEnv, seed: int) -> PPO:
    """Return an untrained PPO whose actor has no hidden layers: it is a law of leans."""
    policy = {
        **shared_noise(env, hold_s=240.0),  # leaders of a flock explore alike, for 240 s at a time
        "net_arch": {"pi": [], "vf": [64, 64]},
        "log_std_init": -2.4,
        "squash_output": True,
    }
    rate = LinearSchedule(2e-3, 0.0, 1.0)
    options = {**vars(learner), "learning_rate": rate, "stats_window_size": env.num_envs}
    model = PPO(SharedNoisePolicy, env, policy_kwargs=policy, seed=seed, **options)
    model.policy.log_std.requires_grad_(False)  # the exploration stays as wide as it starts
    return model


settings, task = Settings(*map(int, sys.argv[1:])), Task()
folder = Path("results/train_leaders") / str(settings.seed)
env = environment(task)
env.seed(POLICY_SEEDS["training"].seeds(1, run=settings.seed)[0])
model = untrained(Learner(), env, settings.seed)
model.set_logger(configure(str(folder), ["csv"]))
model.learn(int(3600 * settings.flock_hours * env.decisions_hz) * task.n_leaders)
model.logger.close()
learned = LeaningLaw.from_model(model, task.pool)  # decides every second, as the model does
law = LeaningLaw(task.pool, learned.bias, learned.weights)  # decides at every control step
law.save(folder / "policy.json")
print(f"{time.process_time() / 60:.1f} minutes of one core")

flock = FlockParameters(n_boats=task.n_boats, pool=task.pool, bw_s=task.bw_s)
policies = {"paper's law": "paper's law", "tuned law": "tuned law", "mine": law}
seeds = release_seeds("train_leaders", settings.test_flocks)
runs = compare_leaders(flock, [task.n_leaders], policies, seeds, task.episode_s)
print(runs.groupby("policy")["signed_order"].agg(["mean", "sem"]).round(4))

log = pd.read_csv(folder / "progress.csv")
log.plot("time/total_timesteps", "rollout/ep_rew_mean", xlabel="decisions", ylabel="reward")
plt.savefig(folder / "curve.png")
