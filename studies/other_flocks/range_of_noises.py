"""Train leaders in flocks of a range of noises: is that policy better in every kind of flock?

    python -m studies.other_flocks.range_of_noises          # a quarter of an hour of one core
    python -m studies.other_flocks.beyond_one_noise --policy results/range_of_noises/mean.json \\
        --out results/beyond_range.csv

It is not: it leads better than the tuned law in 13 of the twenty.

They are trained as baselines/pretrained.py trains in `wide`, with one change: each episode draws
its backward duration from 0.2 to 0.4 s. All have 27 boats, as flocks of one environment have one
size. The rule was fixed before the first training: the policy is the mean of the weights of three
seeds, and none is chosen. It is better everywhere if it leads better than the tuned law in each of
the twenty kinds of flocks, by the whole interval.
"""

import argparse
import shlex
import sys
import time
from pathlib import Path

import numpy as np

from flockenv.policies import LeaningLaw
from flockenv.policies.provenance import provenance_of
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.training.ppo import TrainingSettings

SEEDS = (0, 1, 2)
ENVIRONMENT = {"n_leaders": [1, 2, 3, 4], "bw_s": (0.2, 0.4)}


def trained(seed: int, flock_hours: float, flocks: int, command: str) -> LeaningLaw:
    """Return the leans that PPO learns, a law that decides at every control step."""
    start = time.process_time()
    settings = TrainingSettings(
        pool="wide", seed=seed, flock_hours=flock_hours, num_flocks=flocks, environment=ENVIRONMENT
    )
    env = settings.venv()
    env.seed(POLICY_SEEDS["training"].seeds(1, run=seed)[0])
    model = settings.model(env)
    model.learn(settings.samples(env))
    made = provenance_of(
        command,
        seed=seed,
        samples=model.num_timesteps,
        cpu_s=time.process_time() - start,
        flock_hours=model.num_timesteps / env.num_envs * flocks / 3600.0,
    )
    law = LeaningLaw.from_model(model, "wide")
    return LeaningLaw(law.pool, law.bias, law.weights, provenance=made)


def mean_of(laws: list[LeaningLaw], command: str) -> LeaningLaw:
    """Return the mean of laws, number by number."""
    weights = {
        name: float(np.mean([each.weights[name] for each in laws])) for name in laws[0].weights
    }
    made = [law.provenance for law in laws]
    provenance = {
        "command": command,
        "chosen": "mean of all seeds",
        "flockenv": made[0]["flockenv"],
        "commit": ", ".join(sorted({own["commit"] for own in made})),
        "seed": ", ".join(own["seed"] for own in made),
        **{
            name: f"{sum(float(own[name]) for own in made):.10g}"
            for name in ("samples", "flock_hours", "cpu_s")
        },
    }
    bias = float(np.mean([each.bias for each in laws]))
    return LeaningLaw("wide", bias, weights, provenance=provenance)


def main(arguments: list[str] | None = None) -> None:
    """Train each seed that is not there yet, and write the mean of all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--flock-hours", type=float, default=1100.0)
    parser.add_argument("--flocks", type=int, default=128)
    parser.add_argument("--out", type=Path, default=Path("results/range_of_noises"))
    options = parser.parse_args(arguments)
    command = shlex.join(["python", "-m", "studies.other_flocks.range_of_noises", *sys.argv[1:]])
    laws = []
    for seed in SEEDS:
        path = options.out / str(seed) / "policy.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists():
            trained(seed, options.flock_hours, options.flocks, command).save(path)
        laws.append(LeaningLaw.load(path))
    mean_of(laws, command).save(options.out / "mean.json")


if __name__ == "__main__":
    main()
