"""Law: a fit's files follow from its options, whether it was killed or not, and fit together."""

import numpy as np
import pandas as pd
import pytest

import flockenv
from flockenv.calibration import report as fit_report
from flockenv.calibration.report import Effort
from flockenv.calibration.search import Fit
from flockenv.calibration.surrogate import front_ranks
from flockenv.calibration.targets import MISFITS, SEARCHED_TARGETS, TARGETS

OPTIONS = {
    "free": ("c3", "c4"),
    "pools": ("table-1",),
    "filling_hours": 27.0,
    "flock_hours": 54.0,
    "batch": 12,
}
SMALL = Fit(**OPTIONS)
EFFORT = Effort(repetitions=2, judged=1, held_out=3)


def ignored(words, hours):
    pass


@pytest.fixture
def finished(quick, tmp_path):
    hours = []
    folder = tmp_path / "whole"
    result = fit_report.report(SMALL, EFFORT, folder, lambda words, some: hours.append(some))
    return folder, result, sum(hours)


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*.*")}


def test_a_fit_is_written_and_reported(finished):
    folder, result, hours = finished
    names = {path.name for path in folder.iterdir()}
    assert names == {
        *("fit.toml", "trials.csv", "targets.csv", "front.csv", "front.png", "pairs.csv"),
        *("finalists.csv", "judged.csv", "comparison.csv", "residuals.csv", "parameters.toml"),
        "runs",
    }
    text = (folder / "parameters.toml").read_text(encoding="utf-8")
    assert flockenv.FlockParameters.from_toml(text) == result.parameters
    assert result.parameters.dt_s == flockenv.FlockParameters().dt_s
    assert list(result.residuals["key"]) == [target.key for target in TARGETS]
    assert result.table().row_count == len(TARGETS)
    # The budget bounds what is run.
    parts = EFFORT.flock_hours(SMALL)
    assert 0.8 * sum(parts.values()) < hours <= sum(parts.values()) + 1e-6


def test_a_killed_fit_makes_the_same_files(finished, quick, tmp_path):
    folder, _, _ = finished
    whole = contents(folder)
    # Among space-filling trials, among proposals, and among the runs of finalists.
    for stop in (7, 33, 80):
        again = tmp_path / f"stopped at {stop}"
        steps = iter(range(stop))

        def killed(words, hours, steps=steps):
            if next(steps, None) is None:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            fit_report.report(SMALL, EFFORT, again, killed)
        fit_report.report(SMALL, EFFORT, again, ignored)
        assert contents(again) == whole
    before = next(quick)
    fit_report.report(SMALL, EFFORT, folder, ignored)
    assert next(quick) == before + 1
    assert contents(folder) == whole


def test_the_front_holds_no_trial_that_another_beats(finished):
    folder, _, _ = finished
    front = pd.read_csv(folder / "front.csv")
    assert set(front["pool"]) == set(SMALL.pools)
    for _, own in front.groupby("pool"):
        assert (front_ranks(own[list(MISFITS)].to_numpy(), len(own)) <= 1).all()
    assert len(pd.read_csv(folder / "targets.csv")) == SMALL.trials


def test_a_finalist_is_compared_with_the_start_on_the_same_seeds(finished):
    folder, result, _ = finished
    compared = pd.read_csv(folder / "comparison.csv").set_index("name")
    start = compared.loc["start"]
    assert start[["difference", "difference_low", "difference_high"]].tolist() == [0.0, 0.0, 0.0]
    best = compared.drop("start").iloc[0]
    assert best["difference"] == pytest.approx(best["total"] - start["total"], abs=1e-3)
    assert best["difference_low"] <= best["difference_high"]
    assert best["met"] == result.residuals["in_range"].sum()
    judged = pd.read_csv(folder / "judged.csv")
    assert judged[judged["name"] == "start"]["in_range"].sum() == start["met"]


def test_pairs_are_symmetric_shares_and_correlations(finished):
    folder, _, _ = finished
    pairs = pd.read_csv(folder / "pairs.csv")
    searched = len(SEARCHED_TARGETS)
    assert len(pairs) == len(SMALL.pools) * searched * (searched - 1) // 2
    for column, low in (("correlation", -1.0), ("both", 0.0), ("best", 0.0)):
        known = pairs[column].dropna()
        assert known.between(low, 1.0 + 1e-9).all()
    # Of the quick runs the number of leaders moves every curve by the same.
    assert np.isfinite(pairs["both"]).all()


def test_other_options_are_refused_and_leave_the_folder_alone(finished, monkeypatch):
    folder, _, _ = finished
    before = contents(folder)
    for fit, effort in (
        (Fit(**OPTIONS, seed=1), EFFORT),
        (SMALL, Effort(repetitions=3, judged=1, held_out=3)),
    ):
        with pytest.raises(flockenv.ParameterError, match="has other options or another version"):
            fit_report.report(fit, effort, folder, ignored)
    assert contents(folder) == before
    # Trials of a core whose runs have other numbers are no part of this fit.
    with monkeypatch.context() as patch:
        patch.setattr(fit_report, "RESULTS_VERSION", fit_report.RESULTS_VERSION + 1)
        with pytest.raises(flockenv.ParameterError, match="has other options or another version"):
            fit_report.report(SMALL, EFFORT, folder, ignored)
    assert contents(folder) == before
    # How many runs are made at a time is no other fit.
    fit = Fit(**OPTIONS, jobs=2)
    fit_report.report(fit, EFFORT, folder, ignored)
    assert contents(folder) == before


def test_a_folder_takes_one_fit_at_a_time(quick, tmp_path):
    def meanwhile(words, hours):
        with pytest.raises(flockenv.InUseError, match="is in use by another process"):
            fit_report.report(SMALL, EFFORT, tmp_path, ignored)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fit_report.report(SMALL, EFFORT, tmp_path, meanwhile)


@pytest.mark.parametrize("name", ["repetitions", "judged", "held_out"])
def test_an_effort_of_nothing_is_refused(name):
    with pytest.raises(flockenv.ParameterError, match=name):
        Effort(**{name: 0})
