"""What of a leaning law matters: groups of its weights left out, or kept alone.

    python baselines/ablate_leaning.py baselines/policies/500-boats.npz --pool 500-boats

A group that is left out leans as it did on average in the states that the whole law visits, so that
what is lost is what it told apart. Three leaders among 27 boats, critical noise, training seeds,
the same for all; differences from the whole law are paired by seed. What each feature is on average
in those states, and the lean that its weight makes of it (rad), is written to NAME-lean.csv beside.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import pandas as pd

import flockenv
from flockenv.analysis import paired_difference
from flockenv.comparison import run_episodes
from flockenv.observation import observation_entries
from flockenv.policies import LeaningLaw, load
from flockenv.policies.leaning_law import FEATURES, features
from flockenv.seeds import training_seed
from flockenv.whole_file import whole_file

GROUPS = {
    "outer wall": ("radial_position", "near_outer_wall"),
    "own velocity": ("outward_velocity", "clockwise_velocity", "forward_velocity"),
    "order of the flock": tuple(name for name in FEATURES if name.startswith("mean_")),
    "normal neighbours": tuple(
        name
        for name in FEATURES
        if name.startswith(("near", "opposed", "turned")) and "wall" not in name
    ),
    "other leaders": tuple(name for name in FEATURES if name.startswith("leaders")),
}
FIRST_SEED = 1 << 40


def usual(law: LeaningLaw, scene: flockenv.FlockParameters) -> dict[str, float]:
    """Mean of each feature in the states that a law visits."""
    names = [entry.name for entry in observation_entries()]
    env = flockenv.LeadersVectorEnv(32, params=scene, mirror_to_target=True, target="random")
    rows, _ = env.reset(seed=[training_seed(FIRST_SEED + i) for i in range(32)])
    seen = []
    for _ in range(2400):
        rows, *_ = env.step(law.predict(rows)[0])
        seen.append(features(rows.reshape(-1, len(names)), names).mean(axis=0))
    return dict(zip(FEATURES, np.mean(seen, axis=0).tolist(), strict=True))


def leans(law: LeaningLaw, means: dict[str, float]) -> pd.DataFrame:
    """What each weight adds to the lean on average; the first row is the bias."""
    weights = {"bias": law.bias, **law.weights}
    found = {"weight": pd.Series(weights), "mean": pd.Series({"bias": 1.0, **means})}
    table = pd.DataFrame(found).loc[list(weights)]
    return table.assign(lean_rad=table["weight"] * table["mean"]).rename_axis("feature")


def variants(law: LeaningLaw, means: dict[str, float]) -> dict[str, LeaningLaw]:
    def without(*left_out: str) -> LeaningLaw:
        kept = {name: weight for name, weight in law.weights.items() if name not in left_out}
        bias = law.bias + sum(law.weights.get(name, 0.0) * means[name] for name in left_out)
        return LeaningLaw(law.gains, bias, kept)

    found = {"whole": law, "no weights": without(*FEATURES)}
    for name, group in GROUPS.items():
        found[f"without {name}"] = without(*group)
        found[f"{name} alone"] = without(*(each for each in FEATURES if each not in group))
    return found


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("law", type=Path)
    parser.add_argument("--pool", choices=("500-boats", "table-1"), required=True)
    parser.add_argument("--episodes", type=int, default=128)
    parser.add_argument("--minutes", type=float, default=8.0, help="length of an episode")
    parser.add_argument("--out", type=Path, default=Path("results/ablation.csv"))
    options = parser.parse_args(arguments)
    scene = flockenv.FlockParameters.preset("simulation").replace(
        pool=options.pool,
        n_boats=27,
        n_leaders=3,
        bw_s=flockenv.FlockParameters.critical_bw_s("simulation", options.pool),
    )
    seeds = [training_seed(FIRST_SEED + 1000 + i) for i in range(options.episodes)]
    try:
        law = load(options.law)
        if not isinstance(law, LeaningLaw):
            raise flockenv.ParameterError(f"{options.law} is a {law!r}, not a leaning law")
        rows: list[dict[str, object]] = []
        whole, means = None, usual(law, scene)
        for name, each in variants(law, means).items():
            orders = run_episodes(scene, each, seeds, options.minutes * 60.0)["signed_order"]
            whole = orders if whole is None else whole
            beyond = paired_difference(orders, whole)
            rows.append(
                {"law": name, "signed_order": orders.mean(), "beyond_whole": beyond.mean}
                | {"low": beyond.low, "high": beyond.high}
            )
            print(f"{name:32s} {orders.mean():.3f}  {beyond.mean:+.3f}", flush=True)
        options.out.parent.mkdir(parents=True, exist_ok=True)
        tables = {
            options.out: pd.DataFrame(rows).set_index("law"),
            options.out.with_stem(f"{options.out.stem}-lean"): leans(law, means),
        }
        for path, table in tables.items():
            with whole_file(path) as file:
                file.write(table.to_csv(lineterminator="\n").encode())
    except (flockenv.FlockError, OSError) as error:
        sys.exit(f"Error: {error}")
    print(f"written to {options.out}")


if __name__ == "__main__":
    main()
