"""Draw the moving pictures of the pages when pages are built, and again if they would differ.

A picture depends on the package and on the commands or the code that draw it. It lies below
docs/_build, beside a still for readers whose system asks for less motion.
"""

import hashlib
import re
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image, ImageSequence

import flockenv
from docs.scripts.plots import DOCS

SHOWN = DOCS / "_build" / "shown" / "loops"
"""Folder of the pictures: conf.py copies _build/shown to the site."""

_KEYS = DOCS / "_build" / "loops"
HEIGHT = 360
"""Height of a picture in pixels."""

_FPS = 12.5

Frames = Iterable[Image.Image]


class LoopError(Exception):
    """A command of a page that fails, or that does not write its picture."""


def draw(name: str, make: Callable[[], Frames], *sources: str) -> None:
    """Draw NAME.webp and its still, unless they exist and package and sources are unchanged."""
    key = hashlib.sha256("\0".join((_package_digest(), *sources)).encode()).hexdigest()
    files = [SHOWN / f"{name}.webp", SHOWN / f"{name}-still.webp"]
    key_file = _KEYS / f"{name}.key"
    if key_file.is_file() and key_file.read_text() == key and all(map(Path.is_file, files)):
        return
    frames = list(make())
    for folder in (SHOWN, _KEYS):
        folder.mkdir(parents=True, exist_ok=True)
    moving = {"save_all": True, "append_images": frames[1:], "duration": round(1000 / _FPS)}
    frames[0].save(files[0], loop=0, quality=35, method=4, **moving)
    frames[len(frames) // 2].save(files[1], quality=70)
    key_file.write_text(key)


@cache
def _package_digest() -> str:
    """Return the digest of the package's Python files and compiled modules."""
    folder = Path(flockenv.__file__).parent
    files = sorted(path for path in folder.rglob("*") if path.suffix in (".py", ".so"))
    digests = (hashlib.sha256(path.read_bytes()).hexdigest() for path in files)
    return hashlib.sha256("".join(digests).encode()).hexdigest()


def draw_commands(name: str, commands: str) -> None:
    """Draw a picture by running the commands of a page, which write NAME.gif."""
    draw(name, lambda: _frames_from_commands(name, commands), commands)


def _frames_from_commands(name: str, commands: str) -> Frames:
    with TemporaryDirectory() as folder:
        for line in re.sub(r"\\\n\s*", " ", commands).splitlines():
            program, *words = shlex.split(line)
            if program != "flockenv":
                raise LoopError(f"{name}: {program} is not flockenv")
            command = [sys.executable, "-m", "flockenv", *words]
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                raise LoopError(f"{name}: {line}\n{done.stderr}")
        picture = Path(folder, f"{name}.gif")
        if not picture.is_file():
            raise LoopError(f"{name}: no command writes {picture.name}")
        with Image.open(picture) as frames:
            width = round(HEIGHT * frames.width / frames.height)
            return [
                frame.convert("RGB").resize((width, HEIGHT), Image.Resampling.LANCZOS)
                for frame in ImageSequence.Iterator(frames)
            ]


def shown(name: str, alt: str, above: str = "", width: int = HEIGHT) -> str:
    """Return HTML that shows a picture; `above` is the path from its page to the site's root."""
    file = f"{above}loops/{name}"
    return (
        f'<picture class="loop">'
        f'<source srcset="{file}-still.webp" media="(prefers-reduced-motion: reduce)">'
        f'<img src="{file}.webp" alt="{alt}" width="{width}" loading="lazy">'
        f"</picture>"
    )
