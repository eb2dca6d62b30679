"""Law: a planner that knows the noise foresees what its flock then does, and no other does."""

import numpy as np
import pandas as pd
import pytest


@pytest.fixture
def small(script, monkeypatch):
    for name, value in {"EPISODE_S": 16, "CANDIDATES": 3, "BLOCK": 2}.items():
        monkeypatch.setattr(script, name, value)
    return script


def test_only_known_noise_is_the_flock_s_own(script):
    trunk, leans = script.flocks(1, 40), script.learned()
    seen, infos = trunk.reset(seed=[5])
    start = {"snapshot": trunk.snapshots(), "target": list(infos["target"])}
    branches = script.flocks(1, 40)
    known = branches.reset(seed=0, options=start)[0]
    for _ in range(8):
        seen, order, *_ = trunk.step(leans(seen))
        known, foreseen, *_ = branches.step(leans(known))
    assert (order == foreseen).all()
    fresh, _ = branches.reset(options={**start, "noise_seed": [0]})
    for _ in range(8):
        fresh, other, *_ = branches.step(leans(fresh))
    assert (order != other).all()


def test_the_first_candidate_is_what_the_learned_leaders_do(small, monkeypatch):
    monkeypatch.setattr(small, "CANDIDATES", 1)
    seeds = [5, 6]
    assert (small.episodes(seeds, 0) == small.episodes(seeds, None)).all()


def test_an_interrupted_plan_resumes_after_its_last_block(small, tmp_path):
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    small.main(["--episodes", "4", "--out", str(whole)])
    small.main(["--episodes", "2", "--out", str(parts)])
    small.main(["--episodes", "4", "--out", str(parts)])
    tables = [pd.read_csv(folder / "fresh_4.csv") for folder in (whole, parts)]
    pd.testing.assert_frame_equal(*tables)
    assert np.isfinite(tables[0].to_numpy()).all()
