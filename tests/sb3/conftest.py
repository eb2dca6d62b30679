"""Small networks, and tests side by side: one thread of torch for each."""

from collections.abc import Iterator

import numpy as np
import pytest

torch = pytest.importorskip("torch")


def started(venv, seed=None):
    """Return an environment after a reset, seeded before if a seed is given."""
    if seed is not None:
        venv.seed(seed)
    venv.reset()
    return venv


def steps(venv, number):
    """Return what so many steps without a rudder return."""
    return [venv.step(np.zeros((venv.num_envs, 1), np.float32)) for _ in range(number)]


@pytest.fixture(autouse=True)
def _one_thread() -> Iterator[None]:
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)
