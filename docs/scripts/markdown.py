"""Write tables in Markdown, and fill in the sections of pages."""

import re
from collections.abc import Iterable, Sequence


def markdown(header: Sequence[str], body: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [header, ["---"] * len(header), *body]
    return "\n".join(
        "|" + "".join(f" {cell} |" if cell else " |" for cell in line) for line in lines
    )


def filled(page: str, **sections: str) -> str:
    """Return a page with new text between ``<!-- NAME -->`` and ``<!-- end -->``."""
    for name, text in sections.items():
        between = rf"(?<=<!-- {name} -->\n\n).*?(?=\n\n<!-- end -->)"
        page, count = re.subn(between, lambda _, text=text: text, page, flags=re.DOTALL)
        if count != 1:
            raise ValueError(f"a page has {count} comments <!-- {name} -->, and needs one")
    return page
