"""Trainings that differ in their seeds alone, against the laws on held-out flocks."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flockenv._io.atomic_write import atomic_write, write_csv
from flockenv._io.extras import require
from flockenv.comparison.episodes import run_episodes
from flockenv.errors import ParameterError
from flockenv.policies.pretrained import LEARNED
from flockenv.policies.registry import named_policy
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.statistics.intervals import crossed_replicates, interval, mean_interval
from flockenv.training.checkpoint import Progress
from flockenv.training.ppo import TrainingResult, resume, stored_settings, train
from flockenv.training.rollback_point import with_flock_hours
from flockenv.training.settings import TrainingSettings
from flockenv.training.validation import validation_episodes, validation_flocks

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["RIVALS", "SeedsResult", "train_seeds"]

RIVALS = ("damped law", "tuned damped law", LEARNED)
"""Policies that trainings are compared with."""

EVERY_SEED = "all seeds"

_EPISODE_S = 480.0

_KINDS = _TRAINING, _VALIDATION = "training", "validation"

#: Rollouts in a mean of the drawn curve.
_SMOOTHED = 5

Report = Callable[[str, float], None]


@dataclass(frozen=True)
class SeedsResult:
    """What trainings with several seeds left.

    Attributes
    ----------
    trainings
        One for each seed.
    curves
        Mean signed order of each seed against flock-hours: that of each rollout's flocks, in which
        leaders explore, and validations; and that of the `RIVALS` in the flocks of validations.
    evaluation
        Mean signed order of each policy in held-out flocks, and its differences from the `RIVALS`
        in the same flocks, with intervals. Those of ``all seeds`` are over seeds and flocks
        (`flockenv.statistics.intervals.crossed_replicates`).
    folder
        Where everything is: the trainings in ``seed-N``, ``learning_curves.csv`` and ``.png``,
        ``evaluation.csv``, and ``episodes.csv``, the signed order in each held-out flock.
    """

    trainings: tuple[TrainingResult, ...]
    curves: "pd.DataFrame"
    evaluation: "pd.DataFrame"
    folder: Path


def train_seeds(
    settings: TrainingSettings,
    folder: Path,
    count: int,
    *,
    episodes: int = 512,
    command: str = "",
    report: Report = lambda words, done: None,
    trust: bool = False,
) -> SeedsResult:
    """Train with several seeds, and judge the results in held-out flocks; or continue so.

    Parameters
    ----------
    settings
        Of the first training; the others have the seeds after its own.
    folder
        Where to write, and where trainings and evaluations that are there already are continued.
    count
        Number of trainings.
    episodes
        Held-out flocks for each pool and number of leaders, at the critical noise for 8 minutes
        with the default physics.
    command, trust
        As for `train`.
    report
        Called with what is done now, and the share of all trainings that is done.

    Raises
    ------
    ParameterError
        For a folder with trainings of other settings, numbers that are too small, and as `train`.
    TrainingError
        As `train`.
    MissingExtraError
        Without the extra ``plot``.
    """
    for name, value, least in (("seeds", count, 1), ("episodes", episodes, 2)):
        if value < least:
            raise ParameterError(f"{name} = {value!r} is not accepted: at least {least}")
    require("pandas", "plot")
    require("matplotlib", "plot")
    folder = Path(folder)
    every = [settings.replace(seed=settings.seed + place) for place in range(count)]
    for own in every:
        _is_begun(own, folder / f"seed-{own.seed}")
    trainings = []
    for place, own in enumerate(every):

        def shared(progress: Progress, place: int = place, own: TrainingSettings = own) -> None:
            done = min(1.0, progress.samples / own.total_samples)
            report(f"seed {own.seed}", (place + done) / count)

        trainings.append(_trained(own, folder / f"seed-{own.seed}", command, shared, trust))
    policies: dict[str, Callable[[str], Any]] = {
        f"seed {each.settings.seed}": lambda pool, policy=each.policy: policy  # type: ignore[misc]
        for each in trainings
    }
    policies |= {name: lambda pool, name=name: named_policy(name, pool)() for name in RIVALS}  # type: ignore[misc]
    report("validations of the laws", 1.0)
    curves = _curves(settings, trainings, policies)
    write_csv(folder / "learning_curves.csv", curves, float_format="%.6g")
    _draw(curves, folder / "learning_curves.png")
    orders = _orders(settings, policies, folder / "episodes.csv", episodes, report)
    evaluation = _evaluation(orders, [name for name in policies if name not in RIVALS])
    write_csv(folder / "evaluation.csv", evaluation, float_format="%.5g")
    return SeedsResult(tuple(trainings), curves, evaluation, folder)


def _trained(
    settings: TrainingSettings,
    folder: Path,
    command: str,
    report: Callable[[Progress], None],
    trust: bool,
) -> TrainingResult:
    if not _is_begun(settings, folder):
        return train(settings, folder, command=command, report=report, trust=trust)
    return resume(folder, samples=settings.samples, flock_hours=settings.flock_hours, report=report)


def _is_begun(settings: TrainingSettings, folder: Path) -> bool:
    """Return whether a folder holds a run of these settings, and refuse those of others."""
    if not (folder / "checkpoint.npz").exists():
        return False
    if stored_settings(folder, settings.samples, settings.flock_hours) != settings:
        raise ParameterError(f"{folder} holds a run of other settings: name another folder")
    return True


def _curves(
    settings: TrainingSettings,
    trainings: list[TrainingResult],
    policies: Mapping[str, Callable[[str], Any]],
) -> "pd.DataFrame":
    """Return mean orders by policy and flock-hours; the rivals' have no hours."""
    rows: list[dict[str, Any]] = []
    for each in trainings:
        labels = {"policy": f"seed {each.settings.seed}", "flocks": _TRAINING}
        for row in with_flock_hours(each.progress.curve, each.settings):
            hours = {name: row[name] for name in ("samples", "flock_hours")}
            rows.append({**labels, **hours, "mean": row["signed_order"]})
        labels["flocks"] = _VALIDATION
        found = with_flock_hours(each.progress.validations, each.settings)
        rows += [{**labels, **row} for row in found]
    for name in RIVALS:
        scores = {
            case: float(orders.mean())
            for case, orders in validation_episodes(policies[name], settings).items()
        }
        mean = float(np.mean(list(scores.values())))
        rows.append({"policy": name, "flocks": _VALIDATION, "mean": mean, **scores})
    curves: pd.DataFrame = require("pandas", "plot").DataFrame(rows)
    return curves


