import subprocess
import sys
from collections.abc import Callable

import pytest


@pytest.fixture
def flockenv() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run the command line in a process of its own."""

    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-c", "from flockenv.cli import main; main()", *arguments]
        return subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)

    return run
