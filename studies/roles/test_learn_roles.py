"""Law: each leader of a pair steers by its own numbers, and all searches are written and judged."""

import numpy as np
import pandas as pd
import pytest

from flockenv.envs.observation import observation_entries
from flockenv.policies import DampedLaw


def test_each_leader_steers_by_its_own_law(script):
    numbers = np.array([1.0, 0.0, 0.0, 0.0, -1.0, 0.5, 0.0, 0.0])
    seen = np.random.default_rng(1).uniform(-1, 1, (3, 2 * len(observation_entries())))
    seen = seen.astype(np.float32)
    rudders, _ = script.Pair.of(numbers).predict(seen)
    first, second = np.split(seen, 2, axis=1)
    told = np.where([each.block == "target" for each in observation_entries()], -1.0, 1.0)
    gains = {"gain": 1.91, "backward_gain": 1.91, "damping": 6.0}  # to three digits
    want = [
        DampedLaw(**gains).predict(first)[0],
        DampedLaw(**gains | {"gain": 3.15}).predict((second * told).astype(np.float32))[0],
    ]
    np.testing.assert_allclose(rudders, np.concatenate(want, axis=1))


def test_all_seeds_are_judged(script, tmp_path):
    small = ["--seeds", "2", "--generations", "1", "--flocks", "2", "--minutes", "0.1"]
    script.main([*small, "--judged", "2", "--out", str(tmp_path)])
    reached = pd.read_csv(tmp_path / "reached.csv")
    assert list(reached["seed"]) == ["by hand", "0", "1"]
    curve = pd.read_csv(tmp_path / "curve-0.csv")
    assert curve["flock_hours"].item() == pytest.approx(10 * 2 * 0.1 / 60.0, rel=1e-3)