def _draw(curves: "pd.DataFrame", path: Path) -> None:
    """Draw the orders of each seed against flock-hours, and the rivals as lines."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 3.6), layout="constrained")
    axes = figure.subplots()
    for name, rows in curves.groupby("policy", sort=False):
        if name in RIVALS:
            style = ("--", "-", ":")[RIVALS.index(str(name))]
            axes.axhline(rows["mean"].iloc[0], ls=style, lw=1, color="0.4", label=str(name))
        else:
            exploring, validated = (rows[rows["flocks"] == kind] for kind in _KINDS)
            smooth = exploring["mean"].rolling(_SMOOTHED, min_periods=1).mean()
            (line,) = axes.plot(exploring["flock_hours"], smooth, lw=1.2, label=str(name))
            axes.plot(validated["flock_hours"], validated["mean"], "o", color=line.get_color())
    axes.set_xlabel("simulated time of all flocks (hours)")
    axes.set_ylabel("mean signed order")
    figure.legend(frameon=False, fontsize=8, loc="outside right upper")
    axes.spines[["top", "right"]].set_visible(False)
    with atomic_write(path) as file:
        figure.savefig(file, dpi=200, format="png")


def _orders(
    settings: TrainingSettings,
    policies: Mapping[str, Callable[[str], Any]],
    path: Path,
    episodes: int,
    report: Report,
) -> "pd.DataFrame":
    """Return the signed order of each policy in each held-out flock; stored ones are not run."""
    pandas = require("pandas", "plot")
    seeds = POLICY_SEEDS["evaluation"].seeds(episodes)
    left_out = (*settings.decisions, "decision_period_cycles", "physics")
    options = {name: each for name, each in settings.options.items() if name not in left_out}
    options["control_hz"] = settings.validation_hz
    stored: dict[Any, pd.DataFrame] = {}
    if path.exists():
        earlier = pandas.read_csv(path, dtype=str).astype({"seed": int, "signed_order": float})
        stored = dict(list(earlier.groupby(["policy", "digest", "case"])))
    parts: list[pd.DataFrame] = []
    for name, policy_of in policies.items():
        for case, parameters in validation_flocks(settings):
            policy = policy_of(str(parameters.pool))
            digest = getattr(policy, "digest", repr(policy))
            part = stored.get((name, digest, case))
            if part is None or list(part["seed"]) != list(seeds):
                report(f"{name} in {case}", 1.0)
                found = run_episodes(parameters, policy, seeds, _EPISODE_S, options=options)
                labels = {"policy": name, "digest": digest, "case": case, "seed": seeds}
                part = pandas.DataFrame({**labels, "signed_order": found["signed_order"]})
                stored[name, digest, case] = part
                write_csv(path, pandas.concat(stored.values()))
            parts.append(part)
    every: pd.DataFrame = pandas.concat(parts)
    write_csv(path, every)
    return every


def _evaluation(orders: "pd.DataFrame", trained: list[str]) -> "pd.DataFrame":
    """Return means and paired differences with their intervals, by case and policy."""
    rows = []
    for case, part in orders.groupby("case", sort=False):
        table = part.pivot_table(index="policy", columns="seed", values="signed_order")
        of_policy = {str(name): table.loc[name].to_numpy() for name in table.index}
        every = np.stack([of_policy[name] for name in trained])
        for rival in ("", *RIVALS):
            other = of_policy[rival] if rival else np.zeros(every.shape[1])
            found = {EVERY_SEED: interval(crossed_replicates(every - other))}
            names = (*trained, *(() if rival else RIVALS))
            found |= {name: mean_interval(of_policy[name] - other) for name in names}
            for name, ends in found.items():
                row = {"case": case, "policy": name, "minus": rival}
                rows.append(row | dict(zip(("signed_order", "low", "high"), ends, strict=True)))
    evaluation: pd.DataFrame = require("pandas", "plot").DataFrame(rows)
    return evaluation
