"""Laws: without a lean a training is the tuned law; trainings share the luck of their flocks."""

import numpy as np
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
    # Three flocks do not say which of the other two is better.
    assert table.loc["seed 7", "gain"] == 0.0 != table.loc["paper's law", "gain"]


def test_the_mean_of_trainings_keeps_the_luck_that_they_share(script):
    """Five trainings with one and the same gain in each of 100 flocks: ± 1.984·0.29/√100."""
    luck = np.linspace(-0.5, 0.5, 100)
    found = pd.DataFrame({name: np.zeros(100) for name in script.LAWS})
    for seed in range(5):
        found[f"ppo {seed}"] = 0.1 + luck
    row = script.algorithms(found).iloc[0]
    assert (row["algorithm"], row["seeds"]) == ("ppo", 5)
    assert row["gain"] == pytest.approx(0.1)
    assert row["gain_high"] - 0.1 == pytest.approx(1.984 * luck.std(ddof=1) / 10, rel=0.05)
    alone = script.algorithms(found[[*script.LAWS, "ppo 0"]]).iloc[0]
    assert not {"gain_low", "gain_high"} & set(alone.dropna().index)
