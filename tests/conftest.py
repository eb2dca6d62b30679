import signal

import pytest


@pytest.fixture(scope="session", autouse=True)
def _interruptible() -> None:
    """Shells have what runs in the background ignore Ctrl-C, and so would what tests start."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
