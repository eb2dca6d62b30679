"""Law: a study with results has a page that the table links, and links lead somewhere."""

import re
from pathlib import Path

import pytest

from studies import study

PAGES = sorted(study.HERE.rglob("*.md"))


def links(page: Path) -> list[str]:
    return re.findall(r"\]\(([^)#\s]+)(?:#[\w-]*)?\)", page.read_text("utf-8"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(study.HERE)))
def test_links_lead_somewhere(page: Path) -> None:
    here = [each for each in links(page) if not each.startswith("http")]
    assert [each for each in here if not (page.parent / each).exists()] == []


def test_a_study_with_results_has_a_page_in_the_table() -> None:
    table = links(study.HERE / "README.md")
    folders = sorted(path.parent.name for path in study.HERE.glob("*/results"))
    assert [name for name in folders if f"{name}/README.md" not in table] == []
