"""Watch PPO learn in the easy environment, and write its learning curves.

    python baselines/learn_easy.py                    # three seeds, into results/easy
    python baselines/learn_easy.py --seeds 0 --samples 20000
    python baselines/learn_easy.py --out docs/easy    # the data of docs/easy.md

PPO of stable-baselines3 is trained on 64 flocks of `flockenv/Circulate-easy-v0` at once. Each
point of a curve is the mean reward per control step of the mean policy, over the same 64 held-out
episodes. The time of a point is the processor's, for training alone. What it found stands in
docs/easy.md.
"""

import argparse
import csv
import itertools
import time
from functools import partial
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import torch
from matplotlib.figure import Figure
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback

import flockenv  # noqa: F401 - registers the environment
from flockenv.policies import DampedLaw, RandomRudders, SteeringLaw
from flockenv.runs.executors import joblib
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.sb3 import LeaderVecEnv, evaluate_flocks

ENV_ID = "flockenv/Circulate-easy-v0"
OPTIONS = gymnasium.spec(ENV_ID).kwargs
EPISODES = 64
COLUMNS = ("policy", "seed", "samples", "cpu_s", "reward", "reward_low", "reward_high")


def ppo() -> PPO:
    """Return PPO on 64 flocks at once, untrained."""
    return PPO(
        "MlpPolicy",
        LeaderVecEnv(64, **OPTIONS),
        n_steps=64,
        batch_size=1024,
        n_epochs=5,
        gamma=0.97,
        learning_rate=1e-3,
        device="cpu",
    )


def score(policy: Any, venv: LeaderVecEnv) -> dict[str, float]:
    """Return the mean reward per control step of held-out episodes, with its 95 % interval."""
    found = evaluate_flocks(policy, venv, n_eval_episodes=EPISODES, seed=0)
    each = found.returns / found.lengths
    mean, half = each.mean(), 1.96 * each.std(ddof=1) / np.sqrt(len(each))
    return {"reward": mean, "reward_low": mean - half, "reward_high": mean + half}


class Curve(BaseCallback):
    """Evaluates the mean policy every so many samples."""

    def __init__(self, seed: int, every: int) -> None:
        super().__init__()
        self.known = {"policy": "PPO", "seed": seed}
        self.every, self.due, self.rows = every, 0, list[dict[str, Any]]()
        self.venv = LeaderVecEnv(EPISODES, **OPTIONS)
        self.start, self.outside = time.process_time(), 0.0

    def _on_rollout_start(self) -> None:
        if self.num_timesteps >= self.due:
            self.note()
            self.due += self.every

    def note(self) -> None:
        """Add a point."""
        paused = time.process_time()
        found = score(self.model, self.venv)
        cpu_s = paused - self.start - self.outside
        self.rows.append({**self.known, "samples": self.num_timesteps, "cpu_s": cpu_s, **found})
        self.outside += time.process_time() - paused
        print(self.rows[-1], flush=True)

    def _on_step(self) -> bool:
        return True


def learn(seed: int, samples: int) -> list[dict[str, Any]]:
    """Return the points of one learning curve."""
    torch.set_num_threads(1)
    model = ppo()
    model.set_random_seed(seed)
    model.get_env().seed(POLICY_SEEDS["easy environment"].seeds(1, seed)[0])
    curve = Curve(seed, max(samples // 10, 1))
    model.learn(samples, callback=curve)
    curve.note()
    return curve.rows


def references() -> list[dict[str, Any]]:
    """Return the scores of policies that were not trained."""
    venv = LeaderVecEnv(EPISODES, **OPTIONS)
    policies = {
        "random rudders": RandomRudders(),
        "steering law": SteeringLaw(),
        "damped law": DampedLaw(),
    }
    return [{"policy": name, **score(policy, venv)} for name, policy in policies.items()]


def draw(rows: list[dict[str, Any]], path: Path) -> None:
    """Draw the curves, and the references as level lines."""
    figure = Figure((6.4, 3.6), layout="constrained")
    axes = figure.subplots()
    for row in (row for row in rows if "seed" not in row):
        axes.axhline(row["reward"], color="0.5", lw=0.8, ls="--")
        axes.annotate(
            row["policy"],
            (0.995, row["reward"]),
            xycoords=("axes fraction", "data"),
            ha="right",
            va="bottom",
            fontsize=8,
        )
    for seed in sorted({row["seed"] for row in rows if "seed" in row}):
        own = [row for row in rows if row.get("seed") == seed]
        x, y, low, high = (
            [row[column] for row in own]
            for column in ("cpu_s", "reward", "reward_low", "reward_high")
        )
        axes.plot(x, y, label=f"PPO, seed {seed}")
        axes.fill_between(x, low, high, alpha=0.15, lw=0)
    axes.legend(loc="upper left", fontsize=8)
    axes.set(xlabel="processor time of the training (s)", ylabel="mean reward per control step")
    figure.savefig(path, dpi=150)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", nargs="+", type=int, default=[0, 1, 2])
    parser.add_argument("--samples", type=int, default=200_000)
    parser.add_argument("--processes", type=int, default=2, help="curves at once")
    parser.add_argument("--out", type=Path, default=Path("results/easy"))
    options = parser.parse_args(arguments)
    rows = references()
    task = partial(learn, samples=options.samples)
    found = dict(joblib(task, options.seeds, options.processes))
    rows += itertools.chain.from_iterable(found[place] for place in range(len(found)))
    options.out.mkdir(parents=True, exist_ok=True)
    with (options.out / "curve.csv").open("w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        for row in rows:
            shown = {n: round(v, 4) if isinstance(v, float) else v for n, v in row.items()}
            table.writerow(shown)
    draw(rows, options.out / "curve.png")
    print(f"written to {options.out}")


if __name__ == "__main__":
    main()
