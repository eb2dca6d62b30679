"""The script of PPO trains with its own settings."""

from pathlib import Path

import pytest

pytest.importorskip("stable_baselines3")

SHORT = {"n_boats": 8, "num_flocks": 4, "n_steps": 16, "batch_size": 32, "n_epochs": 1}
QUICK = {"start": "", "validation_episodes": 2, "validation_s": 5.0}


def test_a_short_run(script, tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.setattr(script, "SETTINGS", script.SETTINGS.replace(**SHORT, **QUICK))
    script.main(["--samples", "320", "--out", str(tmp_path)])
    assert "wide k=4" in capsys.readouterr().out
    script.main(["--samples", "640", "--out", str(tmp_path), "--resume"])
    assert len((tmp_path / "curve.csv").read_text().splitlines()) == 3
    with pytest.raises(SystemExit, match="holds a run already"):
        script.main(["--samples", "320", "--out", str(tmp_path)])
