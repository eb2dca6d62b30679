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

#: Shortest time in s between two lines of progress.
_BETWEEN_LINES_S = 3.0


def train_branches(
    user_settings: dict[str, Any], out: Path, flocks: int, printing: Printing, *, resume: bool
) -> None:
    """Train, write the policy with its curve, and compare it with the laws in this many flocks."""
    start, command = time.process_time(), _command(user_settings)
    if resume:
        echo(f"Resuming from {out / CHECKPOINT}", errors)
        training = stored_training(out, user_settings.get("flock_hours"))
    else:
        training = _training(user_settings)
        if (out / CHECKPOINT).exists():
            raise ParameterError(f"{out} holds a run already: resume it, or name another folder")
    try:
        policy = train(training, out, command, _lines(printing.hides_progress))
    except KeyboardInterrupt:
        raise KeyboardInterrupt(checkpoint_note(out)) from None
    measurements = compare_with_laws(policy, training.parameters, flocks)
    orders = {name: columns["signed_order"] for name, columns in measurements.items()}
    _write(out, training, orders)
    gain, gain_error = _mean_and_error(orders[TRAINED] - orders[TUNED_LAW])
    if printing.as_json:
        means = {name: _mean_and_error(values)[0] for name, values in orders.items()}
        print_json({"signed_order": means, "gain": [gain, gain_error], "policy": str(out / POLICY)})
        return
    for name, values in orders.items():
        mean, error = _mean_and_error(values)
        echo(f"{name}: signed order {mean:.3f} ± {error:.3f} in {len(values)} fresh flocks")
    echo(f"{TRAINED} minus {TUNED_LAW}: {gain:+.3f} ± {gain_error:.3f} (standard errors)")
    notes = overlap_note(*training.overlaps, "branches of the training")
    for line in notes + overlap_note(*_overlaps(measurements), "episodes"):
        echo(line)
    echo(f"Written to {out}, with {time.process_time() - start:.0f} s of processor time")


def _training(user_settings: dict[str, Any]) -> BranchTraining:
    """Return a new training with the user's settings."""
    if "ppo" in user_settings:
        raise ParameterError("--ppo is for --algorithm ppo")
    changes = dict(user_settings.get("environment", {}))
    names = [parameter.name for parameter in fields(FlockParameters)]
    refuse_unknown(changes, [*OPTIONS, *names], "option of the training")
    options = {name: changes.pop(name) for name in OPTIONS if name in changes}

    def chosen(*names: str) -> dict[str, Any]:
        return {name: user_settings[name] for name in names if name in user_settings}

    try:
        flocks = training_flocks(**chosen("pool", "n_leaders"), **changes)
        return BranchTraining(flocks, **options, **chosen("flock_hours", "seed"))
    except TypeError as error:
        raise ParameterError(str(error)) from error


def _lines(is_quiet: bool) -> Callable[[Progress], None]:
    """Return a function that prints progress every few seconds, or nothing if `is_quiet`."""
    last_line_s = 0.0

    def report(state: Progress) -> None:
        nonlocal last_line_s
        if not is_quiet and time.monotonic() - last_line_s > _BETWEEN_LINES_S:
            last_line_s = time.monotonic()
            done = f"{state.flock_hours:.0f} of {state.total:.0f} flock-hours"
            echo(f"{done}: signed order {state.signed_order:.3f} while leaders try", errors)

    return report


def _mean_and_error(values: NDArray[np.float64]) -> tuple[float, float]:
    """Return a mean and its standard error."""
    return float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))


def _overlaps(measurements: Mapping[str, Mapping[str, Any]]) -> tuple[int, int, float]:
    """Return the number of episodes, the number with overlaps, and the deepest overlap in cm.

    Only overlaps beyond the tolerance count.
    """
    unsolved, worst_cm = (
        np.concatenate([columns[name] for columns in measurements.values()])
        for name in ("unsolved", "worst_overlap_cm")
    )
    has_overlaps = unsolved > 0
    deepest_cm = float(worst_cm[has_overlaps].max(initial=0.0))
    return len(has_overlaps), int(has_overlaps.sum()), deepest_cm


def _write(out: Path, training: BranchTraining, orders: dict[str, Any]) -> None:
    """Write the comparison and, if matplotlib is installed, a picture of the learning curve."""
    rows = ["seed," + ",".join(orders)]
    for seed, row in enumerate(zip(*orders.values(), strict=True)):
        rows.append(f"{seed}," + ",".join(f"{order:.5f}" for order in row))
    write_text(out / "comparison.csv", "\n".join(rows) + "\n")
    if find_spec("matplotlib") is not None:
        from flockenv.training.learning_curve import draw_curve

        laws = {name: float(values.mean()) for name, values in orders.items() if name != TRAINED}
        draw_curve(training.curve, laws, out / "curve.png")


def _command(user_settings: Mapping[str, Any]) -> str:
    """Return the command line that starts a training with these settings."""
    arguments = ["flockenv", "train", "--algorithm", "branches"]
    for name, value in user_settings.items():
        if isinstance(value, dict):
            for option, option_value in value.items():
                # TOML writes booleans in lower case.
                is_bool = isinstance(option_value, bool)
                text = str(option_value).lower() if is_bool else str(option_value)
                arguments += ["--set", f"{option}={text}"]
        else:
            arguments += [option_of(name), str(value)]
    return shlex.join(arguments)
