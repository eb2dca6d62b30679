"""Plots of README on dark ground, written beside them: ``plot-dark.png``. `make pictures` runs it.

They are what `docs/static/dark.css` makes of plots on the site: lightness is turned around, and
hues stay. A README has no style sheet, but may name a picture for dark ground.
"""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from docs.scripts.plots import REPOSITORY

INVERTED = 0.92
"""How far `invert` goes in the style sheet."""

# CSS filter effects, hue-rotate of 180 degrees: rows of red, green and blue.
_HUES_TURNED = np.array([[-0.574, 1.43, 0.144], [0.426, 0.43, 0.144], [0.426, 1.43, -0.856]])


def plots() -> Iterator[tuple[Path, Path]]:
    """Yield each plot that README shows, and its version on dark ground."""
    readme = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    for name in dict.fromkeys(re.findall(r'srcset="(studies/[\w/]+)-dark\.png"', readme)):
        path = (REPOSITORY / f"{name}.png").resolve()
        yield path, path.with_stem(f"{path.stem}-dark")


def darkened(path: Path) -> NDArray[np.uint8]:
    """Return a picture on dark ground, an array (height, width, 3)."""
    with Image.open(path) as picture:
        light = np.asarray(picture.convert("RGB"), float) / 255.0
    turned = (INVERTED + (1.0 - 2.0 * INVERTED) * light) @ _HUES_TURNED.T
    return (turned.clip(0.0, 1.0) * 255.0).round().astype(np.uint8)


if __name__ == "__main__":
    for light, dark in plots():
        Image.fromarray(darkened(light)).save(dark, optimize=True)
