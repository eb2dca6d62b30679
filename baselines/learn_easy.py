"""Watch plain PPO pass the paper's law in the easy environment, and write its learning curves.

    python baselines/learn_easy.py                               # five seeds, into results/easy
    python baselines/learn_easy.py --seeds 0 --samples 200000

Seeds 0 to 4 reach an order of 0.321 to 0.365, in a minute of one core each, where the paper's law
has 0.294 and the damped law 0.377 (results version 5).

PPO of stable-baselines3 trains four leaders in 64 flocks of `flockenv/Order-easy-v0` at once. The
last point of a curve is the mean signed order of the mean policy in the same 512 held-out flocks as
the laws. The other points use the first 128 of these flocks. The time of a point is the training's
processor time.
"""

import argparse
import time
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pandas as pd
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.utils import LinearSchedule

import flockenv  # noqa: F401 - registers the environment
from flockenv.comparison import score_policies
from flockenv.comparison.score import SCORE
from flockenv.policies import DampedLaw, SteeringLaw
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.sb3 import LeaderVecEnv, evaluate_flocks

OPTIONS = gymnasium.spec("flockenv/Order-easy-v0").kwargs
LAWS = {"paper's law": SteeringLaw, "damped law": DampedLaw}
EPISODES, EARLIER_EPISODES = 512, 128
COLUMNS = ("policy", "seed", "samples", "cpu_s", *SCORE)


def ppo(seed: int) -> PPO:
    """Return untrained PPO on 64 flocks."""
    venv = LeaderVecEnv(64, **OPTIONS)
    model = PPO(
        "MlpPolicy",
        venv,
        LinearSchedule(1e-3, 0.0, 1.0),
        n_steps=128,
        batch_size=4096,
        n_epochs=6,
        gamma=0.99,
        policy_kwargs={"log_std_init": -0.5, "net_arch": [32, 32]},
        seed=seed,
        device="cpu",
    )
    venv.seed(POLICY_SEEDS["easy environment"].seeds(1, seed)[0])
    return model


def orders(policy: Any, flocks: int) -> np.ndarray:
    """Return the signed order of each held-out flock."""
    venv = LeaderVecEnv(flocks, **OPTIONS)
    return evaluate_flocks(policy, venv, flocks, seed=0).signed_order


class Curve(BaseCallback):
    """Scores the mean policy at regular intervals of samples.

    `law` is the signed order of the paper's law in each of the same flocks.
    """

    def __init__(self, seed: int, samples: int, law: np.ndarray) -> None:
        super().__init__()
        self.seed, self.law = seed, law
        self.interval, self.due, self.rows = max(1, samples // 4), 0, list[dict[str, Any]]()
        self.start_s, self.scoring_s = time.process_time(), 0.0

    def _on_rollout_start(self) -> None:
        if self.num_timesteps >= self.due:
            self.add_point(EARLIER_EPISODES)
            self.due += self.interval

    def _on_training_end(self) -> None:
        self.add_point(EPISODES)

    def add_point(self, flocks: int) -> None:
        """Score the policy in this number of flocks; scoring does not count as training time."""
        paused_s = time.process_time()
        orders_by_policy = {"PPO": orders(self.model, flocks), "paper's law": self.law[:flocks]}
        point = {"seed": self.seed, "samples": self.num_timesteps}
        point |= {"cpu_s": paused_s - self.start_s - self.scoring_s}
        self.rows.append(
            score_policies(orders_by_policy, "paper's law").to_dict("records")[0] | point
        )
        self.scoring_s += time.process_time() - paused_s
        print(self.rows[-1], flush=True)

    def _on_step(self) -> bool:
        return True


def learn(seed: int, samples: int, law: np.ndarray) -> list[dict[str, Any]]:
    """Return the points of one learning curve."""
    torch.set_num_threads(1)
    curve = Curve(seed, samples, law)
    ppo(seed).learn(samples, callback=curve)
    return curve.rows


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", nargs="+", type=int, default=[0, 1, 2, 3, 4])
    parser.add_argument("--samples", type=int, default=4_500_000)
    parser.add_argument("--out", type=Path, default=Path("results/easy"))
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    layout = {name: OPTIONS[name] for name in ("observation", "mirror_to_target")}
    law_orders = {name: orders(law(**layout), EPISODES) for name, law in LAWS.items()}
    rows = score_policies(law_orders).to_dict("records")
    for seed in options.seeds:
        rows += learn(seed, options.samples, law_orders["paper's law"])
        table = pd.DataFrame(rows)[[*COLUMNS]].astype({"seed": "Int64", "samples": "Int64"})
        table.to_csv(options.out / "curve.csv", index=False, float_format="%.4f")
    print(f"written to {options.out}")


if __name__ == "__main__":
    main()
