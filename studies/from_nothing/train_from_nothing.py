"""Train three leaders from nothing: rudders, and no law in the action, the start or the reward.

    for seed in 0 1 2; do python -m studies.from_nothing.train_from_nothing wide $seed; done

Seeds 0 to 2 reach an order of 0.457 to 0.479 in `wide`, 8 minutes of one core each, where the
tuned law has 0.443 (results version 5).

The rudder is linear in the lean features and in their products with the forward velocity, as a
rudder works in reverse on a backing boat. The features know no law, and all weights are 0 at first.
PPO of stable-baselines3 trains in two stages: by what a leader's own contacts push and by its own
velocity, with noise of each rudder; then by the order and what its contacts turn, with noise of the
weights that is held for a rollout, as in examples/train_leaders.py. Each stage anneals its learning
rate.

The learning curve is of 256 validation flocks against the processor's time for training alone. Its
last rows are of 512 flocks whose seeds follow from another hash, with the laws in the same flocks.
results/from_nothing has a folder for each pool and seed; here its curve is POOL_SEED.csv.

The design was fixed before these trainings: seeds 0 to 2. Some twenty trainings with other seeds,
of 100 to 500 flock-hours each, chose the features, the rewards, the noise and 2.5 decisions per
second in `wide`. Among them were networks with two hidden layers (0.38) and the default observation
(0.40, single trials).

With the default observation, and its products with the forward velocity, nothing else is changed,
and nothing is searched. Seeds 0 to 2 were to count, whatever they reach: 0.334, 0.374 and 0.391, in
9 minutes of one core each (results version 5), where the paper's law has 0.315 and the damped law
0.408.

    for seed in 0 1 2; do python -m studies.from_nothing.train_from_nothing wide $seed default; done
"""

import sys
import time
from pathlib import Path
from typing import Any

import pandas as pd
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor

from flockenv import FlockParameters
from flockenv.comparison import compare_leaders, score_policies
from flockenv.envs.observation import observation_entries
from flockenv.runs.seeds import POLICY_SEEDS, release_seeds
from flockenv.sb3 import LeaderVecEnv, SharedNoisePolicy, shared_noise
from studies.store import write_table

FLOCKS, LEADERS, DECISIONS_HZ = 128, 3, 2.5
#: Flock-hours of the two stages; flocks that judge during and after the training, and for how long.
HOURS, JUDGES, JUDGED_S = (50.0, 1000.0), (256, 512), 480.0
LAWS = ("paper's law", "damped law", "tuned law")
COLUMNS = ("policy", "stage", "flock_hours", "cpu_s", "signed_order", "low", "high")
OFF = {"own": False, "phase": False, "target": False, "neighbors": 0, "order": False}
#: What a leader observes.
INPUTS: dict[str, dict[str, Any]] = {"lean": {**OFF, "lean_features": True}, "default": {}}


class Products(BaseFeaturesExtractor):
    """The observation, and its products with the forward velocity."""

    def __init__(self, space: Any, speed: int) -> None:
        super().__init__(space, 2 * space.shape[0])
        self.speed = speed

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Return the features, shape (leaders of all flocks, twice the observation)."""
        speed = observations[:, self.speed, None]
        return torch.cat([observations, observations * speed], dim=1)


def flock(pool: str) -> dict[str, Any]:
    """Return 27 boats at the pool's critical noise."""
    bw_s = FlockParameters.critical_bw_s("simulation", pool)
    return {"pool": pool, "n_boats": 27, "bw_s": bw_s}


