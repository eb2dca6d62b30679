"""Law: luck that is chosen by one half of the noises is not found again in the other."""

import numpy as np
import pandas as pd
import pytest


def test_a_gain_is_what_the_best_offset_adds(script) -> None:
    """The third offset of four adds 0.5, and the noise is the same for all of them."""
    scores = np.zeros((3, 4, 6)) + np.random.default_rng(0).normal(size=6)
    scores[:, 2] += 0.5
    assert script.gains(scores) == pytest.approx([0.5] * 3)


def test_luck_is_no_gain(script) -> None:
    scores = np.random.default_rng(1).normal(size=(4000, 16, 8))
    found = script.gains(scores)
    assert abs(found.mean()) < 3.0 * found.std(ddof=1) / np.sqrt(len(found))
    # Chosen and judged by the same noises, the best of sixteen would have 1.77 standard errors.
    same = scores.mean(axis=2).max(axis=1) - scores.mean(axis=2)[:, 0]
    assert same.mean() == pytest.approx(1.77 / np.sqrt(8), rel=0.05)


def test_branches_of_one_noise_and_offset_are_the_same(script, monkeypatch) -> None:
    monkeypatch.setattr(script, "BEFORE_S", 2)
    monkeypatch.setattr(script, "HORIZONS_S", (4,))
    found = script.orders(*script.states(2), np.zeros((2, 3, 3)), 2, 0)
    assert found.shape == (4, 2, 3, 2)
    assert (found[:, :, :1] == found).all()
    assert (found[-1, :, :, 0] != found[-1, :, :, 1]).all()


def test_an_interrupted_command_resumes(script, monkeypatch, tmp_path) -> None:
    for name, value in {"BEFORE_S": 2, "HELD_S": 2, "SKIPPED_S": 1, "OFFSETS": 2}.items():
        monkeypatch.setattr(script, name, value)
    monkeypatch.setattr(script, "HORIZONS_S", (3, 4))
    monkeypatch.setattr(script, "BLOCK", 1)
    whole, parts = tmp_path / "whole.csv", tmp_path / "parts.csv"
    script.main(["--states", "2", "--noises", "2", "--out", str(whole)])
    pd.read_csv(whole).iloc[:2].to_csv(parts, index=False)
    script.main(["--states", "2", "--noises", "2", "--out", str(parts)])
    pd.testing.assert_frame_equal(pd.read_csv(whole), pd.read_csv(parts))
    assert len(pd.read_csv(whole)) == 2 * len(script.SIZES_RAD) * 2
