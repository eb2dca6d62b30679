"""`flockenv run`."""

import re
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path
from typing import Any

from flockenv._io.atomic_write import write_text
from flockenv.cli.console import echo, print_json
from flockenv.cli.options import TRUST, Overwriting, Printing, option, takes
from flockenv.cli.output import in_words, prepare, printable, summary_of
from flockenv.cli.parameters import OneFlock, changed_fields
from flockenv.cli.progress import progress
from flockenv.errors import ParameterError, short_repr
from flockenv.parameters import FlockParameters
from flockenv.policies.names import EVERY_SUBSTEP
from flockenv.policies.registry import NAMES, policy, quoted
from flockenv.simulation import simulate

_OUT = Path("results/run.npz")

_RUN_HEADER = re.compile(rb"# flockenv \S+: seed \d+, policy ")
"""The start of the file of parameters that a run writes beside its recording."""


@dataclass(frozen=True, kw_only=True)
class RunOptions(OneFlock, Overwriting, Printing):
    """Options of `flockenv run`."""

    policy: str = option(
        EVERY_SUBSTEP,
        "How leaders steer: by the paper's law at every substep, or at 10 Hz by a policy's file, "
        "an SB3 model's .zip file or module:attribute (with --trust), or one of: "
        f"{quoted(NAMES)}.",
    )
    trust: bool = option(False, TRUST, "--trust")
    seed: int = option(0, "Seed of placement and noise.", min=0)
    minutes: float = option(8.0, "Length of the run.", min=0.0)
    hz: float = option(10.0, "Samples per second.")
    at: list[str] | None = option(
        None,
        "Another value from this time in s on, as in 60:bw_s=0.6; repeatable.",
        "--at",
        metavar="TIME:FIELD=VALUE",
    )
    contacts: bool = option(True, "Record contact forces too.", "--contacts/--no-contacts")
    out: Path | None = option(
        None,
        "The recording. [results/run.npz, numbered if that exists]",
        endings=lambda: (".npz",),
    )


@takes(RunOptions)
def run(options: RunOptions) -> None:
    """Run one flock and record it.

    Writes the recording, and beside it the exact parameters as TOML, for `--params`.
    `flockenv replay` shows it.

    Example: `flockenv run --n-boats 27 --n-leaders 3 --bw-s 0.3 --seed 7`
    """
    if options.minutes == 0.0:
        raise ParameterError("--minutes 0 is not accepted: more than 0, as in --minutes 0.1")
    parameters = options.parameters()
    leaders = policy(options.policy, parameters.pool, trust=options.trust)
    schedule = _schedule(options.at or (), parameters)
    out = options.out or _free_path(_OUT)
    parameter_file = out.with_suffix(".toml")
    _check_no_other_file(parameter_file)
    prepare(out, parameter_file, overwrites=options.force)
    duration_s = 60 * options.minutes
    with progress("simulating", duration_s, options.hides_progress) as advance:
        recording = simulate(
            parameters,
            options.seed,
            duration_s,
            options.hz,
            leaders,
            contacts=options.contacts,
            progress=advance,
            schedule=schedule,
        )
    recording.save(out)
    policy_name = printable(options.policy)
    header = f"# flockenv {recording.version}: seed {options.seed}, policy {policy_name}, "
    write_text(parameter_file, f"{header}{options.minutes:g} min\n{parameters.to_toml()}")
    if options.as_json:
        files = {"recording": str(out), "parameters": str(parameter_file)}
        conditions = {"seed": options.seed, "policy": options.policy}
        print_json({**files, **conditions, **summary_of(recording)})
        return
    echo(f"{parameters.n_boats} boats, seed {options.seed}: {in_words(recording)}")
    echo(f"Written to {out} and {parameter_file}")
    echo(f"See it: {shlex.join(['flockenv', 'replay', str(out)])}")


def _check_no_other_file(parameter_file: Path) -> None:
    """Refuse to replace a TOML file that no run wrote, such as a sweep's, even with --force."""
    if parameter_file.is_file() and not _RUN_HEADER.match(parameter_file.read_bytes()):
        raise ParameterError(
            f"{parameter_file} already exists, and no run wrote it: --out needs another name, "
            "since the parameters are written beside the recording"
        )


def _schedule(
    texts: Sequence[str], parameters: FlockParameters
) -> list[tuple[float, dict[str, Any]]]:
    """Return the times and changes that texts ``TIME:FIELD=VALUE`` name.

    Refuses values of the wrong type; `simulate` checks whether the others are in their range.
    """
    changes = []
    for text in texts:
        time_s, colon, change = text.partition(":")
        try:
            if not colon:
                raise ValueError("no time")
            changes.append((float(time_s), changed_fields([change], "--at")))
        except ValueError as error:
            accepted = "TIME:FIELD=VALUE, as in 60:bw_s=0.6"
            raise ParameterError(f"--at {short_repr(text)} is not accepted: {accepted}") from error
        try:
            parameters.replace(**changes[-1][1])
        except TypeError as error:
            raise ParameterError(f"--at {short_repr(text)} is not accepted: {error}") from error
        except ParameterError:  # An earlier change may make it acceptable.
            pass
    return changes


def _free_path(path: Path) -> Path:
    """Return the path; if a run has it, the path with the first free number from 2 on."""
    numbered = (path.with_stem(f"{path.stem}-{number}") for number in count(2))
    paths = chain([path], numbered)
    return next(p for p in paths if not (p.exists() or p.with_suffix(".toml").exists()))
