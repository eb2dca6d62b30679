from collections.abc import Callable
from pathlib import Path

import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread


@pytest.fixture
def colors_in() -> Callable[[Path], set[str]]:
    """Return the colors of policies that are in the picture of a comparison."""

    def found(path: Path) -> set[str]:
        from flockenv.comparison.figure import POLICY_COLORS, policy_colors

        # Letters and axes have the gray of flocks without leaders.
        every = set(policy_colors([*POLICY_COLORS, "another"]).values()) - {"#555555"}
        pixels = imread(path)[..., :3]
        near = {color: abs(pixels - to_rgb(color)).max(axis=-1) < 0.02 for color in every}
        return {color for color, pixels in near.items() if pixels.sum() > 500}

    return found
