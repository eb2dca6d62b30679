"""Numbers and tables as Markdown."""

from __future__ import annotations

import math
from collections.abc import Iterable

NOTHING = "–"


def plain(value: float, digits: int = 2) -> str:
    """So many significant digits, no exponent for everyday sizes."""
    if value is None or math.isnan(value):
        return NOTHING
    if value == 0:
        return "0"
    size = math.floor(math.log10(abs(value)))
    if -3 <= size <= 5:
        text = f"{value:,.{max(digits - 1 - size, 0)}f}"
        return text.replace(",", " ")
    return f"{value:.{digits - 1}e}".replace("e-0", "e-").replace("e+0", "e")


def times(value: float) -> str:
    """A ratio."""
    text = plain(value)
    return text if text == NOTHING else f"{text} ×"


def table(header: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A Markdown table; the first column is text, the others are numbers."""
    header = list(header)
    lines = ["| " + " | ".join(header) + " |"]
    lines.append("|" + "|".join(["---"] + ["---:"] * (len(header) - 1)) + "|")
    lines.extend("| " + " | ".join(row) + " |" for row in rows)
    return "\n".join(lines)
