"""Law: the floors of ARCHITECTURE.md are the layers that the linter checks."""

import re

import pytest

from docs.scripts.floors import PAGE, floors
from docs.scripts.markdown import filled


def test_the_page_shows_the_layers():
    text = PAGE.read_text(encoding="utf-8")
    assert filled(text, floors=floors()) == text, "`make floors` prints them again"


def test_a_row_that_is_gone_comes_back():
    text = PAGE.read_text(encoding="utf-8")
    row = re.search(r"^\| \d+ \| `src/contact`.*\n", text, re.MULTILINE)
    assert filled(text.replace(row[0], ""), floors=floors()) == text


def test_a_page_without_the_comments_is_refused():
    with pytest.raises(ValueError, match="a page has 0 comments <!-- floors -->, and needs one"):
        filled("# Architecture\n", floors="")
