"""Law: the floors of ARCHITECTURE.md are the layers that the linter checks."""

import re

from docs.scripts import floors


def test_the_page_shows_the_layers():
    text = floors.PAGE.read_text(encoding="utf-8")
    assert floors.filled(text) == text, "`make floors` prints them again"


def test_a_row_that_is_gone_comes_back():
    text = floors.PAGE.read_text(encoding="utf-8")
    row = re.search(r"^\| \d+ \| `src/contact`.*\n", text, re.MULTILINE)
    assert floors.filled(text.replace(row[0], "")) == text
