"""Fill the marked tables of the pages from committed data: `make tables`.

A table stands between ``<!-- table: NAME -->`` and ``<!-- end -->``; `TABLES` says how NAME is made
and from which file. tests/docs/test_tables.py fails where a page differs from its data.
"""

import re
from collections.abc import Callable
from pathlib import Path

from floors import floors
from leader_words import plans, summary, verdict
from readme_numbers import figures, findings, speed, variants
from training_words import pretrained

DOCS = Path(__file__).parent
PAGES = (
    DOCS.parent / "README.md",
    DOCS.parent / "ARCHITECTURE.md",
    *sorted((DOCS.parent / "studies").glob("**/README.md")),
    *sorted(DOCS.glob("*.md")),
)
MARKED = re.compile(r"(<!-- table: (\S+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)


def main() -> None:
    """Rewrite every page in which a table differs from its data."""
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        new = filled(text)
        if new != text:
            page.write_text(new, encoding="utf-8")


def filled(text: str) -> str:
    """Return a page with each marked table made again."""
    return MARKED.sub(lambda found: f"{found[1]}\n{TABLES[found[2]]()}\n\n{found[4]}", text)


TABLES: dict[str, Callable[[], str]] = {
    "floors": floors,
    "figures": figures,
    "findings": findings,
    "leaders-verdict": verdict,
    "leaders-summary": summary,
    "leaders-plans": plans,
    "speed": speed,
    "training-pretrained": pretrained,
    "variants": variants,
}
"""How each table is made."""


if __name__ == "__main__":
    main()
