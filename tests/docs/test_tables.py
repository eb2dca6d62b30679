"""Law: a table of a page that quotes data is what the committed data give."""

import importlib.util
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
spec = importlib.util.spec_from_file_location("docs_tables", REPOSITORY / "docs/tables.py")
tables = importlib.util.module_from_spec(spec)
sys.path.append(str(REPOSITORY / "docs"))  # as for the script
spec.loader.exec_module(tables)


@pytest.mark.parametrize("page", tables.PAGES, ids=lambda page: page.stem)
def test_pages_show_the_committed_data(page):
    text = page.read_text(encoding="utf-8")
    assert tables.filled(text) == text, "`make tables` writes them again"
