"""Search PPO's settings with Optuna: trials of equal flock-hours, judged in pairs with the law.

    python baselines/search_ppo.py                      # forty trials of 60 flock-hours, wide
    flockenv train --settings results/search_ppo/best.toml --flock-hours 1350

The action of every trial is a lean, of which 0 is the tuned damped law. At each of a trial's
`--rungs` the moving average of its weights and the law lead the same training flocks, and the mean
difference of their signed orders is what the search maximizes (Optuna's TPE sampler, seeded). A
trial is pruned where the upper end of the interval of its difference lies below the best finished
trial's difference at the same rung. The flocks of one search judge all of its trials, so that the
best difference overestimates. Trials are written to results/search_ppo/search.csv and the best
one's settings to best.toml; an interrupted command resumes with the same bytes. Needs the extras
`train`, `plot` and `search`.
"""

import argparse
import math
import shlex
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import optuna
import pandas as pd
from numpy.typing import NDArray
from optuna.distributions import BaseDistribution, CategoricalDistribution, FloatDistribution
from optuna.trial import TrialState
from rich.progress import Progress
from run_number import run_number
from script_end import one_line_end

import flockenv
from flockenv import training
from flockenv._io.atomic_write import write_csv, write_text
from flockenv.policies import load
from flockenv.policies.pretrained import tuned_law
from flockenv.statistics.intervals import mean_interval
from flockenv.training import TrainingSettings
from flockenv.training.validation import validation_episodes

LAW = "damped law"

#: What each setting may be. Noises are held for whole numbers of every decision period.
SPACE: dict[str, BaseDistribution] = {
    "learning_rate": FloatDistribution(1e-4, 3e-3, log=True),
    "deviation": FloatDistribution(0.2, 0.9),
    "hold_s": CategoricalDistribution([8.0, 16.0, 24.0, 48.0]),
    "horizon_s": FloatDistribution(20.0, 400.0, log=True),
    "lambda_4s": FloatDistribution(0.8, 0.99),
    "decision_s": CategoricalDistribution([1.0, 2.0, 4.0]),
    "encoder": CategoricalDistribution(["none", "deepsets", "leaning"]),
    "net_arch": CategoricalDistribution(["", "32", "64 64"]),
}

#: One of each.
FIRST = {
    name: each.choices[0] if isinstance(each, CategoricalDistribution) else each.low
    for name, each in SPACE.items()
}

#: What all trials share. A rollout is 240 s of each flock, in eight minibatches.
SHARED: dict[str, Any] = {
    "noise": (1.0, 1.0),
    "episode_s": 480.0,
    "num_flocks": 64,
    "n_epochs": 4,
    "critic": "flock",
    "critic_arch": (128, 128),
    "squash": True,
    "learn_log_std": False,
    "average": 0.1,
    # What a trial itself validates is not used; its rungs are.
    "validate_from": 1.0,
    "validation_episodes": 2,
    "validation_s": 240.0,
}
ROLLOUT_S = 240.0
MINIBATCHES = 8
#: Options that a search has to keep when it is resumed.
SHAPE = ("pools", "leaders", "flock_hours", "rungs", "episodes", "seed")


def settings_of(values: dict[str, Any], options: argparse.Namespace) -> TrainingSettings:
    """Return the settings of a trial."""
    period, rate = values["decision_s"], float(f"{values['learning_rate']:.3g}")
    steps = round(ROLLOUT_S / period)
    leaders = len(options.pools) * sum(
        options.leaders[flock % len(options.leaders)] for flock in range(SHARED["num_flocks"])
    )
    settings = TrainingSettings.from_dict(
        {
            **SHARED,
            "pools": options.pools,
            "n_leaders": options.leaders,
            "flock_hours": options.flock_hours,
            "seed": options.seed,
            "n_steps": steps,
            "batch_size": steps * leaders // MINIBATCHES,
            "learning_rate": rate,
            "final_learning_rate": rate / 3.0,
            "gamma": round(math.exp(-period / values["horizon_s"]), 6),
            "gae_lambda": round(values["lambda_4s"] ** (period / 4.0), 6),
            "log_std_init": round(math.log(values["deviation"]), 3),
            "shared_noise_s": values["hold_s"],
            "encoder": values["encoder"],
            "net_arch": [int(size) for size in values["net_arch"].split()],
            "options": {
                "action_mode": "lean",
                "decision_period_s": period,
                "physics": "training",
                "reward_horizon_s": round(values["horizon_s"], 1),
            },
        }
    )
    return settings.replace(checkpoint_every=math.ceil(settings.total_samples / options.rungs))


