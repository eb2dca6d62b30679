"""`flockenv replay`: recordings as a page that plays them, or as a moving picture."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from numpy.typing import NDArray

from flockenv.cli.console import interruptible, print_json, progress_bar, say
from flockenv.cli.options import Printing, takes
from flockenv.cli.output import check_file, load_recording, open_page, printable, writable
from flockenv.errors import ParameterError

if TYPE_CHECKING:
    from flockenv.recording import Recording

__all__ = ["replay"]

_FPS = 12.5
_VIDEO_FPS = 25.0


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
    write a moving picture instead (extra `render`).

    Example: `flockenv replay law.npz learned.npz --html law_and_learned.html`
    """
    if options.gif is not None or options.mp4 is not None:
        _pictures(options)
    else:
        _page(options)


def _page(options: ReplayOptions) -> None:
    # The page's code is not needed by any other command.
    from flockenv.replay import write_replay

    paths = [options.first] if options.second is None else [options.first, options.second]
    titles = _titles(paths, options.name or [])
    page = options.first.with_suffix(".html") if options.html is None else options.html
    _check(page, "--html", (".html", ".htm"))
    with interruptible("Nothing was written."), progress_bar(options.shows_nothing) as progress:
        task = progress.add_task("writing the page", total=len(paths) + 1)
        recordings = {}
        for title, path in zip(titles, paths, strict=True):
            recordings[title] = load_recording(path, quiet=options.shows_nothing)
            progress.advance(task)
        with writable(page):
            written = write_replay(page, recordings)
        progress.advance(task)
    if options.as_json:
        print_json({"html": str(page), "bytes": written.size, "every": written.every})
    else:
        thinned = "" if written.every == 1 else f", every {written.every}th sample"
        say(f"Written to {page} ({written.size / 1e6:.1f} MB{thinned})")
    if options.show:
        open_page(page)


def _pictures(options: ReplayOptions) -> None:
    """Write the first recording as a GIF, a video, or both."""
    from flockenv.rendering import save_animation

    if options.second is not None or options.html is not None:
        raise ParameterError("--gif and --mp4 show one recording, and are written without --html")
    kinds = ((options.gif, "--gif", ".gif", _FPS), (options.mp4, "--mp4", ".mp4", _VIDEO_FPS))
    wanted = [(path, option, end, fps) for path, option, end, fps in kinds if path is not None]
    for path, option, end, _ in wanted:
        _check(path, option, (end,))
    recording = load_recording(options.first, quiet=options.shows_nothing)
    with interruptible("Nothing was written."), progress_bar(options.shows_nothing) as progress:
        times = {fps: _times(recording, options, fps) for *_, fps in wanted}
        task = progress.add_task("drawing", total=sum(len(each) for each in times.values()))
        for path, _, _, fps in wanted:
            frames = _frames(recording, times[fps], lambda: progress.advance(task))
            with writable(path):
                save_animation(path, frames, fps)
    files = [printable(path) for path, *_ in wanted]
    if options.as_json:
        print_json({"files": files})
    else:
        say(f"Written to {' and '.join(files)}")


def _times(recording: "Recording", options: ReplayOptions, fps: float) -> NDArray[np.float64]:
    """Return the times of the frames, from the start of the recording."""
    lasting = min(options.seconds, recording.duration_s / options.speed)
    steps = np.arange(max(1, round(lasting * fps))) * options.speed / fps
    times: NDArray[np.float64] = recording.time_s[0] + np.minimum(steps, recording.duration_s)
    return times


def _frames(
    recording: "Recording", times: NDArray[np.float64], drawn: Callable[[], None]
) -> Iterator[NDArray[np.uint8]]:
    from flockenv.rendering import frame

    for time_s in times.tolist():
        yield frame(recording, time_s)
        drawn()


def _check(path: Path, option: str, endings: tuple[str, ...]) -> None:
    if path.suffix.lower() not in endings:
        raise ParameterError(f"{option} {path} is not accepted: a name that ends in {endings[0]}")
    check_file(path, option)


def _titles(paths: list[Path], names: list[str]) -> list[str]:
    if names and len(names) != len(paths):
        raise ParameterError(f"--name was given {len(names)} times for {len(paths)} recordings")
    titles = [printable(name) for name in names or [path.stem for path in paths]]
    if len(set(titles)) < len(titles) and len(set(paths)) == len(paths) and not names:
        return [printable(path) for path in paths]
    # The same file or name twice is shown twice.
    return [f"{t} ({k + 1})" if titles.count(t) > 1 else t for k, t in enumerate(titles)]
