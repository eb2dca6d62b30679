"""Committed CSV files below docs, and how their numbers stand in the tables of the pages."""

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

DOCS = Path(__file__).parent

# What policies reached in comparisons, and their paired differences.
MEANS = "leaders/means.csv"
DIFFERENCES = "leaders/differences.csv"
POOLS = ("wide", "narrow")

Row = dict[str, str]


def rows(file: str, **wanted: str) -> list[Row]:
    """Return the rows of a CSV file below docs that have these values."""
    with (DOCS / file).open(encoding="utf-8", newline="") as lines:
        found = [
            row
            for row in csv.DictReader(lines)
            if all(row[name] == value for name, value in wanted.items())
        ]
    if not found:
        raise LookupError(f"docs/{file} holds no row with {wanted}")
    return found


def one(file: str, **wanted: str) -> Row:
    """Return the only row that has these values."""
    (row,) = rows(file, **wanted)
    return row


def markdown(header: Sequence[str], body: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [header, ["---"] * len(header), *body]
    return "\n".join(
        "|" + "".join(f" {cell} |" if cell else " |" for cell in line) for line in lines
    )


def interval(row: Row, middle: str, low: str, high: str, form: str = ".3f") -> str:
    """Return a value with its interval in brackets."""
    value, least, most = (f"{float(row[name]):{form}}" for name in (middle, low, high))
    return f"{value} [{least}, {most}]"
