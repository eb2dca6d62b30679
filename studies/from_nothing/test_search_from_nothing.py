"""From nothing by CMA-ES: the network steers as candidates do, and the curve ends beside laws."""

import numpy as np
import pandas as pd
import pytest

pytest.importorskip("cmaes")
pytest.importorskip("stable_baselines3")


def test_the_network_steers_as_the_candidate_did(script) -> None:
    rng = np.random.default_rng(4)
    weights = script.of_length(rng.standard_normal((1, 2 * len(script.LEAN_FEATURES) + 2)))
    seen = rng.standard_normal((300, script.LEADERS, len(script.NAMES))).astype(np.float32)
    # Below 2 % of a boat's speed the network's units have not switched.
    seen[:, :, script.FORWARD] = rng.choice([-0.8, -0.02, 0.02, 0.9], seen.shape[:2])
    rudders = [script.steering(weights)(flock.reshape(1, -1))[0] for flock in seen]
    learned = script.network(weights[0], {}).predict(seen.reshape(-1, len(script.NAMES)))[0]
    assert np.max(np.abs(np.ravel(learned) - np.ravel(rudders))) < 2e-3


def test_a_short_run(script, tmp_path, monkeypatch) -> None:
    small = {"GENERATIONS": 2, "JUDGED_EVERY": 1, "CANDIDATES": 4, "JUDGES": (2, 3)}
    for name, value in small.items():
        monkeypatch.setattr(script, name, value)
    monkeypatch.setattr("studies.from_nothing.train_from_nothing.JUDGED_S", 2.0)
    script.search("narrow", 5, tmp_path / "narrow_5")
    judged = list(pd.read_csv(tmp_path / "narrow_5" / "curve.csv")["policy"])
    assert judged[-4:] == ["paper's law", "damped law", "tuned law", "CMA-ES"]
    assert script.NetworkPolicy.load(tmp_path / "narrow_5" / "policy.npz").provenance["seed"] == "5"
