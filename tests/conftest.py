import itertools
import os
import random
import signal

import gymnasium
import hypothesis
import numpy as np
import pytest

#: `make fuzz` sets it: so many random examples of each hostile input, instead of a few fixed ones.
FUZZ_EXAMPLES = os.environ.get("FUZZ_EXAMPLES")

# A busy machine makes an example slow, not wrong. What `make fuzz` finds becomes an @example.
hypothesis.settings.register_profile("fixed", deadline=None, derandomize=True)
hypothesis.settings.register_profile(
    "fuzz",
    max_examples=int(FUZZ_EXAMPLES or 60),
    deadline=None,
    derandomize=FUZZ_EXAMPLES is None,
    suppress_health_check=list(hypothesis.HealthCheck),
)
hypothesis.settings.load_profile("fixed")


@pytest.fixture(scope="session", autouse=True)
def _interruptible() -> None:
    """Shells have what runs in the background ignore Ctrl-C, and so would what tests start."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True)
def _no_chance(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever draws without a seed draws the same in each run: spaces, environments, suites."""
    random.seed(2011)
    np.random.seed(2011)  # noqa: NPY002 - the suites of others use the global generator
    numbers, new = itertools.count(2011), np.random.default_rng
    monkeypatch.setattr(
        np.random, "default_rng", lambda seed=None: new(next(numbers) if seed is None else seed)
    )
    seeded = gymnasium.utils.seeding.np_random
    monkeypatch.setattr(
        gymnasium.utils.seeding,
        "np_random",
        lambda seed=None: seeded(next(numbers) if seed is None else seed),
    )
