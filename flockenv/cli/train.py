"""`flockenv train`."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flockenv._io.atomic_write import write_csv
from flockenv.cli.console import echo, errors, print_json
from flockenv.cli.options import Printing, option, option_of, takes
from flockenv.cli.parameters import changed_fields
from flockenv.cli.progress import checkpoint_note, progress
from flockenv.errors import ParameterError, refuse_unknown
from flockenv.policies.names import TUNED_LAW
from flockenv.statistics import paired_difference

if TYPE_CHECKING:
    import pandas as pd
    from stable_baselines3 import PPO

    from flockenv.training.ppo import Progress, TrainingSettings


@dataclass(frozen=True, kw_only=True)
class TrainOptions(Printing):
    """Options of `flockenv train`."""

    algorithm: str = option("ppo", "ppo, or branches, which needs no torch.")
    pool: str | None = option(None, "wide or narrow. [wide]")
    n_boats: int | None = option(None, "Boats of each flock. [27]")
    n_leaders: int | None = option(None, "Leaders of each flock. [3]")
    bw_s: float | None = option(None, "Noise: backward duration in s. [critical]")
    flock_hours: float | None = option(
        None, "When to stop: hours of all flocks together. [500, or those of the branches]"
    )
    seed: int | None = option(None, "Seed of the training. [0]")
    change: list[str] | None = option(
        None, "Set an option of the task; repeatable.", "--set", metavar="NAME=VALUE"
    )
    ppo: list[str] | None = option(None, "Set an option of PPO; repeatable.", metavar="NAME=VALUE")
    episodes: int = option(512, "Held-out flocks of the comparison with the laws.", min=2)
    out: Path = option(Path("results/train"), "Folder for the model and the run.")
    resume: bool = option(False, "Continue from the folder's last checkpoint.", "--resume")

    def __post_init__(self) -> None:
        refuse_unknown([self.algorithm], ("ppo", "branches"), "algorithm")
        if self.settings().keys() - {"flock_hours"} and self.resume:
            raise ParameterError(
                "--resume takes settings from the folder; only --flock-hours may differ"
            )

    def settings(self) -> dict[str, object]:
        """Return the settings of the training that the user has set."""
        environment = changed_fields(self.change or [])
        for name, value in (("n_boats", self.n_boats), ("bw_s", self.bw_s)):
            if value is None:
                continue
            if name in environment:
                raise ParameterError(f"{option_of(name)} and --set {name} are both given: give one")
            environment[name] = value
        settings = {
            "pool": self.pool,
            "n_leaders": self.n_leaders,
            "flock_hours": self.flock_hours,
            "seed": self.seed,
            "environment": environment or None,
            "ppo": changed_fields(self.ppo or [], "--ppo") or None,
        }
        return {name: value for name, value in settings.items() if value is not None}


@takes(TrainOptions)
def train(options: TrainOptions) -> None:
    """Train one policy for all leaders, with PPO (extra `train`) or in paired branches.

    PPO is `examples/train_leaders.py` with options. It writes `model.zip` (for `--policy` of
    `flockenv compare`, with `--trust`), `settings.toml`, a checkpoint, the training's episodes,
    `curve.png`, and `comparison.csv`: the signed order of the trained leaders, the paper's law and
    the tuned law in held-out flocks. `--resume` continues an interrupted training.

    `--algorithm branches` needs nothing but flockenv, and gives the same weights to the bit on any
    number of threads. It writes `policy.json` and `curve.csv` instead of a model. `--set` sets its
    options, too: `action_mode=rudder` trains from nothing.

    Example: `flockenv train --algorithm branches --pool wide --n-leaders 3`
    """
    user_settings, out = options.settings(), options.out
    if options.algorithm == "branches":
        from flockenv.cli.train_branches import train_branches

        train_branches(user_settings, out, options.episodes, options, resume=options.resume)
        return
    from flockenv.training import ppo
    from flockenv.training.learning_curve import draw_curve

    model, settings = _train(options, user_settings)
    rows = ppo.compare_with_laws(model, settings, options.episodes)
    write_csv(out / "comparison.csv", rows)
    means = rows.groupby("policy", sort=False)["signed_order"].mean()
    laws = {str(name): float(order) for name, order in means.drop(ppo.TRAINED).items()}
    curve = ppo.learning_curve(out, settings.venv().decisions_hz)
    draw_curve(curve, laws, out / "curve.png")
    _show(options, rows)


def _train(
    options: TrainOptions, user_settings: dict[str, Any]
) -> tuple["PPO", "TrainingSettings"]:
    """Train with PPO, or continue a training; return the model and its settings."""
    from flockenv.training import ppo

    out = options.out
    quiet, note = options.hides_progress, checkpoint_note(out)
    with progress("training", 1.0, quiet, interruptible=False, stored_note=note) as advance:
        reported_share = 0.0

        def report(state: "Progress") -> None:
            nonlocal reported_share
            share, order = state.samples / state.total, state.signed_order
            advance(share - reported_share, None if order is None else f"signed order {order:.3f}")
            reported_share = share

        if options.resume:
            echo(f"Resuming from {out / ppo.CHECKPOINT}", errors)
            settings = ppo.stored_settings(out, options.flock_hours)
            return ppo.resume(out, flock_hours=options.flock_hours, report=report), settings
        try:
            settings = ppo.TrainingSettings.from_dict(user_settings)
            settings.venv()  # It refuses options of the environment.
        except TypeError as error:
            raise ParameterError(str(error)) from error
        return ppo.train(settings, out, report), settings


def _show(options: TrainOptions, rows: "pd.DataFrame") -> None:
    """Print the mean signed orders of the trained leaders and of the laws."""
    from flockenv.comparison.report import overlap_notes
    from flockenv.training import ppo

    orders = rows.pivot(index="seed", columns="policy", values="signed_order")
    means = rows.groupby("policy", sort=False)["signed_order"].mean()
    gain = paired_difference(orders[ppo.TRAINED], orders[TUNED_LAW])
    if options.as_json:
        orders_and_gain = {
            "signed_order": means.to_dict(),
            "gain": [gain.mean, gain.low, gain.high],
        }
        print_json({**orders_and_gain, "model": str(options.out / ppo.MODEL)})
        return
    for name, order in means.items():
        echo(f"{name}: signed order {order:.3f} in {options.episodes} held-out flocks")
    echo(
        f"{ppo.TRAINED} minus {TUNED_LAW}: {gain.mean:+.3f} ({gain.low:+.3f} to "
        f"{gain.high:+.3f}), paired by flock"
    )
    notes = overlap_notes(ppo.episodes_of(options.out), "episodes of the training")
    for line in notes + overlap_notes(rows):
        echo(line)
    echo(f"Written to {options.out}")
