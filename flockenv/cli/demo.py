"""`flockenv demo`."""

from pathlib import Path
from typing import Annotated

import typer

from flockenv._io.atomic_write import write_text
from flockenv.cli.console import interruptible, print_json, progress_bar, say
from flockenv.cli.output import check_file, open_page, writable
from flockenv.cli.run import in_words, summary_of

__all__ = ["demo"]


def demo(
    seed: Annotated[int, typer.Option(min=0, help="Seed of placement and noise.")] = 7,
    minutes: Annotated[float, typer.Option(min=0.1, help="Length of each run.")] = 8.0,
    out: Annotated[Path, typer.Option(help="The page.")] = Path("results/demo.html"),
    show: Annotated[
        bool, typer.Option("--open/--no-open", help="Open the page in a browser.")
    ] = True,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summaries as JSON.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
) -> None:
    """Run the paper's law and the learned leaders side by side, and open the page that plays both.

    Where `make live` has built the live page, that opens instead, with the same two flocks.

    27 boats in the pool wide, four of them leaders, at bw_s = 0.3 s. Both runs have the same
    initial placement and the same noise.

    Example: `flockenv demo`
    """
    # The page's code is not needed by most commands.
    from flockenv.replay import write_replay
    from flockenv.replay.demo import DEMO_POLICIES, demo_runs, live_demo, live_page

    check_file(out)
    if show and not as_json and (page := live_page()) is not None:
        with writable(out):
            write_text(out, live_demo(page, seed))
        say(f"Written to {out}")
        open_page(out)
        return
    with interruptible("Nothing was written."), progress_bar(quiet or as_json) as progress:
        task = progress.add_task("simulating", total=len(DEMO_POLICIES) * minutes * 60)
        runs = demo_runs(seed, minutes, lambda seconds: progress.advance(task, seconds))
        with writable(out):
            write_replay(out, runs)
    summaries = {name: summary_of(run) for name, run in runs.items()}
    if as_json:
        print_json({"html": str(out), "seed": seed, "runs": summaries})
    else:
        for name, summary in summaries.items():
            say(f"{name}: {in_words(summary, runs[name])}")
        say(f"Written to {out}")
    if show:
        open_page(out)
