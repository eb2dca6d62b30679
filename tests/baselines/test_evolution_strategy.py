"""Law: the search climbs, an interrupted one ends as if it had not stopped, and its file steers."""

from pathlib import Path

import numpy as np
import pytest

from flockenv.policies import load

SMALL = ["--pairs", "4", "--episodes", "2", "--flock-hours", str(3 * 8 / 60)]


def test_candidates_steer_by_their_own_weights(script) -> None:
    weights = np.array([[1.0, 0.0, 0.5], [0.0, -2.0, 0.0]])
    seen = np.array([[0.1, 0.2, 0.3, 0.4], [0.1, 0.2, 0.3, 0.4]])
    rudders = script.linear(weights, leaders=2)(seen)
    np.testing.assert_allclose(rudders, [[0.6, 0.8], [-0.4, -0.8]], atol=1e-6)


def test_it_climbs_a_slope_that_is_known(script, monkeypatch: pytest.MonkeyPatch) -> None:
    best = np.array([1.0, -2.0, 0.5])

    class Env:
        num_envs, num_leaders = 32, 1

    def known(env, seeds, steer):
        # `linear` is given the candidates: it hands them on.
        return -np.square(steer - best).sum(axis=1), np.zeros(len(steer))

    monkeypatch.setattr(script, "episode", known)
    monkeypatch.setattr(script, "linear", lambda weights, leaders: weights)
    options = type("Options", (), {})()
    options.__dict__ |= {"seed": 0, "pairs": 16, "sigma": 0.1}
    options.__dict__ |= {"learning_rate": 0.1, "moving_average": 0.1}
    state = script.first_state(3)
    for _ in range(150):
        state = script.next_generation(state, Env(), options)
    np.testing.assert_allclose(state["average"], best, atol=0.15)


def test_an_interrupted_search_ends_as_if_it_had_not_stopped(
    script, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script.main([*SMALL, "--out", str(tmp_path / "whole")])
    generation, calls = script.next_generation, []

    def interrupted(*arguments):
        calls.append(1)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return generation(*arguments)

    monkeypatch.setattr(script, "next_generation", interrupted)
    with pytest.raises(KeyboardInterrupt):
        script.main([*SMALL, "--out", str(tmp_path / "parts")])
    script.main([*SMALL, "--out", str(tmp_path / "parts")])
    whole, parts = (load(tmp_path / name / "policy.npz") for name in ("whole", "parts"))
    np.testing.assert_array_equal(whole.weights[0], parts.weights[0])
    assert np.abs(whole.weights[0]).max() > 0.0
    curves = [(tmp_path / name / "curve.csv").read_bytes() for name in ("whole", "parts")]
    assert curves[0] == curves[1]
    with pytest.raises(SystemExit, match="other options"):
        script.main([*SMALL, "--sigma", "0.5", "--out", str(tmp_path / "parts")])
