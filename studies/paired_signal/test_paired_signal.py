"""Law: what both branches share cancels in pairs, and adds scatter in other flocks."""

import numpy as np
import pandas as pd
import pytest


def test_shared_luck_cancels_in_pairs(script) -> None:
    luck = np.random.default_rng(0).normal(size=2000)
    better = luck + 0.1 + 0.01 * np.random.default_rng(1).normal(size=2000)
    mean, scatter, z = script.signal(luck, better, paired=True)
    assert (mean, z) == (pytest.approx(0.1, abs=1e-3), pytest.approx(10.0, rel=0.1))
    _, apart, weak = script.signal(luck, better, paired=False)
    assert apart == pytest.approx(np.sqrt(2.0), rel=0.1)
    assert scatter < 0.02 < weak < 0.15


def test_a_short_run(script, tmp_path, monkeypatch) -> None:
    for name, value in {"LONGEST_S": 12, "HORIZONS_S": (8, 12), "WINDOW_S": 4}.items():
        monkeypatch.setattr(script, name, value)
    script.main(["--states", "24", "--out", str(tmp_path)])
    found = pd.read_csv(tmp_path / "signal.csv")
    assert found[["horizon_s", "paired"]].to_numpy().tolist() == [
        [8, True],
        [8, False],
        [12, True],
        [12, False],
    ]
    assert np.isfinite(found["z"]).all()
