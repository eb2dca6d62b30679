"""`flockenv analyze`: recordings and tracks of others, summarized, drawn and written out."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flockenv._core import pool_radii_cm
from flockenv._io.atomic_write import atomic_write
from flockenv._io.extras import require
from flockenv.cli.console import echo, print_json
from flockenv.cli.options import Overwriting, Printing, argument, option, takes
from flockenv.cli.output import in_words, load_recording, prepare, printable, summary_of
from flockenv.recording import Recording
from flockenv.rendering.palette import PALETTE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def _picture_endings() -> list[str]:
    """Return the endings of files that Matplotlib writes."""
    kinds = require("matplotlib.backend_bases", "plot").FigureCanvasBase.filetypes
    return [f".{kind}" for kind in kinds]


def _output_endings() -> tuple[str, ...]:
    """Return the endings of the files that `--out` writes."""
    from flockenv.tracks import EXPORTS

    return (".npz", *EXPORTS)


@dataclass(frozen=True, kw_only=True)
class AnalyzeOptions(Overwriting, Printing):
    """Options of `flockenv analyze`."""

    file: Path = argument("Tracks (.csv, .tsv, .txt, .parquet) or a recording (.npz).")
    layout: Path | None = option(
        None, "TOML file with the columns and units of tracks. [beside the file]"
    )
    plot: Path | None = option(
        None, "Picture of the first frame and of the order against time.", endings=_picture_endings
    )
    out: Path | None = option(
        None, "Write a recording (.npz), a table (.csv, .parquet) or .gsd.", endings=_output_endings
    )


@takes(AnalyzeOptions)
def analyze(options: AnalyzeOptions) -> None:
    """Print the order parameters of a recording, or of tracked robots or animals.

    Prints the means over the analysis window after the first tenth, as `flockenv run` does. If the
    phases of the motors are unknown, all later samples count. A report says which rows of the
    tracks were left out; with `--json` the key "tracks" holds it. If a table has no description,
    the command guesses one, writes it beside the table and names the lines to check. Compare the
    first frame (`--plot` draws it) with the video: no number shows that an experiment is mirrored.
    `--out` also writes tables with their layout, or GSD for OVITO and freud.

    Example: `flockenv analyze tracks.csv --plot order.png --out run.gsd`
    """
    from flockenv.tracks import TrackReport, export

    out, plot = options.out, options.plot
    is_table = out is not None and out.suffix.lower() not in (".npz", ".gsd")
    layout = out.with_suffix(".toml") if out is not None and is_table else None
    outputs = [path for path in (plot, out, layout) if path is not None]
    track_reports: list[TrackReport] = []
    recording = load_recording(
        options.file, options.layout, quiet=options.quiet, report=track_reports.append
    )
    prepare(*outputs, overwrites=options.force)
    if plot is not None:
        with atomic_write(plot) as file:
            _figure(recording).savefig(file, format=plot.suffix.removeprefix("."))
    if out is not None and out.suffix.lower() == ".npz":
        recording.save(out)
    elif out is not None:
        export(recording, out, overwrite=options.force)
    if options.as_json:
        files = [printable(path) for path in outputs]
        tracks = {"tracks": track_reports[0].named()} if track_reports else {}
        print_json({**summary_of(recording), **tracks, "files": files})
        return
    boats = recording.parameters.n_boats
    echo(f"{boats} boats, {printable(options.file)}: {in_words(recording)}")
    if not options.quiet and len(recording) > 0 and (recording.phase == "").all():
        echo("The motors' phases are unknown: all samples after the first tenth count.")
    if outputs:
        echo(f"Written to {' and '.join(map(printable, outputs))}")


def _figure(recording: Recording) -> "Figure":
    """Draw the first frame that has a boat, and beside it the order against time."""
    pyplot = require("matplotlib.pyplot", "plot")
    figure: Figure
    figure, axes = pyplot.subplots(1, 2, figsize=(13, 6), layout="constrained")
    recording.order.plot(target=recording.parameters.target, ax=axes[1])
    if recording.has_poses and len(recording) > 0:
        _draw_frame(recording, axes[0])
    return figure


def _draw_frame(recording: Recording, axes: "Axes") -> None:
    """Draw the first frame that has a boat, with names, for a comparison with the video."""
    parameters, present = recording.parameters, ~np.isnan(recording.pose[..., 0])
    first_frame = int(present.any(axis=1).argmax())
    boats = np.flatnonzero(present[first_frame])
    x, y, heading = recording.pose[first_frame, boats].T
    length = 2.0 * (1.0 + parameters.boat_shape) * parameters.boat_radius_cm
    arrows = length * np.cos(heading), length * np.sin(heading)
    colors = np.where(boats < parameters.n_leaders, PALETTE["leader"], PALETTE["normal"])
    style: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "pivot": "mid"}
    axes.quiver(x, y, *arrows, color=colors, width=0.008, **style)
    names = recording.ids if recording.ids is not None else np.arange(parameters.n_boats)
    for boat, position in zip(boats, zip(x, y, strict=True), strict=True):
        axes.annotate(str(names[boat]), position, (5, 5), textcoords="offset points", fontsize=8)
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    # In open water the outer radius is infinite. Without an island the inner radius is 0.
    for radius in pool_radii_cm(parameters.pool):
        if 0.0 < radius < np.inf:
            axes.plot(radius * np.cos(angle), radius * np.sin(angle), color="0.5")
    axes.set(aspect="equal", xlabel="x [cm]", ylabel="y [cm], up")
    axes.set_title(f"{recording.time_s[first_frame]:g} s: do boats lie and point as in the video?")
