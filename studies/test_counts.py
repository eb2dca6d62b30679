"""Law: a statement of the paper counts once, by the verdicts of all its lines."""

from pathlib import Path

import pandas as pd

from studies import counts, study


def test_the_page_counts_the_statements() -> None:
    assert counts.table() in (study.HERE / "README.md").read_text(encoding="utf-8")


def test_a_statement_counts_once() -> None:
    """Two presets agree, two do not, one is open; what is ours does not count."""
    lines = [
        ("paper", "a", "holds"),
        ("paper", "a", "holds"),
        ("paper", "b", "holds"),
        ("paper", "b", "fails"),
        ("paper", "c", "fails"),
        ("paper", "c", "open"),
        ("ours", "d", "fails"),
    ]
    claims = pd.DataFrame(lines, columns=["of", "claim", "verdict"])
    assert dict(zip(counts.ANSWERS, counts.counted(claims), strict=True)) == {
        "holds": 1,
        "fails": 0,
        "depends": 1,
        "open": 1,
    }


def test_a_line_that_more_runs_judged_counts_as_they_judge_it(tmp_path: Path) -> None:
    """One of two open lines was judged again; another study's line stays away from the count."""
    names = ["figure", "of", "claim", "reading", "quantity", "verdict"]
    first = [["fig10", "paper", claim, "", "", "open"] for claim in ("a", "b")]
    again = [["fig10", "paper", "b", "", "", "holds"], ["fig07", "paper", "c", "", "", "fails"]]
    for folder, lines in (("section4", first), ("decided", again)):
        (tmp_path / folder).mkdir()
        pd.DataFrame(lines, columns=names).to_csv(tmp_path / folder / "claims.csv", index=False)
    found = counts.judged(tmp_path / "section4")
    assert counts.counted(found[found["figure"] == "fig10"]) == [1, 0, 0, 1]
    (tmp_path / "decided" / "claims.csv").unlink()
    assert counts.counted(counts.judged(tmp_path / "section4")) == [0, 0, 0, 2]
