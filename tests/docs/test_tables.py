"""Law: a table of a page that quotes data is what the committed data give."""

import importlib.util
import re
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


def test_every_table_is_on_one_page():
    found = [
        name for page in tables.PAGES for _, name, *_ in tables.MARKED.findall(page.read_text())
    ]
    assert sorted(found) == sorted(tables.TABLES)


def test_a_changed_number_is_put_back():
    text = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    changed = re.sub(r"(?m)^(\| 1 \| )\d\.\d+", r"\g<1>9.999", text, count=1)
    assert changed != text
    assert tables.filled(changed) == text
