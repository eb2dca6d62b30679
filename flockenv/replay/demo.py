"""The two runs that `flockenv demo`, the README and the docs' home page show, side by side."""

import json
from collections.abc import Callable
from importlib import resources
from importlib.resources.abc import Traversable
from typing import Final

from flockenv.parameters import FlockParameters
from flockenv.policies.names import EVERY_SUBSTEP, LEARNED, PAPERS_LAW
from flockenv.recording import Recording
from flockenv.replay.template import as_script_content
from flockenv.simulation import simulate

DEMO_PARAMETERS: Final = FlockParameters(n_boats=27, n_leaders=4, pool="wide", bw_s=0.3)
"""Four leaders among 27 boats, near the critical noise."""

DEMO_MINUTES: Final = 8.0
"""Length of recorded runs."""

DEMO_POLICIES: Final = {PAPERS_LAW: EVERY_SUBSTEP, LEARNED: LEARNED}
"""The leaders' policies, by the run's name on the page."""


def demo_runs(
    seed: int = 7,
    minutes: float = DEMO_MINUTES,
    progress: Callable[[float], object] | None = None,
) -> dict[str, Recording]:
    """Return the runs of `DEMO_PARAMETERS` by name, both from the same initial state.

    `progress` is called now and then with the flock-seconds simulated since its last call.
    """
    return {
        name: simulate(
            DEMO_PARAMETERS, seed, 60.0 * minutes, policy=policy, contacts=True, progress=progress
        )
        for name, policy in DEMO_POLICIES.items()
    }


def live_page() -> Traversable | None:
    """Return the live page if `make live` has built it into the package; None otherwise."""
    page = resources.files("flockenv.replay").joinpath("live.html")
    return page if page.is_file() else None


def live_demo(page: Traversable, seed: int) -> str:
    """Return a live page that opens with the demo's two flocks, seeded with `seed`."""
    p = DEMO_PARAMETERS
    flock = f"n_boats={p.n_boats}&n_leaders={p.n_leaders}&pool={p.pool}&bw_s={p.bw_s}&seed={seed}"
    link = f"#lesson=learned&{flock}&beside.leaders={LEARNED}"
    opening = as_script_content(f'"opening": {json.dumps(link)}')
    return page.read_text("utf-8").replace('"opening": null', opening, 1)
