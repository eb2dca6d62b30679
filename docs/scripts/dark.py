"""Draw the plots of README for a dark background, as ``plot-dark.png``: `make pictures`.

Like `docs/static/dark.css` on the site, this inverts lightness and keeps hues. A README has no
style sheet, but may name another picture for dark backgrounds.
"""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from docs.scripts.plots import REPOSITORY

INVERTED = 0.92
"""The argument of the filter `invert` in the style sheet."""

# CSS filter effects, hue-rotate of 180 degrees: rows of red, green and blue.
_HUE_ROTATION = np.array([[-0.574, 1.43, 0.144], [0.426, 0.43, 0.144], [0.426, 1.43, -0.856]])


def plots() -> Iterator[tuple[Path, Path]]:
    """Yield the paths of each plot in README and of its dark version."""
    readme = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    for name in dict.fromkeys(re.findall(r'srcset="(studies/[\w/]+)-dark\.png"', readme)):
        path = (REPOSITORY / f"{name}.png").resolve()
        yield path, path.with_stem(f"{path.stem}-dark")


def darkened(path: Path) -> NDArray[np.uint8]:
    """Return the dark version of a picture, an array (height, width, 3)."""
    with Image.open(path) as picture:
        light = np.asarray(picture.convert("RGB"), float) / 255.0
    inverted = (INVERTED + (1.0 - 2.0 * INVERTED) * light) @ _HUE_ROTATION.T
    return (inverted.clip(0.0, 1.0) * 255.0).round().astype(np.uint8)


if __name__ == "__main__":
    for light, dark in plots():
        Image.fromarray(darkened(light)).save(dark, optimize=True)
