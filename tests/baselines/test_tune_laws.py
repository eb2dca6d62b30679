"""Tuning: what the search keeps, that it climbs, and that the same seed means the same gains."""

import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

TINY = ["--episodes", "2", "--minutes", "0.2", "--quiet"]


def test_it_keeps_every_candidate(script, tmp_path: Path, capsys) -> None:
    for name in ("one", "other"):
        script.main([*TINY, "--generations", "2", "--out", str(tmp_path / name)])
    found = tomllib.loads((tmp_path / "one" / "gains.toml").read_text())
    again = tomllib.loads((tmp_path / "other" / "gains.toml").read_text())
    assert found["made"]["command"].startswith("python baselines/tune_laws.py --episodes 2")
    for pool in script.POOLS:
        gains = found["damped law"][pool]
        assert gains.keys() == script.RANGES.keys()
        assert gains == again["damped law"][pool]
        table = pd.read_csv(tmp_path / "one" / f"damped-law-{pool}.csv")
        assert list(table) == ["generation", *script.RANGES, "signed_order"]
        assert table["generation"].nunique() == 2
        assert np.isfinite(table["signed_order"]).all()


def test_it_climbs(script, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On scores that are known instead of the flock's."""

    def known(parameters, policy, seeds, duration_s):
        score = -(np.log(policy.gains["gain"] / 7.0) ** 2)
        return {"signed_order": np.full(len(seeds), score)}

    monkeypatch.setattr(script, "run_episodes", known)
    arguments = ["--pool", "narrow", "--generations", "25"]
    script.main([*TINY, *arguments, "--out", str(tmp_path)])
    found = tomllib.loads((tmp_path / "gains.toml").read_text())
    assert found["damped law"]["narrow"]["gain"] == pytest.approx(7.0, rel=0.05)


def test_seeds_are_for_training(script, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []

    def noted(parameters, policy, seeds, duration_s):
        seen.extend(seeds)
        return {"signed_order": np.zeros(len(seeds))}

    monkeypatch.setattr(script, "run_episodes", noted)
    script.main([*TINY, "--generations", "2", "--pool", "narrow", "--out", str(tmp_path)])
    assert min(seen) >= 2**32
