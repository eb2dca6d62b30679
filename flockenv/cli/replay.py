"""`flockenv replay`."""

from pathlib import Path
from typing import Annotated

import typer

from flockenv.cli.console import interruptible, print_json, progress_bar, say
from flockenv.cli.output import check_file, load_recording, open_page, printable, writable
from flockenv.errors import ParameterError

__all__ = ["replay"]


def replay(
    first: Annotated[
        Path, typer.Argument(metavar="RUN", help="A recording (.npz), or tracks (.csv, .parquet).")
    ],
    second: Annotated[
        Path | None, typer.Argument(metavar="OTHER", help="Another one to play beside it.")
    ] = None,
    html: Annotated[
        Path | None, typer.Option("--html", help="The page. [the first recording's name]")
    ] = None,
    names: Annotated[
        list[str] | None,
        typer.Option("--name", help="What a recording is called on the page; once for each."),
    ] = None,
    show: Annotated[bool, typer.Option("--open", help="Open the page in a browser.")] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print what was written as JSON.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Write recordings as one page that plays them: in any browser, without a network.

    Tracks of real flocks are described by a TOML file beside them, see `docs/tracks.md`.
    Play, scrub, change the speed; trails, contact forces, a boat's numbers under the pointer, and
    order parameters in step with the picture. Two recordings play side by side.

    Example: `flockenv replay law.npz learned.npz --html law_and_learned.html`
    """
    # The page's code is not needed by any other command.
    from flockenv.replay import write_replay

    paths = [first] if second is None else [first, second]
    titles = _titles(paths, names or [])
    page = first.with_suffix(".html") if html is None else html
    if page.suffix not in (".html", ".htm"):
        raise ParameterError(f"--html {page} is not accepted: a name that ends in .html")
    check_file(page, "--html")
    with interruptible("Nothing was written."), progress_bar(quiet or as_json) as progress:
        task = progress.add_task("writing the page", total=len(paths) + 1)
        recordings = {}
        for title, path in zip(titles, paths, strict=True):
            recordings[title] = load_recording(path, quiet=quiet or as_json)
            progress.advance(task)
        with writable(page):
            written = write_replay(page, recordings)
        progress.advance(task)
    if as_json:
        written_page = {"html": str(page), "bytes": written.size, "every": written.every}
        print_json(written_page)
    else:
        thinned = "" if written.every == 1 else f", every {written.every}th sample"
        size = f"{written.size / 1e6:.1f} MB"
        say(f"Written to {page} ({size}{thinned})")
    if show:
        open_page(page)


def _titles(paths: list[Path], names: list[str]) -> list[str]:
    if names and len(names) != len(paths):
        raise ParameterError(f"--name was given {len(names)} times for {len(paths)} recordings")
    titles = [printable(name) for name in names or [path.stem for path in paths]]
    if len(set(titles)) < len(titles) and len(set(paths)) == len(paths) and not names:
        return [printable(path) for path in paths]
    # The same file or name twice is shown twice.
    return [f"{t} ({k + 1})" if titles.count(t) > 1 else t for k, t in enumerate(titles)]
