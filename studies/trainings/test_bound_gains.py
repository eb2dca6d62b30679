"""Law: without scores in each flock, the interval of a mean gain is a bound of the drawn one."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from flockenv.statistics import mean_interval, two_way_interval

RESULTS = Path(__file__).parent / "results"


@pytest.mark.parametrize(("shared", "wider"), [(1.0, 1.0), (0.5, 1.2), (0.0, 1.5)])
def test_a_bound_is_as_wide_as_the_drawn_interval_or_wider(script, shared, wider):
    """Trainings that differ by 0.02, in flocks whose luck they share as a part of its variance."""
    random = np.random.default_rng(7)
    seeds = 0.02 * random.normal(size=(6, 1))
    common, own = random.normal(size=(1, 400)), random.normal(size=(6, 400))
    scores = seeds + 0.5 * (shared**0.5 * common + (1 - shared) ** 0.5 * own)
    rows = [
        dict(zip(("gain", "gain_low", "gain_high"), mean_interval(s), strict=True)) for s in scores
    ]
    mean, low, high = script.bound(pd.DataFrame(rows))
    drawn = two_way_interval(scores)
    assert mean == pytest.approx(drawn[0])
    assert (high - low) / (drawn[2] - drawn[1]) == pytest.approx(wider, rel=0.12)


@pytest.mark.parametrize("path", sorted(RESULTS.glob("*/algorithms*.csv")), ids=str)
def test_committed_bounds_follow_from_the_trainings(script, path):
    table = pd.read_csv(path)
    found = pd.read_csv(path.with_name(path.name.replace("algorithms", "evaluation")))
    again = script.bounded(table, found)
    assert set(table["interval"]) == {script.BOUND}
    for end in ("gain_low", "gain_high"):
        assert table[end].to_numpy() == pytest.approx(again[end].to_numpy(), abs=6e-5)
