"""Choose PPO's settings by a recorded search of short runs.

    python baselines/search_ppo.py                      # ten runs, half an hour on one core
    flockenv train --settings results/search_ppo/best.toml --samples 4000000

The settings are those of ppo_shared_policy.py, with those in RANGES drawn from a Latin hypercube.
Each run ends with a validation of its policy, always in the same training episodes. The damped law,
as a clone of which every run starts, is validated first. Each run's settings and scores are written
to results/search_ppo/search.csv, and an interrupted command resumes with the missing runs.
"""

import argparse
import shlex
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
from ppo_shared_policy import SETTINGS
from rich.progress import Progress
from run_number import run_number
from scipy.stats import qmc
from script_end import one_line_end

import flockenv
from flockenv import training
from flockenv._io.atomic_write import write_csv, write_text
from flockenv.policies.laws import LAWS
from flockenv.training.validation import validation_scores


def log_between(low: float, high: float) -> Callable[[float], float]:
    return lambda share: float(f"{low * (high / low) ** share:.3g}")


def one_of(*values: Any) -> Callable[[float], Any]:
    return lambda share: values[min(int(share * len(values)), len(values) - 1)]


def memory(low: float, high: float) -> Callable[[float], float]:
    """A decay by the steps that it reaches over."""
    reach = log_between(low, high)
    return lambda share: round(1.0 - 1.0 / reach(share), 5)


#: What a share in [0, 1) of each setting's range means.
RANGES: dict[str, Callable[[float], Any]] = {
    "learning_rate": log_between(3e-5, 1e-3),
    "gamma": memory(25.0, 1000.0),
    "gae_lambda": memory(5.0, 200.0),
    "n_steps": one_of(64, 128, 256, 512),
    "n_epochs": one_of(2, 4, 8),
    "clip_range": log_between(0.05, 0.3),
    "log_std_init": lambda share: round(-2.0 + 1.5 * share, 2),
    "use_sde": one_of(False, True),
    "control_hz": one_of(2.5, 5.0, 10.0),
}


def drawn(options: argparse.Namespace) -> list[training.TrainingSettings]:
    """The settings of all runs."""
    shares = qmc.LatinHypercube(len(RANGES), rng=options.seed).random(options.runs)
    base = SETTINGS.replace(
        samples=options.samples,
        seed=options.seed,
        validate_every=options.samples,
        validation_episodes=options.episodes,
    )
    named = (dict(zip(RANGES, each, strict=True)) for each in shares.tolist())
    values = ({name: RANGES[name](share) for name, share in each.items()} for each in named)
    return [
        base.replace(**each, final_learning_rate=float(f"{each['learning_rate'] / 10:.3g}"))
        for each in values
    ]


def score(settings: training.TrainingSettings, folder: Path, command: str) -> dict[str, float]:
    """Train, resume or read a finished run, and return the final scores."""
    if (folder / "checkpoint.npz").exists():
        if training.stored_settings(folder) != settings:
            raise flockenv.ParameterError(f"{folder} is of another search: name another --out")
        result = training.resume(folder)
    else:
        result = training.train(settings, folder, command=command)
    last = dict(result.progress.validations[-1])
    return {"wall_s": round(result.progress.wall_s), **last}


def search(options: argparse.Namespace, command: str) -> pd.DataFrame:
    """Run all and write the table and the best run's settings."""
    rows, settings = [], drawn(options)
    law = LAWS[SETTINGS.start](mirror_to_target=SETTINGS.mirror_to_target)
    with Progress(disable=options.quiet) as progress:
        task = progress.add_task(SETTINGS.start, total=1 + len(settings))
        scores = validation_scores(law, settings[0])
        rows.append({"run": SETTINGS.start, "mean": sum(scores.values()) / len(scores), **scores})
        for number, each in enumerate(settings):
            progress.update(task, description=f"run {number}", completed=1 + number)
            found = score(each, options.out / f"run-{number}", command)
            rows.append({"run": number, **{name: getattr(each, name) for name in RANGES}, **found})
        progress.update(task, completed=1 + len(settings))
    # The law has no settings; the columns are those of a run.
    table = pd.DataFrame(rows)[list(rows[-1])]
    write_csv(options.out / "search.csv", table, float_format="%.5g")
    best = settings[int(table["mean"][1:].to_numpy().argmax())]
    write_text(options.out / "best.toml", best.to_toml())
    return table


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--samples", type=int, default=600_000, help="of each run")
    parser.add_argument("--episodes", type=int, default=64, help="of each flock's validation")
    parser.add_argument("--seed", type=run_number, default=0)
    parser.add_argument("--out", type=Path, default=Path("results/search_ppo"))
    parser.add_argument("--quiet", action="store_true")
    options = parser.parse_args(arguments)
    if options.runs < 1:
        parser.error("there is at least one run")
    given = sys.argv[1:] if arguments is None else arguments
    command = shlex.join(["python", "baselines/search_ppo.py", *given])
    with one_line_end(lambda: f"the same command resumes from {options.out}"):
        options.out.mkdir(parents=True, exist_ok=True)
        table = search(options, command)
    print(table.sort_values("mean", ascending=False).to_string(index=False))
    print(f"written to {options.out}")


if __name__ == "__main__":
    main()
