"""`flockenv demo`."""

from dataclasses import dataclass
from pathlib import Path

from flockenv._io.atomic_write import write_text
from flockenv.cli.console import echo, print_json
from flockenv.cli.options import Printing, option, takes
from flockenv.cli.output import in_words, open_page, prepare, summary_of
from flockenv.cli.progress import progress


@dataclass(frozen=True, kw_only=True)
class DemoOptions(Printing):
    """Options of `flockenv demo`."""

    seed: int = option(7, "Seed of placement and noise.", min=0)
    minutes: float | None = option(
        None, "Record runs of this length, even if the live page is built. [8]", min=0.1
    )
    out: Path = option(Path("results/demo.html"), "The page.", endings=lambda: (".html",))
    show: bool = option(True, "Open the page in a browser.", "--open/--no-open")


@takes(DemoOptions)
def demo(options: DemoOptions) -> None:
    """Run the paper's law and the learned leaders side by side, and open the page that plays both.

    If `make live` has built the live page, that page opens instead, with the same two flocks.
    `--minutes` records the two runs in any case.

    27 boats in the pool wide, four of them leaders, at bw_s = 0.3 s. Both runs have the same
    initial placement and the same noise.

    Example: `flockenv demo`
    """
    # Imported here, since most commands do not need the page's code.
    from flockenv.replay import write_replay
    from flockenv.replay.demo import (
        DEMO_MINUTES,
        DEMO_POLICIES,
        demo_runs,
        live_demo,
        live_page,
    )

    out, seed = options.out, options.seed
    prepare(out)
    must_record = options.minutes is not None or options.as_json or not options.show
    if not must_record and (page := live_page()) is not None:
        write_text(out, live_demo(page, seed))
    else:
        minutes = DEMO_MINUTES if options.minutes is None else options.minutes
        total = len(DEMO_POLICIES) * minutes * 60
        with progress("simulating", total, options.hides_progress) as advance:
            runs = demo_runs(seed, minutes, advance)
        write_replay(out, runs)
        if options.as_json:
            summaries = {name: summary_of(run) for name, run in runs.items()}
            print_json({"html": str(out), "seed": seed, "runs": summaries})
            return
        for name, run in runs.items():
            echo(f"{name}: {in_words(run)}")
    echo(f"Written to {out}")
    if options.show:
        open_page(out)
