"""How many statements of the paper hold, by figure: `python -m studies.counts` prints the table.

A statement of the paper is counted once, however many presets, numbers of leaders or levels it is
judged by: it holds or fails if all of these agree, it depends if some hold and others fail, and it
is open otherwise. Statements of our own, at noises, densities or by quantities of which the paper
says nothing, are not counted. If more runs judged a line again, their verdict counts.
"""

from pathlib import Path

import pandas as pd

HERE = Path(__file__).parent
FIGURES = {
    "states": ("4 to 6, Table 2", "section4/pictures/table2"),
    "fig07": ("7", "section4/pictures/fig07"),
    "fig08": ("8", "section4/pictures/fig08"),
    "fig09": ("9", "section4/pictures/fig09"),
    "fig10": ("10", "section4/pictures/fig10"),
    "fig11": ("11", "section4/pictures/fig11"),
    "fig12": ("12", "section4/pictures/fig12"),
    "noise_makes_motion": ("summary", "density/pictures/noise_makes_motion"),
    "fig14": ("14", "section5/pictures/fig14_paper"),
    "fig15": ("15", "section5/pictures/fig15"),
    "fig16": ("16", "section5/pictures/fig16"),
    "fig17": ("17", "section5/pictures/fig17"),
}
"""The paper's figures by the name of their claims: number and picture."""
ANSWERS = ("holds", "fails", "depends", "open")


def answer(verdicts: set[str]) -> str:
    """Return what several judgments of one statement say together."""
    if {"holds", "fails"} <= verdicts:
        return "depends"
    return verdicts.pop() if len(verdicts) == 1 else "open"


def counted(claims: pd.DataFrame) -> list[int]:
    """Return how many statements of the paper have each of the `ANSWERS`."""
    theirs = claims[claims["of"] == "paper"]
    found = [answer({*each}) for _, each in theirs.groupby("claim")["verdict"]]
    return [found.count(each) for each in ANSWERS]


def judged(folder: Path) -> pd.DataFrame:
    """Return the claims of a study; more runs replace the verdict of the lines that they judged."""
    again = folder.parent / "decided" / "claims.csv"
    tables = [pd.read_csv(path) for path in (again, folder / "claims.csv") if path.exists()]
    return pd.concat(tables).drop_duplicates(_LINE)


_LINE = ["figure", "claim", "reading", "quantity"]
"""What tells the lines of two files apart."""


def table() -> str:
    """Return the table of all figures in Markdown."""
    rows = {}
    for name, (number, picture) in FIGURES.items():
        claims = judged(HERE / picture.partition("/")[0])
        rows[f"[{number}]({picture}.png)"] = counted(claims[claims["figure"] == name])
    rows["all"] = [sum(each) for each in zip(*rows.values(), strict=True)]
    lines = [[name, *map(str, counts)] for name, counts in rows.items()]
    shown = [["figure", *ANSWERS], ["---"] * 5, *lines]
    return "".join(f"| {' | '.join(line)} |\n" for line in shown)


if __name__ == "__main__":
    print(table(), end="")
