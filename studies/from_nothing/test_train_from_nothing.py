"""From nothing: untrained leaders hold their rudders, and the curve ends beside the laws."""

import pandas as pd
import pytest

pytest.importorskip("stable_baselines3")


@pytest.mark.parametrize("observed", ["lean", "default"])
def test_a_short_run(observed, script, tmp_path, monkeypatch) -> None:
    small = {"HOURS": (0.02, 0.02), "JUDGES": (2, 3), "JUDGED_S": 2.0, "FLOCKS": 1}
    for name, value in small.items():
        monkeypatch.setattr(script, name, value)
    for model in script.stages("narrow", 5, observed):
        assert not model.predict(model.env.reset(), deterministic=True)[0].any()
    script.main("narrow", 5, tmp_path / "narrow_5", observed)
    rows = pd.read_csv(tmp_path / "narrow_5" / "curve.csv")
    assert list(rows["policy"][-4:]) == [*script.LAWS, "PPO"]
    assert rows["flock_hours"].dropna().is_monotonic_increasing
    assert rows["stage"].nunique() == 3
    assert (tmp_path / "narrow_5" / "model.zip").exists()
