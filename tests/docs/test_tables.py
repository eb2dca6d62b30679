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


def test_lessons_of_the_live_page_quote_the_committed_data():
    from committed_data import MEANS, one

    lessons = (REPOSITORY / "web/lessons.mjs").read_text(encoding="utf-8")

    def order(policy, leaders):
        row = one(MEANS, case="wide-bw-0.31", policy=policy, leaders=str(leaders))
        return f"{float(row['signed_order']):.2f}"

    law, learned, single = order("paper's law", 4), order("learned", 4), order("paper's law", 1)
    assert (
        f"Over 256 flocks at 0.31 s the learned leaders reach {learned}, the law {law}." in lessons
    )
    assert f"is {single} with one leader and {law} with four." in lessons
