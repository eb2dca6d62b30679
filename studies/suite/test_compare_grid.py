"""Law: what differs by more than its scatter is found, and equal algorithms are not told apart."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from flockenv.runs.store import RESULTS_VERSION
from studies.store import version_of


def trainings(*algorithms: float, seed: int = 0) -> pd.DataFrame:
    """Five seeds with each of three inputs; an input moves all algorithms."""
    random = np.random.default_rng(seed)
    return pd.DataFrame(
        {
            "algorithm": f"a{place}",
            "input": f"i{named}",
            "iqm": mean + 0.3 * named + 0.02 * random.normal(),
        }
        for place, mean in enumerate(algorithms)
        for named in range(3)
        for _ in range(5)
    )


def test_f_is_that_of_the_analysis_of_variance(script) -> None:
    found = trainings(0.0, 0.1, 0.2)
    f = script.f_statistic(found["iqm"].to_numpy(), found["algorithm"].to_numpy(str))
    groups = [own["iqm"] for _, own in found.groupby("algorithm")]
    assert f == pytest.approx(stats.f_oneway(*groups).statistic)


def test_inputs_do_not_hide_what_algorithms_do(script, monkeypatch) -> None:
    """Inputs move the scores by 0.3 to 0.6, the better algorithm by 0.05."""
    monkeypatch.setattr(script, "PERMUTATIONS", 999)
    found = script.pairs(trainings(0.0, 0.05, 0.0))
    first = found.iloc[0]
    assert first["better"] == "a1"
    assert first["difference"] == pytest.approx(0.05, abs=0.02)
    assert (found["p"] < 0.01).tolist() == [True, True, False]
    assert (found["p_of_all_pairs"] >= found["p"]).all()


def test_equal_algorithms_are_told_apart_as_often_as_chance_says(script, monkeypatch) -> None:
    monkeypatch.setattr(script, "PERMUTATIONS", 199)
    found = [
        script.permuted(trainings(0.0, 0.0, seed=seed), script.difference)[1] for seed in range(60)
    ]
    # Binomial with n = 60 and 0.05: 9 or more has a chance of 3e-3.
    assert sum(p <= 0.05 for p in found) < 9


def test_holm_is_known_on_paper(script) -> None:
    corrected = script.holm(np.array([0.03, 0.01, 0.04]))
    assert corrected == pytest.approx([0.06, 0.03, 0.06])


def test_tables_have_the_version_of_their_grid(script, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(script, "PERMUTATIONS", 9)
    grid, version = tmp_path / "grid.csv", RESULTS_VERSION - 1
    found = trainings(0.0, 0.1).assign(seed=0, results_version=version)
    found.to_csv(grid, index=False)
    script.main(["--grid", str(grid)])
    assert [version_of(tmp_path / f"grid-{name}.csv") for name in ("algorithms", "pairs")] == [
        version
    ] * 2