def orders(
    policy_of: Callable[[str], Any], settings: TrainingSettings, episodes: int
) -> NDArray[Any]:
    """Return the signed orders for all pools and numbers of leaders, in the same episodes."""
    found = validation_episodes(policy_of, settings.replace(validation_episodes=episodes))
    return np.concatenate(list(found.values()))


class BelowTheBest(optuna.pruners.BasePruner):
    """Prune a trial whose difference is below the best finished trial's, interval and all."""

    def prune(self, study: optuna.Study, trial: optuna.trial.FrozenTrial) -> bool:
        rung = trial.last_step
        finished = study.get_trials(deepcopy=False, states=(TrialState.COMPLETE,))
        if rung is None or not finished:
            return False
        best = max(finished, key=lambda each: each.value)
        return trial.user_attrs[f"high {rung}"] < best.intermediate_values[rung]


class Search:
    """A study, and how the law leads the flocks that judge its trials."""

    def __init__(self, options: argparse.Namespace, command: str) -> None:
        self.options, self.command = options, command
        file = optuna.storages.journal.JournalFileBackend(str(options.out / "journal.log"))
        self.study = optuna.create_study(
            storage=optuna.storages.JournalStorage(file),
            study_name="ppo",
            direction="maximize",
            pruner=BelowTheBest(),
            load_if_exists=True,
        )
        shape = {name: getattr(options, name) for name in SHAPE}
        if self.study.user_attrs.get("shape", shape) != shape:
            raise flockenv.ParameterError(f"{options.out} is of another search: name another --out")
        self.study.set_user_attr("shape", shape)
        self.law: NDArray[Any] | None = None

    def advance(self, report: Callable[[int], None]) -> None:
        """Finish the interrupted trial, and make those that are missing."""
        while (trial := self.next_trial()) is not None:
            report(trial.number)
            try:
                self.study.tell(trial, self.run(trial))
            except optuna.TrialPruned:
                self.study.tell(trial, state=TrialState.PRUNED)
            except training.TrainingError as error:
                if isinstance(error.__cause__, OSError):
                    raise
                # With such settings the loss diverges.
                self.study.tell(trial, state=TrialState.FAIL)

    def next_trial(self) -> optuna.Trial | None:
        """Return the trial that was interrupted, a new one, or None at the end."""
        every = self.study.get_trials(deepcopy=False)
        number = sum(each.state.is_finished() for each in every)
        # Each trial has a sampler of its own, so that a resumed search draws what it would have.
        seed = np.random.SeedSequence([self.options.seed, number]).generate_state(1)[0]
        self.study.sampler = optuna.samplers.TPESampler(seed=int(seed))
        for each in every:
            if each.state == TrialState.RUNNING:
                return optuna.Trial(self.study, each._trial_id)
        return self.study.ask() if number < self.options.trials else None

    def run(self, trial: optuna.Trial) -> float:
        """Train from rung to rung and return the difference from the law at the last one."""
        settings = settings_of({name: suggested(trial, name) for name in SPACE}, self.options)
        folder = self.options.out / f"trial-{trial.number}"

        def judge(progress: training.Progress) -> None:
            rung = progress.samples // settings.checkpoint_every
            if progress.samples >= settings.total_samples:
                rung = self.options.rungs
            if rung and rung not in self.measured(trial):
                self.measure(trial, rung, settings, folder)

        if (folder / "checkpoint.npz").exists():
            training.resume(folder, report=judge)
        else:
            training.train(settings, folder, command=self.command, report=judge)
        return self.measured(trial)[self.options.rungs]

    def measured(self, trial: optuna.Trial) -> dict[int, float]:
        """Return the differences from the law by rung."""
        return self.study.get_trials(deepcopy=False)[trial.number].intermediate_values

    def measure(
        self, trial: optuna.Trial, rung: int, settings: TrainingSettings, folder: Path
    ) -> None:
        """Compare the average of the weights with the law, and prune the trial where it is low."""
        if self.law is None:
            self.law = orders(partial(tuned_law, LAW), settings, self.options.episodes)
        policy = load(folder / "last.npz")
        found = orders(lambda pool: policy, settings, self.options.episodes)
        mean, low, high = mean_interval(found - self.law)
        trial.set_user_attr(f"low {rung}", low)
        trial.set_user_attr(f"high {rung}", high)
        trial.report(mean, rung)
        if trial.should_prune():
            raise optuna.TrialPruned

    def write(self) -> pd.DataFrame:
        """Write the table, and the settings of the best trial.

        Raises
        ------
        TrainingError
            If no trial was trained to its end; the table is written.
        """
        rows = []
        for trial in self.study.get_trials(deepcopy=False):
            row = {"trial": trial.number, "state": trial.state.name.lower(), **trial.params}
            rung = trial.last_step
            if rung is not None:
                row["flock_hours"] = self.options.flock_hours * rung / self.options.rungs
                row["difference"] = trial.intermediate_values[rung]
                row |= {end: trial.user_attrs[f"{end} {rung}"] for end in ("low", "high")}
            rows.append(row)
        table = pd.DataFrame(rows)
        write_csv(self.options.out / "search.csv", table, float_format="%.5g")
        if not any(row["state"] == "complete" for row in rows):
            raise training.TrainingError(
                f"none of {len(rows)} trials was trained to its end, since the loss of each became "
                f"infinite or NaN: ask for more with --trials ({self.options.out / 'search.csv'})"
            )
        best = settings_of(self.study.best_trial.params, self.options)
        best = best.replace(validation_episodes=512)
        write_text(self.options.out / "best.toml", best.to_toml())
        return table


