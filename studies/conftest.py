"""Fixtures of the studies' tests."""

import importlib
import signal
from collections.abc import Iterator
from types import ModuleType

import pytest


@pytest.fixture(scope="module")
def script(request: pytest.FixtureRequest) -> ModuleType:
    """Return the script that a test module is about: test_NAME.py tests NAME.py beside it."""
    name = request.path.stem.removeprefix("test_")
    return importlib.import_module(f"studies.{request.path.parent.name}.{name}")


@pytest.fixture
def _ignored_sigterm() -> Iterator[None]:
    """Where SIGTERM is not taken for Ctrl-C, it does nothing."""
    before = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    yield
    assert signal.signal(signal.SIGTERM, before) == signal.SIG_IGN
