"""Measure which weights of a leaning law matter: groups are left out, or used alone.

    python baselines/ablate_leaning.py baselines/policies/wide.npz --pool wide

A group that is left out contributes its average lean in the states that the whole law visits, so
that only its dependence on the state is lost. Three leaders steer among 27 boats at the critical
noise on the same training seeds, and differences from the whole law are paired by seed. The mean of
each feature in those states and its contribution to the lean (rad) are written to NAME-lean.csv.
"""

import argparse
from pathlib import Path

import numpy as np
import pandas as pd
from rich.progress import Progress
from run_number import run_number
from script_end import one_line_end

import flockenv
from flockenv._io.atomic_write import atomic_write
from flockenv.comparison import run_episodes
from flockenv.envs.observation import observation_entries
from flockenv.policies import LeaningLaw, load
from flockenv.policies.leaning_law import FEATURES, features
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.statistics.intervals import paired_difference

GROUPS = {
    "outer wall": ("radial_position", "near_outer_wall"),
    "own velocity": ("outward_velocity", "clockwise_velocity", "forward_velocity"),
    "order of the flock": tuple(name for name in FEATURES if name.startswith("mean_")),
    "normal neighbors": tuple(
        name
        for name in FEATURES
        if name.startswith(("near", "opposed", "turned")) and "wall" not in name
    ),
    "other leaders": tuple(name for name in FEATURES if name.startswith("leaders")),
}
SEEDS = POLICY_SEEDS["ablation"]
#: In which the mean features are measured.
FLOCKS = 32


def usual(law: LeaningLaw, parameters: flockenv.FlockParameters, run: int) -> dict[str, float]:
    """Mean of each feature in the states that a law visits."""
    names = [entry.name for entry in observation_entries()]
    env = flockenv.LeadersVectorEnv(
        FLOCKS, params=parameters, mirror_to_target=True, target="random"
    )
    rows, _ = env.reset(seed=list(SEEDS.seeds(FLOCKS, run)))
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
        rest = {name: weight for name, weight in law.weights.items() if name not in left_out}
        bias = law.bias + sum(law.weights.get(name, 0.0) * means[name] for name in left_out)
        return LeaningLaw(law.gains, bias, rest)

    found = {"whole": law, "no weights": without(*FEATURES)}
    for name, group in GROUPS.items():
        found[f"without {name}"] = without(*group)
        found[f"{name} alone"] = without(*(each for each in FEATURES if each not in group))
    return found


def ablated(
    law: LeaningLaw,
    parameters: flockenv.FlockParameters,
    episodes: int,
    duration_s: float,
    run: int,
    progress: Progress,
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return each variant's order beyond the whole law, and each weight's part of the lean."""
    task = progress.add_task("states that it visits", total=1)
    means = usual(law, parameters, run)
    seeds = SEEDS.seeds(episodes, run, start=FLOCKS)
    found, rows, whole = variants(law, means), [], None
    progress.update(task, total=1 + len(found), completed=1)
    for name, each in found.items():
        progress.update(task, description=name)
        orders = run_episodes(parameters, each, seeds, duration_s)["signed_order"]
        whole = orders if whole is None else whole
        beyond = paired_difference(orders, whole)
        rows.append(
            {"law": name, "signed_order": orders.mean(), "beyond_whole": beyond.mean}
            | {"low": beyond.low, "high": beyond.high}
        )
        print(f"{name:32s} {orders.mean():.3f}  {beyond.mean:+.3f}", flush=True)
        progress.advance(task)
    return pd.DataFrame(rows).set_index("law"), leans(law, means)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("law", type=Path)
    parser.add_argument("--pool", choices=("wide", "narrow"), required=True)
    parser.add_argument("--episodes", type=int, default=128)
    parser.add_argument("--minutes", type=float, default=8.0, help="length of an episode")
    parser.add_argument("--seed", type=run_number, default=0, help="which training seeds")
    parser.add_argument("--out", type=Path, default=Path("results/ablation.csv"))
    parser.add_argument("--quiet", action="store_true")
    options = parser.parse_args(arguments)
    parameters = flockenv.FlockParameters.preset("simulation").replace(
        pool=options.pool,
        n_boats=27,
        n_leaders=3,
        bw_s=flockenv.FlockParameters.critical_bw_s("simulation", options.pool),
    )
    if options.episodes < 2:
        parser.error("--episodes is at least 2")
    with one_line_end(lambda: "nothing was written"):
        law = load(options.law)
        if not isinstance(law, LeaningLaw):
            raise flockenv.ParameterError(f"{options.law} is a {law!r}, not a leaning law")
        if law.hidden or law.features != FEATURES or law.observation:
            raise flockenv.ParameterError(
                f"{options.law} is a {law!r}, whose features are not those of the groups alone"
            )
        with Progress(disable=options.quiet) as progress:
            table, lean = ablated(
                law, parameters, options.episodes, options.minutes * 60.0, options.seed, progress
            )
        options.out.parent.mkdir(parents=True, exist_ok=True)
        tables = {
            options.out: table,
            options.out.with_stem(f"{options.out.stem}-lean"): lean,
        }
        for path, each in tables.items():
            with atomic_write(path) as file:
                file.write(each.to_csv(lineterminator="\n").encode())
    print(f"written to {options.out}")


if __name__ == "__main__":
    main()
