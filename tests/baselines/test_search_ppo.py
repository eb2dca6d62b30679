"""The search of PPO's settings: what it draws, stores and resumes from."""

import math
from pathlib import Path

import pandas as pd
import pytest

pytest.importorskip("stable_baselines3")

from flockenv.training import TrainingSettings

SHORT = {"n_boats": 8, "num_flocks": 4, "batch_size": 32, "episode_s": 20.0, "start": "damped law"}
QUICK = ["--samples", "64", "--episodes", "2", "--quiet"]


@pytest.fixture
def short(_quick_clones, script, monkeypatch: pytest.MonkeyPatch) -> None:
    settings = script.SETTINGS.replace(**SHORT, validation_s=5.0)
    monkeypatch.setattr(script, "SETTINGS", settings)
    monkeypatch.setitem(script.RANGES, "n_steps", script.one_of(16, 32))


def test_ranges_end_where_they_say(script) -> None:
    for name, (low, high) in {
        "learning_rate": (3e-5, 1e-3),
        "gamma": (0.96, 0.999),
        "gae_lambda": (0.8, 0.995),
        "n_steps": (64, 512),
        "control_hz": (2.5, 10.0),
    }.items():
        assert script.RANGES[name](0.0) == pytest.approx(low)
        assert script.RANGES[name](1.0 - 1e-12) == pytest.approx(high, rel=1e-3)


def test_it_stores_every_run_and_resumes(short, script, tmp_path: Path, capsys) -> None:
    arguments = [*QUICK, "--runs", "2", "--out", str(tmp_path)]
    script.main(arguments)
    path = tmp_path / "search.csv"
    table = pd.read_csv(path)
    assert list(table["run"]) == ["damped law", "0", "1"]
    flocks = [name for name in table if " k=" in name]
    assert len(flocks) == 8
    for _, row in table.iterrows():
        assert row["mean"] == pytest.approx(row[flocks].mean(), abs=1e-4)
    best = TrainingSettings.from_toml((tmp_path / "best.toml").read_text())
    winner = table.loc[table["mean"][1:].idxmax()]
    for name in script.RANGES:
        assert math.isclose(float(getattr(best, name)), float(winner[name]), rel_tol=1e-4)
    assert best.final_learning_rate == pytest.approx(best.learning_rate / 10)

    before = path.read_bytes()
    changed = [(folder / "checkpoint.npz").stat().st_mtime_ns for folder in tmp_path.glob("run-*")]
    path.unlink()
    script.main(arguments)
    assert path.read_bytes() == before
    again = [(folder / "checkpoint.npz").stat().st_mtime_ns for folder in tmp_path.glob("run-*")]
    assert again == changed
    with pytest.raises(SystemExit, match="of another search"):
        script.main([*arguments, "--seed", "1"])
