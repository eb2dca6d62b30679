"""`flockenv analyze` and `flockenv export`: data of others in, recordings out."""

from pathlib import Path
from typing import Annotated

import typer

from flockenv.cli.console import print_json, say
from flockenv.cli.output import (
    check_file,
    load_recording,
    printable,
    refuse_overwriting,
    writable,
)
from flockenv.cli.run import in_words, summary_of
from flockenv.errors import ParameterError

__all__ = ["LayoutOption", "QuietOption", "analyze", "export"]

LayoutOption = Annotated[
    Path | None,
    typer.Option("--layout", help="Columns and units of tracks: TOML. [beside the file]"),
]


QuietOption = Annotated[
    bool, typer.Option("--quiet", "-q", help="Do not print what of tracks was left out.")
]


def analyze(
    file: Annotated[Path, typer.Argument(help="Tracks (.csv, .parquet, .npz) or a recording.")],
    layout: LayoutOption = None,
    plot: Annotated[
        Path | None, typer.Option(help="Draw order parameters against time into this picture.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Write it as a recording, .npz.")] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Overwrite files that are there already.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")] = False,
    quiet: QuietOption = False,
) -> None:
    """Print the order parameters of tracked robots or animals, or of a recording.

    The means are those that `flockenv run` prints: over the analysis window after the first tenth,
    or over all samples after it where the phases of motors are not known. What of the tracks was
    left out is reported. `docs/tracks.md` describes the files.

    Example: `flockenv analyze tracks.csv --plot order.png`
    """
    written = [path for path in (plot, out) if path is not None]
    for path in written:
        check_file(path)
    refuse_overwriting(file, "FILE", written)
    if out is not None and out.suffix != ".npz":
        raise ParameterError(f"--out {out} is not accepted: a name that ends in .npz")
    for path in written:
        if path.exists() and not force:
            raise ParameterError(f"{path} is there already: --force overwrites it")
    recording = load_recording(file, layout, quiet=quiet)
    if plot is not None:
        axes = recording.order.plot(target=recording.parameters.target)
        figure = axes.get_figure(root=True)
        assert figure is not None
        with writable(plot):
            figure.savefig(plot)
    if out is not None:
        with writable(out):
            recording.save(out)
    summary = summary_of(recording)
    if as_json:
        print_json(summary)
        return
    say(f"{recording.parameters.n_boats} boats, {printable(file)}: {in_words(summary, recording)}")
    if written:
        say(f"Written to {' and '.join(map(printable, written))}")


def export(
    file: Annotated[Path, typer.Argument(help="A recording (.npz), or tracks.")],
    out: Annotated[
        Path, typer.Option(help="The file to write: it ends in .csv, .parquet or .gsd.")
    ],
    layout: LayoutOption = None,
    force: Annotated[
        bool, typer.Option("--force", help="Overwrite files that are there already.")
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print what was written as JSON.")
    ] = False,
    quiet: QuietOption = False,
) -> None:
    """Write the poses of a recording for other programs: tables, or GSD for OVITO and freud.

    Example: `flockenv export results/run.npz --out run.gsd`
    """
    from flockenv.tracks import EXPORTS
    from flockenv.tracks import export as write

    if out.suffix.lower() not in EXPORTS:
        endings = ", ".join(EXPORTS)
        raise ParameterError(f"--out {out} is not accepted: a name that ends in {endings}")
    beside = out.with_suffix(".toml")
    check_file(out)
    refuse_overwriting(file, "FILE", [out, beside])
    recording = load_recording(file, layout, quiet=quiet)
    if not force and out.exists():
        raise ParameterError(f"{out} is there already: --force overwrites it")
    if not force and out.suffix.lower() != ".gsd" and beside.exists():
        other = out.with_stem(f"{out.stem}-tracks")
        raise ParameterError(
            f"{beside} is there already, and the layout of the table goes there: name another "
            f"--out, such as {other}, or overwrite it with --force"
        )
    with writable(out):
        written = write(recording, out)
    if as_json:
        print_json({"files": [printable(path) for path in written]})
        return
    say(f"Written to {' and '.join(map(printable, written))}")
