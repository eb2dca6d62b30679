"""`flockenv train`."""

from pathlib import Path
from typing import Annotated

import typer

from flockenv.cli.console import interruptible, print_json, progress_bar, say
from flockenv.cli.output import check_folder, keep
from flockenv.cli.parameters import changed_fields
from flockenv.errors import ParameterError

__all__ = ["train"]


def train(
    pool: Annotated[str | None, typer.Option(help="wide or narrow. [wide]")] = None,
    leaders: Annotated[int | None, typer.Option(help="Leaders of each flock. [3]")] = None,
    flock_hours: Annotated[
        float | None, typer.Option(help="When to stop: hours of all flocks together. [1200]")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Number of the training. [0]")] = None,
    change: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="NAME=VALUE", help="Change an option of the environment; repeatable."
        ),
    ] = None,
    ppo: Annotated[
        list[str] | None,
        typer.Option("--ppo", metavar="NAME=VALUE", help="Change an option of PPO; repeatable."),
    ] = None,
    episodes: Annotated[
        int, typer.Option(min=2, help="Held-out flocks to compare with the laws in.")
    ] = 64,
    out: Annotated[Path, typer.Option(help="Folder for the model and the run.")] = Path(
        "results/train"
    ),
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue from the folder's last checkpoint.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the means as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Train one policy for all leaders with PPO (extra `train`).

    It is `examples/train_leaders.py` with options. Writes `model.zip`, which
    `flockenv compare --policy` takes with `--trust`, `settings.toml`, a checkpoint, the episodes of
    the training, `curve.png`, and `comparison.csv`: the signed order of the trained leaders, the
    paper's law and the tuned law in held-out flocks.

    Example: `flockenv train --pool wide --leaders 3 --flock-hours 60`
    """
    from flockenv import training

    changes = {name: changed_fields(given or []) for name, given in (("set", change), ("ppo", ppo))}
    given = {
        "pool": pool,
        "n_leaders": leaders,
        "flock_hours": flock_hours,
        "seed": seed,
        "environment": changes["set"] or None,
        "ppo": changes["ppo"] or None,
    }
    given = {name: value for name, value in given.items() if value is not None}
    if resume and given.keys() - {"flock_hours"}:
        raise ParameterError(
            "--resume takes settings from the folder; only --flock-hours may differ"
        )
    check_folder(out)
    with interruptible(lambda: _last_checkpoint(out)), progress_bar(quiet or as_json) as bar:
        task = bar.add_task("start", total=None)

        def report(progress: training.Progress) -> None:
            if resume and bar.tasks[0].total is None and not (quiet or as_json):
                bar.console.print(f"Resuming from {out / training.CHECKPOINT}")
            order = progress.signed_order
            words = "start" if order is None else f"signed order {order:.3f}"
            bar.update(task, description=words, completed=progress.samples, total=progress.total)

        if resume:
            settings = training.stored_settings(out, flock_hours)
            model = training.resume(out, flock_hours=flock_hours, report=report)
        else:
            settings = training.TrainingSettings.from_dict(given)
            model = training.train(settings, out, report)
    rows = training.compare_with_laws(model, settings, episodes)
    keep(out / "comparison.csv", lambda path: rows.to_csv(path, index=False))
    means = rows.groupby("policy", sort=False)["signed_order"].mean()
    laws = {str(name): float(order) for name, order in means.drop("trained").items()}
    keep(
        out / "curve.png",
        lambda path: training.draw_curve(training.learning_curve(out), laws, path),
    )
    if as_json:
        print_json({"signed_order": means.to_dict(), "model": str(out / training.MODEL)})
        return
    for name, order in means.items():
        say(f"{name}: signed order {order:.3f} in {episodes} held-out flocks")
    say(f"Written to {out}")


def _last_checkpoint(out: Path) -> str:
    if (out / "checkpoint.zip").exists():
        return f"The last checkpoint is stored: flockenv train --resume --out {out}"
    return "There is no checkpoint yet: start again."
