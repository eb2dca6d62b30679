"""`flockenv analyze`: recordings and data of others, summarized, drawn and written out."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from flockenv.cli.console import print_json, say
from flockenv.cli.options import Overwriting, Printing, takes
from flockenv.cli.output import (
    check_file,
    load_recording,
    printable,
    refuse_overwriting,
    refuse_present,
    writable,
)
from flockenv.cli.run import in_words, summary_of
from flockenv.errors import ParameterError
from flockenv.recording import Recording

__all__ = ["analyze"]

_RECORDING = ".npz"
_GSD = ".gsd"


@dataclass(frozen=True, kw_only=True)
class AnalyzeOptions(Overwriting, Printing):
    """Options of `flockenv analyze`."""

    file: Annotated[
        Path, typer.Argument(help="Tracks (.csv, .parquet, .npz) or a recording (.npz).")
    ]
    layout: Annotated[
        Path | None,
        typer.Option("--layout", help="Columns and units of tracks: TOML. [beside the file]"),
    ] = None
    plot: Annotated[
        Path | None, typer.Option(help="Draw order parameters against time into this picture.")
    ] = None
    out: Annotated[
        Path | None,
        typer.Option(help="Write it: a recording (.npz), tables (.csv, .parquet) or .gsd."),
    ] = None


@takes(AnalyzeOptions)
def analyze(options: AnalyzeOptions) -> None:
    """Print the order parameters of a recording, or of tracked robots or animals.

    The means are those that `flockenv run` prints: over the analysis window after the first tenth,
    or over all samples after it where the phases of motors are not known. What of the tracks was
    left out is reported. A table without a description gets a guessed one beside it, and the lines
    to check are named. `--out` writes the poses for other programs too: tables with their layout
    beside them, or GSD for OVITO and freud.

    Example: `flockenv analyze tracks.csv --plot order.png --out run.gsd`
    """
    out = options.out
    _check_ending(out)
    written = [path for path in (options.plot, out, _beside(out)) if path is not None]
    for path in written:
        check_file(path)
    refuse_overwriting(options.file, "FILE", written)
    refuse_present(written, options.force)
    recording = load_recording(options.file, options.layout, quiet=options.quiet)
    if options.plot is not None:
        _draw(recording, options.plot)
    if out is not None:
        _write(recording, out)
    summary = summary_of(recording)
    if options.as_json:
        print_json({**summary, "files": [printable(path) for path in written]})
        return
    boats = recording.parameters.n_boats
    say(f"{boats} boats, {printable(options.file)}: {in_words(summary, recording)}")
    if written:
        say(f"Written to {' and '.join(map(printable, written))}")


def _check_ending(out: Path | None) -> None:
    from flockenv.tracks import EXPORTS

    endings = (_RECORDING, *EXPORTS)
    if out is not None and out.suffix.lower() not in endings:
        raise ParameterError(
            f"--out {out} is not accepted: a name that ends in {', '.join(endings)}"
        )


def _beside(out: Path | None) -> Path | None:
    """Return the layout that is written beside a table."""
    if out is None or out.suffix.lower() in (_RECORDING, _GSD):
        return None
    return out.with_suffix(".toml")


def _draw(recording: Recording, path: Path) -> None:
    axes = recording.order.plot(target=recording.parameters.target)
    figure = axes.get_figure(root=True)
    assert figure is not None
    with writable(path):
        figure.savefig(path)


def _write(recording: Recording, out: Path) -> None:
    from flockenv.tracks import export

    with writable(out):
        if out.suffix.lower() == _RECORDING:
            recording.save(out)
        else:
            export(recording, out)
