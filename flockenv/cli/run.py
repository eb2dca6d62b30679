"""`flockenv run`."""

import itertools
import shlex
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from numpy.typing import NDArray

from flockenv.cli.console import errors, interruptible, print_json, progress_bar, say
from flockenv.cli.options import Flocks, Overwriting, Printing, takes
from flockenv.cli.output import check_file, keep, printable, refuse_overwriting, refuse_present
from flockenv.cli.parameters import TrustOption, read_parameters, save_parameters
from flockenv.errors import ParameterError
from flockenv.order import QUANTITIES, Quantity
from flockenv.parameters import FlockParameters
from flockenv.policies.base import LeaderPolicy
from flockenv.policies.registry import EVERY_SUBSTEP, POLICIES, POOL_POLICIES, named_policy, quoted
from flockenv.recording import Recording
from flockenv.simulation import simulate

__all__ = ["DEFAULT_OUT", "in_words", "run", "summary_of"]

DEFAULT_OUT = Path("results/run.npz")


@dataclass(frozen=True, kw_only=True)
class RunOptions(Flocks, Overwriting, Printing):
    """Options of `flockenv run`."""

    policy: Annotated[
        str,
        typer.Option(
            help="How leaders steer. The paper's law at every substep, or at 10 Hz, from what they "
            "observe, a policy's file, an SB3 model's .zip file (with --trust) or one of: "
            f"{quoted([*POLICIES, *POOL_POLICIES])}."
        ),
    ] = EVERY_SUBSTEP
    trust: TrustOption = False
    seed: Annotated[int, typer.Option(min=0, help="Seed of placement and noise.")] = 0
    minutes: Annotated[float, typer.Option(min=0.0, help="Length of the run.")] = 8.0
    hz: Annotated[float, typer.Option(help="Samples per second.")] = 10.0
    threads: Annotated[
        int, typer.Option(min=1, max=1024, help="Threads for 200 boats or more; same result.")
    ] = 1
    contacts: Annotated[
        bool, typer.Option("--contacts/--no-contacts", help="Record contact forces too.")
    ] = True
    out: Annotated[
        Path | None,
        typer.Option(help="The recording. [results/run.npz, numbered where that is taken]"),
    ] = None


@takes(RunOptions)
def run(options: RunOptions) -> None:
    """Run one flock and record it.

    Writes the recording, and beside it the exact parameters as TOML, which `--params` reads.
    `flockenv replay` shows it.

    Example: `flockenv run --set n_boats=27 --set n_leaders=3 --set bw_s=0.3 --seed 7`
    """
    parameters = read_parameters(options.preset, options.params, options.changes)
    out = _checked_out(options)
    policy = _policy(options.policy, parameters, options.trust)
    recording = _recorded(options, parameters, policy)
    written = _kept(options, out, recording)
    if written != out:
        say(f"{out} was written by another command meanwhile.", errors)
    beside, summary = written.with_suffix(".toml"), summary_of(recording)
    if options.as_json:
        files = {"recording": str(written), "parameters": str(beside)}
        print_json({**files, "seed": options.seed, "policy": options.policy, **summary})
        return
    say(f"{parameters.n_boats} boats, seed {options.seed}: {in_words(summary, recording)}")
    say(f"Written to {written} and {beside}")
    say(f"See it: flockenv replay {shlex.quote(str(written))}")


def _checked_out(options: RunOptions) -> Path:
    """Return where the recording goes, if it can be written there."""
    out = options.out
    if out is None:
        numbered = filter(_is_free, _numbered(DEFAULT_OUT))
        out = DEFAULT_OUT if options.force else next(numbered)
    if out.suffix != ".npz":
        raise ParameterError(f"--out {out} is not accepted: a name that ends in .npz")
    written = (out, out.with_suffix(".toml"))
    for path in written:
        check_file(path)
    refuse_overwriting(options.params, "--params", written)
    refuse_overwriting(options.policy, "--policy", (out,))
    refuse_present(written, options.force)
    return out


def _recorded(
    options: RunOptions, parameters: FlockParameters, policy: LeaderPolicy | str
) -> Recording:
    with interruptible("Nothing was written."), progress_bar(options.shows_nothing) as progress:
        task = progress.add_task("simulating", total=options.minutes * 60)
        return simulate(
            parameters,
            options.seed,
            options.minutes * 60,
            options.hz,
            policy,
            contacts=options.contacts,
            threads=options.threads,
            progress=lambda seconds: progress.advance(task, seconds),
        )


def _kept(options: RunOptions, out: Path, recording: Recording) -> Path:
    """Write the recording and its parameters; return where, if the name was taken meanwhile."""
    policy = printable(options.policy)
    remark = f"flockenv {recording.version}: seed {options.seed}, policy {policy}, "
    remark += f"{options.minutes:g} min"
    wanted = (options.out or DEFAULT_OUT).name
    written: list[Path] = []

    def write(path: Path) -> None:
        path = path if options.force else _taken(path.with_name(wanted))
        try:
            recording.save(path)
            save_parameters(path.with_suffix(".toml"), recording.parameters, remark)
        except BaseException:
            if not options.force:
                path.unlink(missing_ok=True)
            raise
        written.append(path)

    keep(out, write)
    return written[-1]


def _numbered(path: Path) -> Iterator[Path]:
    """Yield a path, then the same with numbers from 2 on."""
    yield path
    for number in itertools.count(2):
        yield path.with_stem(f"{path.stem}-{number}")


def _is_free(path: Path) -> bool:
    return not (path.exists() or path.with_suffix(".toml").exists())


def _taken(path: Path) -> Path:
    """Make an empty file at the first free one of the numbered paths, and return that path."""
    while True:
        free = next(filter(_is_free, _numbered(path)))
        with suppress(FileExistsError):
            free.open("xb").close()
            return free


def _policy(name: str, parameters: FlockParameters, trust: bool) -> LeaderPolicy | str:
    try:
        return named_policy(name, parameters.pool, trust=trust)()
    except OSError as error:
        raise ParameterError(f"--policy {name} cannot be read: {error.strerror}") from error


def summary_of(recording: Recording) -> dict[str, float | int | None]:
    """Return means over the samples in the analysis window after the first tenth of the run."""
    used = recording.analyzed()
    target = recording.parameters.target
    means = {
        each.name + _suffix(each.unit): _mean(used.order.series(each.name, target))
        for each in QUANTITIES
        if each.is_averaged
    }
    return {"samples": len(recording), "samples_in_window": len(used), **means}


def _suffix(unit: str) -> str:
    return "_" + unit.replace("/", "_").replace("²", "2") if unit else ""


def _mean(values: NDArray[np.float64]) -> float | None:
    """Return the mean over the samples where there are enough boats; None where there are none."""
    defined = values[np.isfinite(values)]
    return float(defined.mean()) if len(defined) else None


def in_words(summary: dict[str, float | int | None], recording: Recording) -> str:
    """Return what the summary of a recording says, in one line: its quantities without a unit."""
    table = {each.name: each for each in QUANTITIES}
    if recording.parameters.common_target is None:
        del table["signed_order"]
    found = {_word(table[name]): n for name, n in summary.items() if name in table}
    return ", ".join(
        f"{word} {'undefined' if n is None else f'{n:.3f}'}" for word, n in found.items()
    )


def _word(quantity: Quantity) -> str:
    symbol = quantity.symbol
    return f"mean {symbol}" if "_" in symbol else quantity.label.partition(",")[0]
