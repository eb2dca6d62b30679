"""`flockenv replay`: recordings as a page that plays them, or as moving pictures."""

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flockenv.cli.console import echo, print_json
from flockenv.cli.options import Printing, argument, option, takes
from flockenv.cli.output import load_recording, open_page, prepare, printable
from flockenv.cli.progress import progress
from flockenv.errors import ParameterError

_FPS = {".gif": 12.5, ".mp4": 25.0}
_PICTURE_OPTIONS = ("colors", "speed", "start", "seconds")


@dataclass(frozen=True, kw_only=True)
class ReplayOptions(Printing):
    """Options of `flockenv replay`."""

    first: Path = argument(
        "A recording (.npz), or tracks (.csv, .tsv, .txt, .parquet).", metavar="RUN"
    )
    second: Path | None = argument("A second one, to play beside it.", None, metavar="OTHER")
    html: Path | None = option(
        None, "The page. [the first recording's name]", endings=lambda: (".html",)
    )
    gif: Path | None = option(
        None, "A moving picture instead of the page.", endings=lambda: (".gif",)
    )
    mp4: Path | None = option(None, "A video instead of the page.", endings=lambda: (".mp4",))
    colors: str = option("direction", "What color shows in pictures: direction or role.")
    speed: float = option(8.0, "Speed of pictures over real time.", min=0.1, max=100.0)
    start: float = option(0.0, "Second of the recording at which pictures start.", min=0.0)
    seconds: float = option(20.0, "Longest duration of pictures.", min=0.1)
    name: list[str] | None = option(None, "Name of a recording; once for each.")
    show: bool = option(False, "Open the page in a browser.", "--open")

    def __post_init__(self) -> None:
        for option_ in fields(self):
            is_given = getattr(self, option_.name) != option_.default
            refused = ("show",) if self.pictures else _PICTURE_OPTIONS
            if is_given and option_.name in refused:
                output = "--gif and --mp4" if self.pictures else "a page, which has it itself"
                name = "open" if option_.name == "show" else option_.name
                raise ParameterError(f"--{name} is not accepted with {output}")
        if self.pictures and self.html is not None:
            raise ParameterError("--html is not accepted with --gif or --mp4")
        count = len(self.paths)
        if self.name and len(self.name) != count:
            raise ParameterError(
                f"{len(self.name)} --name for {count} recordings: name all or none"
            )

    @property
    def paths(self) -> list[Path]:
        """The files of the recordings."""
        return [path for path in (self.first, self.second) if path is not None]

    @property
    def pictures(self) -> list[Path]:
        """The files of moving pictures, which are written instead of the page."""
        return [path for path in (self.gif, self.mp4) if path is not None]

    def named(self) -> dict[str, Path]:
        """Return the recordings' files by the names that pages and pictures show."""
        names = [printable(name) for name in self.name or [path.stem for path in self.paths]]
        if len(set(names)) < len(names):
            names = [f"{name} ({index})" for index, name in enumerate(names, 1)]
        return dict(zip(names, self.paths, strict=True))


@takes(ReplayOptions)
def replay(options: ReplayOptions) -> None:
    """Write recordings as one page that plays them: in any browser, without a network.

    The page plays at any speed. It shows trails, contact forces, a boat's numbers,
    and order parameters in step with the picture. `--gif` and `--mp4` write a moving picture
    instead (extras `render`, `video`). Pages and moving pictures show two recordings side by side.
    Tracks of real flocks need a TOML file beside them that describes their table
    (`docs/tracks.md`).

    Example: `flockenv replay law.npz learned.npz --html law_and_learned.html`
    """
    if options.pictures:
        _write_pictures(options, options.pictures)
    else:
        _write_page(options)


def _write_page(options: ReplayOptions) -> None:
    # Imported here, since most commands do not need the page's code.
    from flockenv.replay import write_replay

    named = options.named()
    page = options.html or options.first.with_suffix(".html")
    prepare(page)
    recordings = {
        name: load_recording(path, quiet=options.hides_progress) for name, path in named.items()
    }
    written = write_replay(page, recordings)
    if options.as_json:
        print_json({"html": str(page), "bytes": written.size, "every": written.every})
    else:
        thinning = "" if written.every == 1 else f", of {written.every} samples one"
        echo(f"Written to {page} ({written.size / 1e6:.1f} MB{thinning})")
    if options.show:
        open_page(page)


def _write_pictures(options: ReplayOptions, paths: list[Path]) -> None:
    """Write one recording, or two side by side, as a GIF, a video, or both."""
    from flockenv.rendering import frame, save_animation

    named = options.named()
    prepare(*paths)
    runs = [load_recording(path, quiet=options.hides_progress) for path in named.values()]
    for name, run in zip(named, runs, strict=True):
        if len(run) == 0:
            raise ParameterError(f"recording {name!r} is not accepted: samples with their poses")
    # A lone recording gets no caption, unless the user names it.
    captions = list(named) if options.name or len(runs) > 1 else [""]
    for path in paths:
        fps = _FPS[path.suffix.lower()]
        recorded_s = max(float(run.time_s[-1] - run.time_s[0]) for run in runs) - options.start
        picture_s = min(options.seconds, recorded_s / options.speed)
        count = max(1, round(picture_s * fps))
        offsets_s = options.start + np.arange(count) * options.speed / fps
        with progress("drawing", len(offsets_s), options.hides_progress) as advance:

            def draw(offset_s: float) -> NDArray[np.uint8]:
                """Draw all recordings, side by side, at a time after their first samples."""
                advance()
                # The shorter of two recordings stays at its last sample.
                times = (min(run.time_s[0] + offset_s, run.time_s[-1]) for run in runs)
                frames = (
                    frame(run, time_s, colors=options.colors, caption=caption)
                    for run, time_s, caption in zip(runs, times, captions, strict=True)
                )
                return np.concatenate(list(frames), axis=1)

            save_animation(path, map(draw, offsets_s.tolist()), fps)
    if options.as_json:
        print_json({"files": list(map(printable, paths))})
    else:
        echo(f"Written to {' and '.join(map(printable, paths))}")
