"""`flockenv train --algorithm branches`."""

import shlex
import time
from collections.abc import Callable, Mapping
from dataclasses import fields
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flockenv._io.atomic_write import write_text
from flockenv.cli.console import echo, errors, print_json
from flockenv.cli.options import Printing, option_of
from flockenv.cli.progress import checkpoint_note
from flockenv.comparison.report import overlap_note
from flockenv.errors import ParameterError, refuse_unknown
from flockenv.parameters import FlockParameters
from flockenv.policies.names import TUNED_LAW
from flockenv.training.branches import (
    CHECKPOINT,
    OPTIONS,
    POLICY,
    TRAINED,
    BranchTraining,
    Progress,
    compare_with_laws,
    stored_training,
    train,
    training_flocks,
)

#: Time in s between two lines of progress.
_BETWEEN_LINES_S = 3.0


def train_branches(
    given: dict[str, Any], out: Path, flocks: int, printing: Printing, *, resume: bool
) -> None:
    """Train, write the policy with its curve, and compare it with the laws in this many flocks."""
    start, command = time.process_time(), _command(given)
    if resume:
        echo(f"Resuming from {out / CHECKPOINT}", errors)
        training = stored_training(out, given.get("flock_hours"))
    else:
        training = _training(given)
        if (out / CHECKPOINT).exists():
            raise ParameterError(f"{out} holds a run already: resume it, or name another folder")
    try:
        policy = train(training, out, command, _lines(printing.shows_nothing))
    except KeyboardInterrupt:
        raise KeyboardInterrupt(checkpoint_note(out)) from None
    compared = compare_with_laws(policy, training.parameters, flocks)
    orders = {name: columns["signed_order"] for name, columns in compared.items()}
    _write(out, training, orders)
    gain, error = _mean(orders[TRAINED] - orders[TUNED_LAW])
    if printing.as_json:
        means = {name: _mean(own)[0] for name, own in orders.items()}
        print_json({"signed_order": means, "gain": [gain, error], "policy": str(out / POLICY)})
        return
    for name, of_flocks in orders.items():
        mean, own_error = _mean(of_flocks)
        echo(f"{name}: signed order {mean:.3f} ± {own_error:.3f} in {len(of_flocks)} fresh flocks")
    echo(f"{TRAINED} minus {TUNED_LAW}: {gain:+.3f} ± {error:.3f} (standard errors)")
    lines = overlap_note(*training.overlaps, "branches of the training")
    for line in lines + overlap_note(*_overlaps(compared), "episodes"):
        echo(line)
    echo(f"Written to {out}, with {time.process_time() - start:.0f} s of processor time")


def _training(given: dict[str, Any]) -> BranchTraining:
    """Return the training that the options ask for."""
    if "ppo" in given:
        raise ParameterError("--ppo is for --algorithm ppo")
    changes = dict(given.get("environment", {}))
    names = [parameter.name for parameter in fields(FlockParameters)]
    refuse_unknown(changes, [*OPTIONS, *names], "option of the training")
    own = {name: changes.pop(name) for name in OPTIONS if name in changes}
    own |= {name: given[name] for name in ("flock_hours", "seed") if name in given}
    flock = {name: given[name] for name in ("pool", "n_leaders") if name in given}
    return BranchTraining(training_flocks(**flock, **changes), **own)


def _lines(is_quiet: bool) -> Callable[[Progress], None]:
    """Return a function that prints progress every few seconds, unless it is to be quiet."""
    last = 0.0

    def report(now: Progress) -> None:
        nonlocal last
        if not is_quiet and time.monotonic() - last > _BETWEEN_LINES_S:
            last = time.monotonic()
            done = f"{now.flock_hours:.0f} of {now.total:.0f} flock-hours"
            echo(f"{done}: signed order {now.signed_order:.3f} while leaders try", errors)

    return report


def _mean(values: NDArray[np.float64]) -> tuple[float, float]:
    """Return a mean and its standard error."""
    return float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))


def _overlaps(compared: Mapping[str, Mapping[str, Any]]) -> tuple[int, int, float]:
    """Return the numbers of episodes and of those with overlaps, and the deepest overlap."""
    unsolved, worst_cm = (
        np.concatenate([columns[name] for columns in compared.values()])
        for name in ("unsolved", "worst_overlap_cm")
    )
    deep = unsolved > 0
    return len(deep), int(deep.sum()), float(worst_cm[deep].max(initial=0.0))


def _write(out: Path, training: BranchTraining, orders: dict[str, Any]) -> None:
    """Write the comparison, and the picture of the curve where matplotlib is installed."""
    rows = ["seed," + ",".join(orders)]
    for seed, row in enumerate(zip(*orders.values(), strict=True)):
        rows.append(f"{seed}," + ",".join(f"{order:.5f}" for order in row))
    write_text(out / "comparison.csv", "\n".join(rows) + "\n")
    if find_spec("matplotlib") is not None:
        from flockenv.training.learning_curve import draw_curve

        laws = {name: float(own.mean()) for name, own in orders.items() if name != TRAINED}
        draw_curve(training.curve, laws, out / "curve.png")


def _command(given: Mapping[str, Any]) -> str:
    """Return the command line that repeats this training."""
    words = ["flockenv", "train", "--algorithm", "branches"]
    for name, value in given.items():
        if isinstance(value, dict):
            words += [word for key in value for word in ("--set", f"{key}={value[key]}")]
        else:
            words += [option_of(name), str(value)]
    return shlex.join(words)
