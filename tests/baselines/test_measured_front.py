"""The measured front: which trials are measured again, and what is written of them."""

import numpy as np
import pandas as pd
import pytest

from flockenv.calibration.flock_runs import QUANTITIES, FlockRuns
from flockenv.calibration.targets import MISFITS, TARGETS


@pytest.fixture(scope="module")
def trials(script) -> pd.DataFrame:
    return pd.read_csv(script.TRIALS)


def test_both_targets_in_range_and_the_least_misfits_are_chosen(script, trials) -> None:
    found = script.chosen(trials)
    both = trials["critical_bw_0"].between(1.3, 1.5) & trials["critical_bw_3"].between(1.9, 2.1)
    assert set(trials.index[both]) <= set(found.index)
    for pool in ("table-1", "500-boats"):
        count = (found["pool"] == pool).sum()
        assert count >= script.LEAST_TOTAL
    assert len(found) < len(trials) / 10
    assert found.index.is_monotonic_increasing


def test_a_trial_has_its_own_constants_and_the_steps_of_trials(script, trials) -> None:
    trial = trials.iloc[7]
    parameters = script.parameters_of(trial)
    assert parameters.c1 == trial["c1"]
    assert parameters.pool == trial["pool"]
    assert (parameters.dt_s, parameters.relinearizations) == (0.1, 1)


def test_runs_become_rows_with_intervals_and_a_front(script, trials, monkeypatch, tmp_path) -> None:
    shape = (len(script.JUDGED.cells), 4, len(QUANTITIES))
    rng = np.random.default_rng(0)
    runs = [FlockRuns(script.JUDGED, rng.uniform(0.2, 0.4, shape)) for _ in range(3)]
    left = iter(runs)
    monkeypatch.setattr(script, "stored_runs", lambda *_: next(left))
    table = script.measured([trials.iloc[k] for k in range(3)], [1], 1, tmp_path, "first")
    assert (table["repetitions"] == 4).all()
    for name in (*MISFITS, *(target.key for target in TARGETS if target.value)):
        known = table[table[f"{name}_low"].notna()]
        assert (known[f"{name}_low"] <= known[f"{name}_high"]).all()
    worse = [
        any(
            (table.loc[other, list(MISFITS)] <= table.loc[place, list(MISFITS)]).all()
            for other in table.index
            if other != place
        )
        for place in table.index
    ]
    assert table["front"].tolist() == [not each for each in worse]
