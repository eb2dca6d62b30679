"""Numbers that a page quotes from committed data, and claims that several pages quote.

The tests of numbers, of the product and of the studies, compare what a page says with its data.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from docs.scripts.plots import REPOSITORY
from flockenv.statistics import mean_interval, student_interval

DIGITS = r"[+\-−]?\d[\d ]*(?:\.\d+)?(?:e-?\d+)?"
DENSITY = (
    "bw (s) at which the density of φ_o within 10° of the tangent falls through 3 times uniform"
)
"""A quantity of the studies' claims, which the front page quotes too."""

ENDS = ("measured", "low", "high")
"""Columns of a claim's value and the ends of its interval."""
RANKS = ("rank_correlation", "low", "high")
"""The same columns of a correlation of ranks."""


@dataclass(frozen=True)
class Number:
    """A number of a page.

    Attributes
    ----------
    page
        File of the page.
    words
        The words around the number: ``{}`` is the number, ``#`` another number.
    file
        Table with the number.
    row
        Values of the row's columns.
    column
        Column of the number, or a function of the rows that gives it.
    form
        Format in which the page writes it.
    """

    page: str
    words: str
    file: str
    row: dict[str, Any] = field(default_factory=dict)
    column: str | Callable[[Any], float] = "measured"
    form: str = ".2f"

    def page_text(self) -> str:
        """Read the page."""
        return (REPOSITORY / self.page).read_text(encoding="utf-8")

    def shown(self, text: str) -> list[str]:
        """Return every number in a text that stands between the words."""
        pattern = re.escape(self.words).replace(r"\{\}", f"({DIGITS})").replace(r"\#", DIGITS)
        return re.findall(pattern, " ".join(text.split()))

    def expected(self) -> str:
        """Return the number from the data, as the page writes it."""
        table = pd.read_csv(REPOSITORY / self.file)
        for name, value in self.row.items():
            table = table[table[name] == value]
        assert len(table), f"{self.file} has no row with {self.row}"
        if callable(self.column):
            value = self.column(table)
        else:
            (value,) = table[self.column]
        return format(value, self.form).replace("-", "−").replace(",", " ")


def mean(column: str) -> Callable[[Any], float]:
    """Return a function that averages a column over the rows."""
    return lambda rows: rows[column].mean()


def gain_of(index: int) -> Callable[[Any], float]:
    """Return a function for one of (mean gain of the states, low end, high end) by its index."""
    return lambda rows: mean_interval(rows["gain"])[index]


def gain_of_plan(rows: Any) -> float:
    """Return the mean difference of the flocks' orders between planner and learned leaders."""
    gain, _, _ = student_interval(rows["planned"] - rows["learned"])
    return gain


def margin_of_plan(rows: Any) -> float:
    """Return half the width of the interval of `gain_of_plan`."""
    _, low, high = student_interval(rows["planned"] - rows["learned"])
    return (high - low) / 2


def plans(page: str) -> list[Number]:
    """List the orders that planners and the learned leaders reach."""
    known, fresh = (f"studies/planning/results/plan_{noise}.csv" for noise in ("known", "fresh"))
    return [
        Number(
            page, "reaches a signed order of {}, and the learned", known, column=mean("planned")
        ),
        Number(page, "and the learned leaders {}", known, column=mean("learned")),
        Number(page, "does not know it reaches {}", fresh, column=mean("planned")),
        Number(page, "a difference of {} ±", fresh, column=gain_of_plan),
        Number(page, "a difference of # ± {}", fresh, column=margin_of_plan),
    ]


def ends_of(column: str) -> tuple[str, str, str]:
    """Name the columns of a mean and of the ends of its interval."""
    return column, f"{column}_low", f"{column}_high"


def interval(
    page: str,
    words: str,
    file: str,
    row: dict[str, Any] | None = None,
    columns: Sequence[str | Callable[[Any], float]] = ENDS,
    form: str = ".2f",
    unit: str = "",
) -> list[Number]:
    """List a number, with its unit, and the ends of its interval, which follow in parentheses.

    ``{}`` in the words stands for all three.
    """
    shown = (f"{{}}{unit} (# to #)", f"#{unit} ({{}} to #)", f"#{unit} (# to {{}})")
    return [
        Number(page, words.replace("{}", part), file, row or {}, column, form)
        for part, column in zip(shown, columns, strict=True)
    ]


def ranks_of_levels(page: str, noisy: str, wide: str, narrow: str) -> list[Number]:
    """List how alike algorithms rank in the easy flock and in the other levels of suite v3."""
    file = "studies/levels/results/ranks.csv"
    return [
        number
        for level, words in (("noisy", noisy), ("wide", wide), ("narrow", narrow))
        for number in interval(page, words, file, {"level": f"order-{level}"}, RANKS)
    ]


def offset(page: str, words: str, horizon_s: int) -> list[Number]:
    """List the gain by a horizon from one planned step without foresight, with its interval."""
    table, gains = "studies/planning/results/best_of_offsets.csv", [*map(gain_of, range(3))]
    return interval(page, words, table, {"horizon_s": horizon_s}, gains, ".3f")


def most_of_an_offset(page: str, words: str) -> Number:
    """Return the upper end by 64 s, the largest, of the gain from one planned step."""
    table = "studies/planning/results/best_of_offsets.csv"
    return Number(page, words, table, {"horizon_s": 64}, gain_of(2), ".3f")
