"""Ablation: groups that hold every weight once, and the same lean on average without them."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from flockenv.policies import LeaningLaw, NetworkPolicy
from flockenv.policies.leaning_law import FEATURES

GAINS = {"gain": 1.0, "backward_gain": 2.0, "damping": 9.0}


def test_every_weight_is_in_one_group(script) -> None:
    names = [name for group in script.GROUPS.values() for name in group]
    assert sorted(names) == sorted(FEATURES)


def test_what_is_left_out_leans_as_usual(script) -> None:
    random = np.random.default_rng(0)
    means = dict(zip(FEATURES, random.normal(size=len(FEATURES)), strict=True))
    weights = dict(zip(FEATURES, random.normal(size=len(FEATURES)), strict=True))
    found = script.variants(LeaningLaw(GAINS, 0.1, weights), means)
    usual = [
        law.bias + sum(weight * means[name] for name, weight in law.weights.items())
        for law in found.values()
    ]
    np.testing.assert_allclose(usual, usual[0])
    assert found["no weights"].weights == {}
    assert len(found) == 2 + 2 * len(script.GROUPS)


def test_a_short_run(script, tmp_path: Path, capsys) -> None:
    LeaningLaw(GAINS, 0.1, {"near_ahead": 3.0}).save(tmp_path / "law.npz")
    arguments = ["--pool", "narrow", "--episodes", "3", "--minutes", "0.3"]
    out = ["--out", str(tmp_path / "a.csv")]
    script.main([str(tmp_path / "law.npz"), *arguments, *out])
    table = pd.read_csv(tmp_path / "a.csv", index_col="law")
    assert table.loc["whole", "beyond_whole"] == 0.0
    # A group without weights takes nothing away.
    assert table.loc["without outer wall", "beyond_whole"] == 0.0
    assert table.loc["no weights", "beyond_whole"] != 0.0
    lean = pd.read_csv(tmp_path / "a-lean.csv", index_col="feature")
    assert list(lean.index) == ["bias", *FEATURES]
    assert lean.loc["bias", "lean_rad"] == 0.1
    assert lean.loc["near_ahead", "mean"] != 0.0
    assert lean.loc["near_ahead", "lean_rad"] == 3.0 * lean.loc["near_ahead", "mean"]
    assert (lean["lean_rad"] != 0.0).sum() == 2
    assert "whole" in capsys.readouterr().out
    other = tmp_path / "other.csv"
    script.main(
        [str(tmp_path / "law.npz"), *arguments, "--seed", "1", "--quiet", "--out", str(other)]
    )
    again = pd.read_csv(other, index_col="law")
    assert again.loc["whole", "signed_order"] != table.loc["whole", "signed_order"]
    NetworkPolicy([np.zeros((67, 1))], [[0.0]]).save(tmp_path / "net.npz")
    with pytest.raises(SystemExit, match="not a leaning law"):
        script.main([str(tmp_path / "net.npz"), *arguments, *out])
    LeaningLaw(GAINS, 0.1, {"fw": 0.2}).save(tmp_path / "further.npz")
    with pytest.raises(SystemExit, match="not those of the groups"):
        script.main([str(tmp_path / "further.npz"), *arguments, *out])
