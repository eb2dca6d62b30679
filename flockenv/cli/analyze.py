"""`flockenv analyze`: recordings and data of others, summarized, drawn and written out."""

from dataclasses import dataclass
from pathlib import Path

from flockenv._io.atomic_write import atomic_write
from flockenv.cli.console import print_json, say
from flockenv.cli.options import Overwriting, Printing, argument, option, takes
from flockenv.cli.output import in_words, load_recording, prepare, printable, summary_of
from flockenv.errors import ParameterError


@dataclass(frozen=True, kw_only=True)
class AnalyzeOptions(Overwriting, Printing):
    """Options of `flockenv analyze`."""

    file: Path = argument("Tracks (.csv, .parquet) or a recording (.npz).")
    layout: Path | None = option(None, "Columns and units of tracks: TOML. [beside the file]")
    plot: Path | None = option(None, "Draw order parameters against time into this picture.")
    out: Path | None = option(
        None, "Write it: a recording (.npz), tables (.csv, .parquet) or .gsd."
    )


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
    from flockenv.tracks import EXPORTS, export

    out, plot, endings = options.out, options.plot, (".npz", *EXPORTS)
    if out is not None and out.suffix.lower() not in endings:
        raise ParameterError(
            f"--out {out} is not accepted: a name that ends in {', '.join(endings)}"
        )
    is_table = out is not None and out.suffix.lower() not in (".npz", ".gsd")
    beside = out.with_suffix(".toml") if out is not None and is_table else None
    written = [path for path in (plot, out, beside) if path is not None]
    recording = load_recording(options.file, options.layout, quiet=options.quiet)
    prepare(*written, overwrites=options.force)
    if plot is not None:
        figure = recording.order.plot(target=recording.parameters.target).get_figure(root=True)
        assert figure is not None
        with atomic_write(plot) as file:
            figure.savefig(file, format=plot.suffix.removeprefix("."))
    if out is not None and out.suffix.lower() == ".npz":
        recording.save(out)
    elif out is not None:
        export(recording, out)
    if options.as_json:
        files = [printable(path) for path in written]
        print_json({**summary_of(recording), "files": files})
        return
    boats = recording.parameters.n_boats
    say(f"{boats} boats, {printable(options.file)}: {in_words(recording)}")
    if written:
        say(f"Written to {' and '.join(map(printable, written))}")
