"""The script that a test module is about: test_NAME.py tests NAME.py beside it."""

import importlib
from types import ModuleType

import pytest


@pytest.fixture(scope="module")
def script(request: pytest.FixtureRequest) -> ModuleType:
    """Return the script as a module."""
    name = request.path.stem.removeprefix("test_")
    return importlib.import_module(f"studies.{request.path.parent.name}.{name}")
