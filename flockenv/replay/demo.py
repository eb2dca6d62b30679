"""The two runs that `flockenv demo`, the README and the docs' home page show, side by side."""

from collections.abc import Callable
from typing import Final

from flockenv.parameters import FlockParameters
from flockenv.policies.pretrained import LEARNED
from flockenv.policies.registry import EVERY_SUBSTEP
from flockenv.recording import Recording
from flockenv.simulation import simulate

__all__ = ["DEMO_MINUTES", "DEMO_PARAMETERS", "DEMO_POLICIES", "DEMO_SEED", "demo_runs"]

DEMO_PARAMETERS: Final = FlockParameters(n_boats=27, n_leaders=4, pool="wide", bw_s=0.3)
"""Four leaders among 27 boats, near the critical noise."""

DEMO_SEED = 7
DEMO_MINUTES = 8.0

DEMO_POLICIES: Final = {"paper's law": EVERY_SUBSTEP, "learned": LEARNED}
"""How the leaders steer, by the name that a run has on the page."""


def demo_runs(
    seed: int = DEMO_SEED,
    minutes: float = DEMO_MINUTES,
    progress: Callable[[float], object] | None = None,
) -> dict[str, Recording]:
    """Return the runs of `DEMO_PARAMETERS` by name, both from the same initial state.

    Parameters
    ----------
    seed, minutes
        Seed and length of each run.
    progress
        Called now and then with the flock-seconds simulated since.
    """
    return {
        name: simulate(
            DEMO_PARAMETERS, seed, 60.0 * minutes, policy=policy, contacts=True, progress=progress
        )
        for name, policy in DEMO_POLICIES.items()
    }