def suggested(trial: optuna.Trial, name: str) -> Any:
    """Return what the sampler draws for a setting, or drew before an interrupt."""
    range_ = SPACE[name]
    if isinstance(range_, CategoricalDistribution):
        return trial.suggest_categorical(name, range_.choices)
    return trial.suggest_float(name, range_.low, range_.high, log=range_.log)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pools", nargs="+", default=["wide"])
    parser.add_argument("--leaders", type=int, nargs="+", default=[3])
    parser.add_argument("--trials", type=int, default=40)
    parser.add_argument("--flock-hours", type=float, default=60.0, help="of a whole trial")
    parser.add_argument("--rungs", type=int, default=4, help="comparisons of a trial with the law")
    parser.add_argument("--episodes", type=int, default=64, help="for each pool and number")
    parser.add_argument("--seed", type=run_number, default=0)
    parser.add_argument("--out", type=Path, default=Path("results/search_ppo"))
    parser.add_argument("--quiet", action="store_true")
    options = parser.parse_args(arguments)
    if options.trials < 1 or options.rungs < 1 or options.episodes < 2:
        parser.error("there is at least one trial and one rung, and there are two episodes")
    given = sys.argv[1:] if arguments is None else arguments
    command = shlex.join(["python", "baselines/search_ppo.py", *given])
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    with one_line_end(lambda: f"the same command resumes from {options.out}"):
        # Pools and leaders that are not accepted leave no study.
        settings_of(FIRST, options)
        options.out.mkdir(parents=True, exist_ok=True)
        search = Search(options, command)
        with Progress(disable=options.quiet) as progress:
            task = progress.add_task("trials", total=options.trials)
            search.advance(lambda number: progress.update(task, completed=number))
            progress.update(task, completed=options.trials)
        table = search.write()
    print(table.sort_values("difference", ascending=False).to_string(index=False))
    print(f"{table['flock_hours'].sum():.0f} flock-hours; written to {options.out}")


if __name__ == "__main__":
    main()
