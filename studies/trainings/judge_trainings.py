"""Judge trainings by `examples/train_leaders.py` in the same 512 flocks.

    for seed in 0 1 2 3 4; do
        python examples/train_leaders.py $seed 500 16
        python baselines/train_with_trpo.py $seed 500 results/trpo/$seed
        python baselines/evolution_strategy.py --task wide --flock-hours 500 --seed $seed \\
            --sigma 0.3 --learning-rate 0.1 --out results/evolution/$seed
    done
    python -m studies.trainings.judge_trainings results/train_leaders/* results/trpo/* \\
        results/evolution/* --out studies/trainings/results/algorithms

Each folder is of one seed, and the folder around it of one algorithm. The flocks are those in which
the example itself compares, whatever the design; no training saw them. Brackets hold 95 %
intervals, and differences are paired by flock. That of an algorithm's mean draws its seeds and the
flocks, which all seeds share (`flockenv.statistics.two_way_interval`). 512 flocks take half a
minute of one core for each policy.

Each design was fixed before its trainings. All trainings count, and none was chosen:

- PPO, TRPO and an evolution strategy, seeds 0 to 4 with 500 flock-hours each. Before, trainings
  with other seeds, 1500 flock-hours together, chose PPO's reward, exploration and time between
  decisions, in 512 other flocks; four target divergences of TRPO and six settings of the evolution
  strategy were tried with seed 10 and 250 flock-hours each.
- Paired branches: seeds 0 to 4 with 200 flock-hours each. Ten searches, 1200 flock-hours together,
  chose the length of a branch, the changes and the learning rate, in 256 or 384 other flocks.

    for seed in 0 1 2 3 4; do python baselines/paired_branches.py --seed $seed; done
    python -m studies.trainings.judge_trainings results/paired/* \\
        --out studies/trainings/results/paired

- Group-relative policy optimization: seeds 0 to 4 with 200 flock-hours each. Two trainings, 400
  flock-hours together, chose the step and the exploration, in 256 other flocks.

    for seed in 0 1 2 3 4; do python baselines/group_relative.py --seed $seed; done
    python -m studies.trainings.judge_trainings results/group/* \\
        --out studies/trainings/results/group

- What `make pretrained` makes: seeds 0 to 7, after 500 and 1101 flock-hours, no setting searched.

    python -m studies.trainings.judge_trainings results/pretrained/wide/* \\
        --out studies/trainings/results/pretrained
    python -m studies.trainings.judge_trainings results/pretrained/wide-500/* --suffix=-500 \\
        --out studies/trainings/results/pretrained
"""

import argparse
from pathlib import Path
from typing import Any

import pandas as pd

from flockenv import FlockParameters
from flockenv.comparison import compare_leaders, score_policies
from flockenv.runs.seeds import release_seeds
from flockenv.statistics import two_way_interval
from studies.store import check_version, write_table
from studies.study import run

LAWS = ("paper's law", "tuned law")


def several(folders: list[Path]) -> bool:
    """Return whether the trainings are of several algorithms."""
    return len({each.parent for each in folders}) > 1


def orders(folders: list[Path], flocks: int) -> pd.DataFrame:
    """Return the signed order of each law and training (columns) in each flock (rows)."""
    policies: dict[str, Any] = {name: name for name in LAWS}
    for each in folders:
        algorithm = each.parent.name if several(folders) else "seed"
        policies[f"{algorithm} {each.name}"] = str(each / "policy.json")
    parameters = FlockParameters(pool="wide", n_boats=27, bw_s=0.31)
    seeds = release_seeds("train_leaders", flocks)
    runs = compare_leaders(parameters, [3], policies, seeds, 480.0)
    return runs.pivot(index="seed", columns="policy", values="signed_order")[list(policies)]


def judged(found: pd.DataFrame) -> pd.DataFrame:
    """Return the score of each training and law, its gain being that on the tuned law."""
    return score_policies(dict(found.items()), "tuned law")


def algorithms(found: pd.DataFrame) -> pd.DataFrame:
    """Return the mean gain of each algorithm over its seeds.

    All seeds met the same flocks, and the same runs of the tuned law in them, so that the interval
    draws seeds and flocks.
    """
    trained = found.drop(columns=[*LAWS])
    gains = trained.sub(found["tuned law"], axis=0)
    named = trained.columns.str.rsplit(n=1).str[0]
    rows = []
    for name in dict.fromkeys(named):
        own, means = gains.loc[:, named == name], trained.loc[:, named == name].mean()
        row = {"algorithm": name, "seeds": len(means), "signed_order": means.mean()}
        row |= {"lowest": means.min(), "highest": means.max(), "gain": own.to_numpy().mean()}
        if len(means) > 1:
            _, row["gain_low"], row["gain_high"] = two_way_interval(own.T)
            row["interval"] = "drawn"
        rows.append(row)
    return pd.DataFrame(rows)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--flocks", type=int, default=512)
    parser.add_argument("--out", type=Path, default=Path("results/judged"))
    parser.add_argument("--suffix", default="", help="of the names of both tables")
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    tables = {"evaluation": judged, "algorithms": algorithms}
    paths = {name: options.out / f"{name}{options.suffix}.csv" for name in tables}
    for path in paths.values():
        check_version(path)
    found = orders(options.folders, options.flocks)
    for name, path in paths.items():
        table = tables[name](found)
        write_table(path, table, "%.4f")
        print(table.round(3).to_string(index=False))


if __name__ == "__main__":
    run(main, resumes=False)
