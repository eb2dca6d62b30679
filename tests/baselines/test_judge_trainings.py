"""Law: a training is judged in the flocks of the laws; without a lean it is the tuned law."""

import pandas as pd
import pytest

from flockenv.policies import LeaningLaw

pytest.importorskip("matplotlib")


def test_a_lean_of_zero_is_the_tuned_law(script, tmp_path):
    (folder := tmp_path / "7").mkdir()
    LeaningLaw("wide", 0.0, {}).save(folder / "policy.json")
    script.main([str(folder), "--flocks", "3", "--out", str(tmp_path), "--suffix=-3"])
    table = pd.read_csv(tmp_path / "evaluation-3.csv").set_index("policy")
    assert list(table.index) == ["paper's law", "tuned law", "seed 7"]
    assert table.loc["seed 7", "signed_order"] == table.loc["tuned law", "signed_order"]
    assert table.loc["seed 7", "gain"] == 0.0 > table.loc["paper's law", "gain"]
