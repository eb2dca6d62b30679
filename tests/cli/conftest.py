import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread


@pytest.fixture
def curves_in() -> Callable[[Path], int]:
    """Count the policies whose color is in the picture of a comparison."""

    def count(path: Path) -> int:
        from flockenv.comparison.figure import COLORS, POLICY_COLORS, policy_colors

        # Not the grays, which labels have too.
        colors = {*COLORS, *POLICY_COLORS.values(), *policy_colors("abcde").values()} - {"#555555"}
        pixels = imread(path)[..., :3]
        near = [abs(pixels - to_rgb(color)).max(axis=-1) < 0.02 for color in colors]
        return sum(int(each.sum() > 500) for each in near)

    return count


@pytest.fixture
def flockenv() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run the command line in a process of its own."""

    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-c", "from flockenv.cli import main; main()", *arguments]
        return subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)

    return run
