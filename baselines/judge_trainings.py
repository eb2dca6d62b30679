"""Judge trainings by `examples/train_leaders.py` in the same fresh flocks, and draw their curves.

    for seed in 0 1 2; do python examples/train_leaders.py $seed 2000 16; done
    python baselines/judge_trainings.py results/train_leaders/* --out docs/training/wide

Each folder is of one seed. The flocks are those in which the example itself compares; their seeds
follow from a hash. Brackets hold 95 % intervals, and differences are paired by flock.

The design was fixed before these trainings: seeds 0, 1 and 2 with 500 flock-hours each, judged in
512 flocks at the default physics against the tuned law. The reward, the width of the exploration
and the time between decisions were chosen by trainings with other seeds, of 1500 flock-hours
together, and by 512 other flocks.

A second design was fixed after those: the same settings and flocks with 2000 flock-hours a seed,
the most that 15 minutes of one core allow.
"""

import argparse
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from flockenv import FlockParameters
from flockenv.comparison import compare_leaders
from flockenv.runs.seeds import release_seeds
from flockenv.statistics import mean_interval, paired_difference

LAWS = ("paper's law", "tuned law")
#: Decisions per flock-hour, three leaders with one every second; episodes over the horizon.
SAMPLES_PER_HOUR, RETURN_PER_REWARD = 3 * 3600, 480.0 / 40.0


def curve(folder: Path) -> pd.DataFrame:
    """Return the mean reward of the last 384 episodes of a training, against flock-hours."""
    log = pd.read_csv(folder / "progress.csv").dropna(subset="rollout/ep_rew_mean")
    return pd.DataFrame(
        {
            "seed": folder.name,
            "flock_hours": log["time/total_timesteps"] / SAMPLES_PER_HOUR,
            "reward": log["rollout/ep_rew_mean"] / RETURN_PER_REWARD,
        }
    )


def judged(folders: list[Path], flocks: int) -> pd.DataFrame:
    """Return the mean order of each training and law, and its difference from the tuned law."""
    policies: dict[str, Any] = {name: name for name in LAWS}
    policies |= {f"seed {each.name}": str(each / "policy.json") for each in folders}
    parameters = FlockParameters(pool="wide", n_boats=27, bw_s=0.31)
    seeds = release_seeds("train_leaders", flocks)
    runs = compare_leaders(parameters, [3], policies, seeds, 480.0)
    orders = runs.pivot(index="seed", columns="policy", values="signed_order")
    rows = []
    for name in policies:
        signed_order, low, high = mean_interval(orders[name])
        row = {"policy": name, "signed_order": signed_order, "low": low, "high": high}
        if name != "tuned law":
            gain = paired_difference(orders[name], orders["tuned law"])
            row |= {"gain": gain.mean, "gain_low": gain.low, "gain_high": gain.high}
        rows.append(row)
    return pd.DataFrame(rows)


def draw(curves: pd.DataFrame, path: Path) -> None:
    """Draw the flocks of training, whose leaders explore."""
    axes = (figure := Figure((6.4, 3.6), layout="constrained")).subplots()
    for seed, own in curves.groupby("seed"):
        axes.plot(own["flock_hours"], own["reward"], label=f"seed {seed}")
    axes.set(xlabel="simulated time of all flocks (hours)", ylabel="mean reward")
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(path, dpi=150)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--flocks", type=int, default=512)
    parser.add_argument("--out", type=Path, default=Path("results/judged"))
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    table, curves = judged(options.folders, options.flocks), pd.concat(map(curve, options.folders))
    table.to_csv(options.out / "evaluation.csv", index=False, float_format="%.4f")
    curves.to_csv(options.out / "learning_curves.csv", index=False, float_format="%.4f")
    draw(curves, options.out / "learning_curves.png")
    print(table.round(3).to_string(index=False))


if __name__ == "__main__":
    main()
