"""Law: `src/draw/palette.rs` alone declares colors; pages, films and plots take them from there."""

import re
from pathlib import Path

from flockenv import _core
from flockenv.rendering.palette import OKABE_ITO, PALETTE

ROOT = Path(__file__).parents[2]
FOLDERS = ("src", "flockenv", "web", "docs/scripts", "benches")
# What measurements against other engines install there.
INSTALLED = ROOT / "benches/peers/.venv"
CODE = re.compile(r"(?:#|0x)([0-9a-f]{6})\b", re.IGNORECASE)


def test_no_other_file_types_a_color_of_the_palette():
    declared = {*PALETTE.values(), *OKABE_ITO.values(), *re.findall("#\\w{6}", _core.STYLE_SHEET)}
    typed = {
        (str(file.relative_to(ROOT)), code.lower())
        for folder in FOLDERS
        for names in ("*.rs", "*.py", "*.mjs", "*.css", "page.html")
        for file in (ROOT / folder).rglob(names)
        if INSTALLED not in file.parents
        for code in CODE.findall(file.read_text(encoding="utf-8"))
        if f"#{code.lower()}" in declared
    }
    assert {name for name, _ in typed} == {"src/draw/palette.rs"}
    assert len(typed) == len(declared)


def test_paper_and_dark_pages_have_the_colors_of_frames():
    assert OKABE_ITO["blue"] == PALETTE["clockwise"] == "#0072b2"
    assert all(f"--{name}:{color};" in _core.STYLE_SHEET for name, color in PALETTE.items())
