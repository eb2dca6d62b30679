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

from flockenv import FlockParameters
from flockenv.comparison import compare_leaders
from flockenv.policies import LeaningLaw
from flockenv.runs.seeds import POLICY_SEEDS, release_seeds
from flockenv.sb3 import LeaderVecEnv, SharedNoisePolicy, shared_noise


@dataclass(frozen=True)
class Settings:
    """Everything that a training depends on."""

    seed: int = 0
    flock_hours: int = 500
    test_flocks: int = 512
    num_flocks: int = 128  # stepped together
    # The flocks: 27 boats at the critical noise of the pool.
    pool: str = "wide"
    bw_s: float = 0.31
    n_boats: int = 27
    n_leaders: int = 3
    # The task: a leader decides every second how far it leans outward of the target's tangent.
    episode_s: float = 480.0
    decision_period_s: float = 1.0
    contact_alignment: float = 30.0
    reward_horizon_s: float = 40.0
    # PPO. All leaders of a flock explore by the same perturbed weights, which are held for hold_s.
    n_steps: int = 240
    batch_size: int = 11_520
    n_epochs: int = 4
    learning_rate: float = 2e-3
    gamma: float = 0.995
    gae_lambda: float = 0.9875
    hold_s: float = 240.0
    log_std: float = -2.4


def environment(given: Settings) -> LeaderVecEnv:
    """Return flocks, each leader a slot. A leader sees the lean features alone."""
    others = {"own": False, "phase": False, "target": False, "neighbors": 0, "order": False}
    return LeaderVecEnv(
        given.num_flocks,
        pool=given.pool,
        bw_s=given.bw_s,
        n_boats=given.n_boats,
        n_leaders=given.n_leaders,
        target="random",
        mirror_to_target=True,
        observation={**others, "lean_features": True},
        action_mode="lean",
        decision_period_s=given.decision_period_s,
        episode_s=given.episode_s,
        reward={"signed_order": 1.0, "contact_alignment": given.contact_alignment},
        reward_horizon_s=given.reward_horizon_s,
        physics="training",
    )


def untrained(given: Settings, env: LeaderVecEnv) -> PPO:
    """Return PPO before its first sample: an actor without hidden layers is a law of leans."""
    model = PPO(
        SharedNoisePolicy,
        env,
        learning_rate=lambda left: given.learning_rate * left,
        n_steps=given.n_steps,
        batch_size=given.batch_size,
        n_epochs=given.n_epochs,
        gamma=given.gamma,
        gae_lambda=given.gae_lambda,
        use_sde=True,
        policy_kwargs={
            **shared_noise(env, given.hold_s),
            "net_arch": {"pi": [], "vf": [64, 64]},
            "log_std_init": given.log_std,
            "squash_output": True,
        },
        seed=given.seed,
        stats_window_size=given.num_flocks * given.n_leaders,
        device="cpu",
    )
    model.policy.log_std.requires_grad_(False)  # the exploration stays as wide as it starts
    return model


given = Settings(*map(int, sys.argv[1:]))
folder = Path("results/train_leaders") / str(given.seed)
env = environment(given)
env.seed(POLICY_SEEDS["training"].seeds(1, run=given.seed)[0])
model = untrained(given, env)
model.set_logger(configure(str(folder), ["csv"]))
model.learn(int(3600 * given.flock_hours * env.decisions_hz) * given.n_leaders)
model.logger.close()
learned = LeaningLaw.from_model(model, given.pool)  # decides every second, as the model does
law = LeaningLaw(given.pool, learned.bias, learned.weights)  # decides at every control step
law.save(folder / "policy.json")
print(f"{time.process_time() / 60:.1f} minutes of one core")

flock = FlockParameters(n_boats=given.n_boats, pool=given.pool, bw_s=given.bw_s)
policies = {"paper's law": "paper's law", "tuned law": "tuned law", "mine": law}
seeds = release_seeds("train_leaders", given.test_flocks)
runs = compare_leaders(flock, [given.n_leaders], policies, seeds, given.episode_s)
print(runs.groupby("policy")["signed_order"].agg(["mean", "sem"]).round(4))

log = pd.read_csv(folder / "progress.csv")
plt.plot(log["time/total_timesteps"], log["rollout/ep_rew_mean"])
plt.xlabel("decisions of leaders")
plt.ylabel("reward of an episode")
plt.savefig(folder / "curve.png")
