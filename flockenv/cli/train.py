"""`flockenv train`."""

import shlex
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from flockenv._io.toml import read_toml_file
from flockenv.cli.console import interruptible, print_json, progress_bar, say
from flockenv.cli.output import check_folder, printable, refuse_overwriting
from flockenv.cli.parameters import TrustOption, changed_fields
from flockenv.errors import ParameterError

__all__ = ["train"]


def train(
    settings: Annotated[
        Path | None, typer.Option(help="What to train: a TOML file. [built-in settings]")
    ] = None,
    change: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Change one setting; may be repeated."),
    ] = None,
    samples: Annotated[
        int | None, typer.Option(min=1, help="When to stop: leaders' control steps.")
    ] = None,
    flock_hours: Annotated[
        float | None, typer.Option(help="When to stop: hours of all flocks together.")
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Number of the training run.")] = None,
    seeds: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=1000,
            help="Train with this many seeds in turn and compare them with the laws on held-out "
            "seeds; the same command resumes.",
        ),
    ] = None,
    episodes: Annotated[
        int | None, typer.Option(min=2, help="With --seeds: held-out episodes per case. [512]")
    ] = None,
    trust: TrustOption = False,
    out: Annotated[Path, typer.Option(help="Folder for the policy and the run.")] = Path(
        "results/train"
    ),
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue from the folder's last checkpoint.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the scores as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Train one policy for all leaders with PPO (extra `train`).

    Writes `best.npz`, the best policy by validation, which `flockenv compare --policy` takes,
    `last.npz`, `curve.csv`, `validations.csv`, `settings.toml`, a checkpoint and logs for
    tensorboard. `docs/train.md` describes the TOML file. With `--seeds N` it trains N times in
    folders `seed-0` and so on, and writes `learning_curves.csv` and `.png` and `evaluation.csv`.

    Example: `flockenv train --set 'pools=["narrow"]' --set 'start=damped law' --samples 500000`
    """
    from flockenv import training

    if resume and (settings or change or seed is not None):
        raise ParameterError(
            "--resume takes settings from the checkpoint; only --samples or --flock-hours may "
            "differ"
        )
    if episodes is not None and seeds is None:
        raise ParameterError("--episodes is not accepted without --seeds")
    if seeds is not None and resume:
        raise ParameterError("--resume is not accepted with --seeds: the same command resumes")
    if resume:
        wanted = training.stored_settings(out, samples, flock_hours)
    else:
        wanted = _settings(settings, change or [], samples, flock_hours, seed)
        check_folder(out)
        folders = [out / f"seed-{wanted.seed + each}" for each in range(seeds or 0)] or [out]
        refuse_overwriting(settings, "--settings", [each / "settings.toml" for each in folders])
        names = ("best.npz", "last.npz", "start.npz")
        policies = [folder / name for folder in folders for name in names]
        refuse_overwriting(wanted.start, "start", policies)
    if seeds is not None:
        _train_seeds(wanted, out, seeds, episodes or 512, trust, as_json, quiet)
        return
    with interruptible(lambda: _last_checkpoint(out)), progress_bar(quiet or as_json) as bar:
        task = bar.add_task("start", total=wanted.total_samples)

        def report(progress: training.Progress) -> None:
            words = f"{progress.samples} samples"
            if progress.best_score is not None:
                words += f", signed order {progress.best_score:.3f}"
            bar.update(task, description=words, completed=progress.samples)

        if resume:
            result = training.resume(out, samples=samples, flock_hours=flock_hours, report=report)
        else:
            command = printable(shlex.join(["flockenv", *sys.argv[1:]]))
            result = training.train(wanted, out, command=command, report=report, trust=trust)
    progress, trained = result.progress, result.settings
    hours = round(trained.flock_hours_at(progress.samples), 3)
    if as_json:
        wall_s = round(progress.wall_s, 1)
        last = {"samples": progress.samples, "flock_hours": hours, "wall_s": wall_s}
        rows = training.with_flock_hours(progress.validations, trained)
        best = {"best": progress.best_score, "validations": rows}
        print_json({**last, **best, "policy": str(out / "best.npz")})
        return
    for name, value in training.with_flock_hours(progress.validations, trained)[-1].items():
        say(f"{name}: {value:g}")
    say(f"Best mean signed order {progress.best_score:.3f}: {out / 'best.npz'}")


def _train_seeds(
    wanted: Any, out: Path, seeds: int, episodes: int, trust: bool, as_json: bool, quiet: bool
) -> None:
    from flockenv import training

    command = printable(shlex.join(["flockenv", *sys.argv[1:]]))
    resumes = f"What is finished is stored: the same command resumes from {out}"
    with interruptible(lambda: resumes), progress_bar(quiet or as_json) as bar:
        task = bar.add_task("start", total=1.0)
        result = training.train_seeds(
            wanted,
            out,
            seeds,
            episodes=episodes,
            command=command,
            report=lambda words, done: bar.update(task, description=words, completed=done),
            trust=trust,
        )
    last = result.trainings[-1]
    hours = round(last.settings.flock_hours_at(last.progress.samples), 3)
    if as_json:
        rows = result.evaluation.to_dict("records")
        print_json({"seeds": seeds, "flock_hours": hours, "evaluation": rows, "folder": str(out)})
        return
    say(f"{seeds} trainings of {hours:g} flock-hours, {episodes} held-out episodes per case")
    for row in result.evaluation.to_dict("records"):
        minus = f" minus {row['minus']}" if row["minus"] else ""
        ends = f"{row['signed_order']:+.3f} [{row['low']:+.3f}, {row['high']:+.3f}]"
        say(f"{row['case']}: {row['policy']}{minus}: {ends}")
    say(f"Written to {out}")


def _settings(
    path: Path | None,
    change: list[str],
    samples: int | None,
    flock_hours: float | None,
    seed: int | None,
) -> Any:
    from flockenv.training import TrainingSettings

    given = {"samples": samples, "flock_hours": flock_hours, "seed": seed}
    changes = {name: value for name, value in given.items() if value is not None}
    changes = {**changed_fields(change), **changes}
    if path is None:
        return TrainingSettings.from_dict(changes)
    values = read_toml_file(path, f"--settings {path}")
    try:
        stored = TrainingSettings.from_dict(values)
    except ParameterError as error:
        raise ParameterError(f"--settings {path}: {error}") from error
    return stored.replace(**changes)


def _last_checkpoint(out: Path) -> str:
    if (out / "checkpoint.npz").exists():
        return f"The last checkpoint is stored: flockenv train --resume --out {out}"
    return "There is no checkpoint yet: start again."
