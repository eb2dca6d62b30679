"""`flockenv replay`: recordings as a page that plays them, or as a moving picture."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from numpy.typing import NDArray

from flockenv.cli.console import print_json, progress, say
from flockenv.cli.options import Printing, takes
from flockenv.cli.output import load_recording, open_page, prepare, printable
from flockenv.errors import ParameterError

if TYPE_CHECKING:
    from flockenv.recording import Recording

__all__ = ["replay"]

_FPS = {".gif": 12.5, ".mp4": 25.0}


@dataclass(frozen=True, kw_only=True)
class ReplayOptions(Printing):
    """Options of `flockenv replay`."""

    first: Annotated[
        Path, typer.Argument(metavar="RUN", help="A recording (.npz), or tracks (.csv, .parquet).")
    ]
    second: Annotated[
        Path | None, typer.Argument(metavar="OTHER", help="Another one to play beside it.")
    ] = None
    html: Annotated[
        Path | None, typer.Option("--html", help="The page. [the first recording's name]")
    ] = None
    gif: Annotated[
        Path | None, typer.Option("--gif", help="A moving picture of the first, in its place.")
    ] = None
    mp4: Annotated[
        Path | None, typer.Option("--mp4", help="A video of the first, in its place.")
    ] = None
    speed: Annotated[
        float, typer.Option(min=0.1, max=100.0, help="Of pictures: how many times real time.")
    ] = 8.0
    seconds: Annotated[
        float, typer.Option(min=0.1, help="Of pictures: how long they last at most.")
    ] = 20.0
    name: Annotated[
        list[str] | None,
        typer.Option("--name", help="What a recording is called on the page; once for each."),
    ] = None
    show: Annotated[bool, typer.Option("--open", help="Open the page in a browser.")] = False


@takes(ReplayOptions)
def replay(options: ReplayOptions) -> None:
    """Write recordings as one page that plays them: in any browser, without a network.

    Tracks of real flocks are described by a TOML file beside them, see `docs/tracks.md`.
    Play, scrub, change the speed; trails, contact forces, a boat's numbers under the pointer, and
    order parameters in step with the picture. Two recordings play side by side. `--gif` and `--mp4`
    write a moving picture instead (extras `render`, `video`).

    Example: `flockenv replay law.npz learned.npz --html law_and_learned.html`
    """
    for path, end in ((options.html, ".html"), (options.gif, ".gif"), (options.mp4, ".mp4")):
        if path is not None and path.suffix.lower() != end:
            raise ParameterError(f"--{end[1:]} {path} is not accepted: a name that ends in {end}")
    pictures = [path for path in (options.gif, options.mp4) if path is not None]
    if not pictures:
        _page(options)
    elif options.second is not None or options.html is not None:
        raise ParameterError("--gif and --mp4 show one recording, and are written without --html")
    else:
        _pictures(options, pictures)


def _page(options: ReplayOptions) -> None:
    # The page's code is not needed by any other command.
    from flockenv.replay import write_replay

    paths = [path for path in (options.first, options.second) if path is not None]
    names = options.name or [path.stem for path in paths]
    if len(names) != len(paths):
        raise ParameterError(f"--name was given {len(names)} times for {len(paths)} recordings")
    if len(set(names)) < len(names):
        names = [f"{name} ({place})" for place, name in enumerate(names, 1)]
    page = options.html or options.first.with_suffix(".html")
    prepare(page)
    recordings = {
        printable(name): load_recording(path, quiet=options.shows_nothing)
        for name, path in zip(names, paths, strict=True)
    }
    written = write_replay(page, recordings)
    if options.as_json:
        print_json({"html": str(page), "bytes": written.size, "every": written.every})
    else:
        thinned = "" if written.every == 1 else f", every {written.every}th sample"
        say(f"Written to {page} ({written.size / 1e6:.1f} MB{thinned})")
    if options.show:
        open_page(page)


def _pictures(options: ReplayOptions, paths: list[Path]) -> None:
    """Write the first recording as a GIF, a video, or both."""
    from flockenv.rendering import save_animation

    prepare(*paths)
    recording = load_recording(options.first, quiet=options.shows_nothing)
    for path in paths:
        fps = _FPS[path.suffix.lower()]
        lasting_s = min(options.seconds, recording.duration_s / options.speed)
        steps_s = np.arange(max(1, round(lasting_s * fps))) * options.speed / fps
        times = recording.time_s[0] + np.minimum(steps_s, recording.duration_s)
        with progress("drawing", len(times), options.shows_nothing) as advance:
            save_animation(path, _frames(recording, times, advance), fps)
    if options.as_json:
        print_json({"files": list(map(printable, paths))})
    else:
        say(f"Written to {' and '.join(map(printable, paths))}")


def _frames(
    recording: "Recording", times: NDArray[np.float64], drawn: Callable[[], None]
) -> Iterator[NDArray[np.uint8]]:
    from flockenv.rendering import frame

    for time_s in times.tolist():
        yield frame(recording, time_s)
        drawn()
