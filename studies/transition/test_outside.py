"""Law: boats in jams are not outside of them, and flocks without jams say nothing of these."""

from types import ModuleType

import pandas as pd
import pytest


def runs(coverage: float, in_jams: list[float], start: str = "one-jam") -> pd.DataFrame:
    same = {"c4": 0.1, "n_boats": 200, "coverage": coverage, "start": start}
    return pd.DataFrame([same | {"in_jams": each} for each in in_jams])


def test_a_lever_rule_keeps_the_coverage_outside(script: ModuleType) -> None:
    """0.2 stay outside: a third is in jams at a coverage of 0.3, four fifths at 1."""
    table = pd.concat([runs(0.3, [1 / 3] * 4), runs(1.0, [0.8] * 4)])
    found = script.outside(table).set_index("coverage")
    assert found["outside"].tolist() == pytest.approx([0.2, 0.2])
    assert found[["low", "high"]].to_numpy().ravel() == pytest.approx([0.2] * 4)


def test_flocks_without_jams_do_not_count(script: ModuleType) -> None:
    found = script.outside(runs(0.5, [0.0, 0.02, 0.6, 0.8])).iloc[0]
    assert (found["runs"], found["with_jams"]) == (4, 2)
    assert found["outside"] == pytest.approx(0.15)
    nothing = script.outside(runs(0.5, [0.0, 0.0])).iloc[0]
    assert nothing["with_jams"] == 0
    assert pd.isna(nothing["outside"])


def test_starts_are_kept_apart(script: ModuleType) -> None:
    both = pd.concat([runs(0.5, [0.6] * 3), runs(0.5, [0.2] * 3, "rotating")])
    found = script.outside(both).set_index("start")["outside"]
    assert found.to_dict() == pytest.approx({"one-jam": 0.2, "rotating": 0.4})