def stages(pool: str, seed: int, observed: str) -> list[PPO]:
    """Return the model of each stage, whose rudders are 0."""
    observation = INPUTS[observed]
    entries = [entry.name for entry in observation_entries(observation)]
    task: dict[str, Any] = {"observation": observation, "target": "random"}
    task |= {"n_leaders": LEADERS, "control_hz": DECISIONS_HZ, "mirror_to_target": True}
    task |= {"physics": "training", **flock(pool)}
    pushes: dict[str, Any] = {"contact_push": 1.0, "leader_velocity": 0.2}
    turns: dict[str, Any] = {"signed_order": 1.0, "contact_alignment": 30.0}
    first = LeaderVecEnv(FLOCKS, reward=pushes, episode_s=120.0, **task)
    last = LeaderVecEnv(FLOCKS, reward=turns, episode_s=480.0, reward_horizon_s=40.0, **task)
    network = {"features_extractor_class": Products, "net_arch": {"pi": [], "vf": [64, 64]}}
    network["features_extractor_kwargs"] = {"speed": entries.index("forward_velocity")}
    held = {**shared_noise(last, hold_s=240.0), "squash_output": True, "log_std_init": -2.8}
    pushing = {"n_steps": 16, "batch_size": FLOCKS * LEADERS * 8, "n_epochs": 4}
    pushing |= {"gamma": 0.94, "gae_lambda": 0.92, "learning_rate": lambda left: 2e-3 * left}
    turning = {"n_steps": 600, "batch_size": FLOCKS * LEADERS * 75, "n_epochs": 4}
    turning |= {"gamma": 0.998, "gae_lambda": 0.995, "learning_rate": lambda left: 2e-3 * left}
    models = [
        PPO("MlpPolicy", first, policy_kwargs={**network, "log_std_init": -0.7}, **pushing),
        PPO(SharedNoisePolicy, last, policy_kwargs={**network, **held}, use_sde=True, **turning),
    ]
    seeds = POLICY_SEEDS["training"].seeds(2 * FLOCKS, run=seed)
    for stage, model in enumerate(models):
        model.set_random_seed(seed)
        model.env.seed(seeds[stage * FLOCKS])
        torch.nn.init.zeros_(model.policy.action_net.weight)
    models[1].policy.log_std.requires_grad_(False)
    return models


class Curve(BaseCallback):
    """Judges the mean policy four times a stage."""

    def __init__(self, pool: str, rows: list[dict[str, Any]]) -> None:
        super().__init__()
        self.pool, self.rows, self.stage, self.hours, self.cpu_s = pool, rows, 0, 0.0, 0.0

    def _on_training_start(self) -> None:
        self.stage += 1
        self.before, self.due = self.hours, 0.0
        self.resumed = time.process_time()

    def _on_step(self) -> bool:
        return True

    def _on_rollout_end(self) -> None:
        hours = self.num_timesteps / (LEADERS * DECISIONS_HZ * 3600)
        self.hours = self.before + hours
        if hours >= self.due:
            self.due += HOURS[self.stage - 1] / 4
            self.note()

    def _on_training_end(self) -> None:
        self.note()

    def note(self) -> None:
        """Add a point, without the time that it takes."""
        self.cpu_s += time.process_time() - self.resumed
        seeds = release_seeds("from_nothing validation", JUDGES[0])
        point = {"stage": self.stage, "flock_hours": self.hours, "cpu_s": self.cpu_s}
        self.rows += judged(self.pool, {"PPO": self.model}, seeds, point)
        print(self.rows[-1], flush=True)
        self.resumed = time.process_time()


def judged(
    pool: str, policies: dict[str, Any], seeds: range, known: dict[str, Any]
) -> list[dict[str, Any]]:
    """Return the score of each policy."""
    runs = compare_leaders(FlockParameters(**flock(pool)), [LEADERS], policies, seeds, JUDGED_S)
    scores = score_policies(dict(iter(runs.groupby("policy", sort=False)["signed_order"])))
    return [{**row, **known} for row in scores.to_dict("records")]


def write(pool: str, policy: dict[str, Any], rows: list[dict[str, Any]], folder: Path) -> None:
    """Judge the policy beside the laws in fresh flocks, and write the learning curve."""
    end = {"stage": "end", "cpu_s": rows[-1]["cpu_s"]}
    policies = {**dict(zip(LAWS, LAWS, strict=True)), **policy}
    last = judged(pool, policies, release_seeds("from_nothing", JUDGES[1]), end)
    table = pd.DataFrame(rows + last)[list(COLUMNS)]
    write_table(folder / "curve.csv", table, "%.4f")
    print(f"written to {folder}")


def main(pool: str, seed: int, folder: Path, observed: str = "lean") -> None:
    """Train, and write the curve and the model."""
    torch.set_num_threads(1)
    folder.mkdir(parents=True, exist_ok=True)
    rows: list[dict[str, Any]] = []
    curve, models = Curve(pool, rows), stages(pool, seed, observed)
    for stage, model in enumerate(models):
        if stage:
            weights = models[0].policy.action_net.state_dict()
            model.policy.action_net.load_state_dict(weights)
        model.learn(round(HOURS[stage] * LEADERS * DECISIONS_HZ * 3600), callback=curve)
    models[-1].save(folder / "model.zip")
    write(pool, {"PPO": models[-1]}, rows, folder)


if __name__ == "__main__":
    name = Path("results/from_nothing", "_".join(sys.argv[1:]))
    main(sys.argv[1], int(sys.argv[2]), name, *sys.argv[3:])
