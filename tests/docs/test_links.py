"""Law: README, the pages that it links and their words are Markdown, whose links lead somewhere.

A repository's viewer knows no directive of Sphinx, and no file that a build makes.
"""

import re
import subprocess
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from markdown_it import MarkdownIt
from markdown_it.token import Token

REPOSITORY = Path(__file__).parents[2]
README = REPOSITORY / "README.md"
ELSEWHERE = re.compile(r"[a-z]+:")
HTML_LINK = re.compile(r'\b(?:href|src|srcset)="([^"\s]+)')


@cache
def committed() -> frozenset[Path]:
    """Files of the repository, and the folders that hold them."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        check=True,
    )
    files = [REPOSITORY / name for name in listed.stdout.split("\0") if name]
    return frozenset({*files, *(folder for file in files for folder in file.parents)})


@cache
def tokens(page: Path) -> tuple[Token, ...]:
    """What CommonMark, with tables, makes of a page."""
    parser = MarkdownIt("commonmark", {"html": True}).enable("table")
    blocks = parser.parse(page.read_text(encoding="utf-8"))
    return tuple(each for block in blocks for each in (block, *(block.children or ())))


def links(page: Path) -> Iterator[str]:
    for token in tokens(page):
        if token.type == "link_open":
            yield str(token.attrs["href"])
        elif token.type == "image":
            yield str(token.attrs["src"])
        elif token.type in ("html_inline", "html_block"):
            shown = re.sub("<!--.*?-->", "", token.content, flags=re.DOTALL)
            yield from HTML_LINK.findall(shown)


def anchors(page: Path) -> set[str]:
    """What the viewer names the headings of a page."""
    found: set[str] = set()
    in_heading = False
    for token in tokens(page):
        if token.type == "inline" and in_heading:
            words = re.sub(r"[^\w\- ]", "", re.sub(r"\]\([^)]*\)", "", token.content).lower())
            found.add(words.replace(" ", "-"))
        in_heading = token.type == "heading_open" or (in_heading and token.type != "heading_close")
    return found


def target(page: Path, link: str) -> Path:
    return (page.parent / link.partition("#")[0]).resolve()


def linked() -> list[Path]:
    """README, the pages that it links, and the words that these look up."""
    pages = [target(README, each) for each in links(README) if not ELSEWHERE.match(each)]
    pages.append(REPOSITORY / "docs" / "questions.md")
    found = dict.fromkeys(each for each in pages if each.suffix == ".md")
    return [README, *(each for each in found if each.is_file())]


PAGES = {str(page.relative_to(REPOSITORY)): page for page in linked()}


@pytest.mark.parametrize("name", PAGES)
def test_every_link_leads_somewhere(name):
    page, broken = PAGES[name], []
    for link in links(page):
        if ELSEWHERE.match(link):
            continue
        file, anchor = (
            target(page, link) if not link.startswith("#") else page,
            link.partition("#")[2],
        )
        is_there = file in committed()
        if not is_there or (anchor and file.suffix == ".md" and anchor not in anchors(file)):
            broken.append(link)
    assert broken == []
    assert name != "README.md" or len(list(links(page))) > 20


@pytest.mark.parametrize("name", PAGES)
def test_nothing_of_sphinx_is_read_as_text(name):
    raw = [
        token.content or token.info
        for token in tokens(PAGES[name])
        if (token.type == "fence" and token.info.startswith("{"))
        or (token.type == "text" and re.search(r"^:::|\{[a-z]+\}$|^\{[a-z]+\}", token.content))
    ]
    assert raw == []


def test_the_pages_of_the_environments_are_those_of_the_declarations():
    """`make environment-pages` writes them."""
    from docs.scripts import environment_pages

    stale = [
        path.name
        for path, text in environment_pages.pages().items()
        if not path.is_file() or path.read_text(encoding="utf-8") != text
    ]
    assert stale == []
