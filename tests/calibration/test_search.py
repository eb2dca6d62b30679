"""Law: a fit is a function of its options; interrupted, it continues as if it had not been."""

import itertools

import numpy as np
import pytest

import flockenv
from flockenv.calibration import report as fit_report
from flockenv.calibration import search as experiment_fit
from flockenv.calibration.search import BOUNDS, Fit, Trial, surface_minimum
from flockenv.calibration.targets import NOISE_S, TARGETS


@pytest.fixture
def quick(monkeypatch):
    """Replace 8-minute runs by a formula; count them."""
    calls = itertools.count()

    def run_flock(parameters, seed):
        next(calls)
        noise = np.random.default_rng(seed).normal(0, 0.01)
        middle = 1.4 + 0.2 * parameters.n_leaders + np.log(parameters.c3 / 0.13)
        psi_o = 0.95 if parameters.bw_s < middle else 0.2
        return [psi_o + noise, psi_o, 0.7, 0.0, 0.05, 0.7]

    monkeypatch.setattr(experiment_fit, "run_flock", run_flock)
    return calls


def test_the_same_options_give_the_same_log_byte_for_byte(quick, tmp_path):
    fit = Fit(trials=25, seeds=2)
    logs = [tmp_path / name for name in ("a.csv", "b.csv")]
    for log in logs:
        assert len(list(fit.search(log))) >= 25
    assert logs[0].read_bytes() == logs[1].read_bytes()
    other = tmp_path / "other.csv"
    list(Fit(trials=25, seeds=2, seed=1).search(other))
    assert other.read_bytes() != logs[0].read_bytes()


def test_an_interrupted_search_goes_on_from_its_log(quick, tmp_path):
    fit = Fit(trials=25, seeds=2)
    whole, cut = tmp_path / "whole.csv", tmp_path / "cut.csv"
    uninterrupted = list(fit.search(whole))
    list(itertools.islice(fit.search(cut), 7))
    before = next(quick)
    resumed = list(fit.search(cut))
    assert cut.read_bytes() == whole.read_bytes()
    # NaN, of trials without flocks, equals itself in words only.
    assert repr(resumed) == repr(uninterrupted)
    # Nothing that the log holds is run again.
    list(fit.search(cut))
    ran = next(quick) - before
    most = (len(resumed) - 7) * 2 * sum(map(len, NOISE_S.values()))
    assert 0 < ran <= most + 2


def test_a_log_of_another_fit_is_refused_and_left_alone(quick, tmp_path):
    log = tmp_path / "trials.csv"
    list(Fit(trials=11, seeds=1).search(log))
    before = log.read_bytes()
    for other in (Fit(trials=11, seeds=1, seed=3), Fit(free=("c1", "c2"), trials=11, seeds=1)):
        with pytest.raises(flockenv.ParameterError, match=str(log)):
            list(other.search(log))
    assert log.read_bytes() == before
    log.write_bytes(before[: len(before) - 40])
    with pytest.raises(flockenv.ParameterError, match="line 12"):
        list(Fit(trials=11, seeds=1).search(log))


def test_trials_stay_within_the_bounds(quick, tmp_path):
    for trial in Fit(trials=40, seeds=1).search(tmp_path / "trials.csv"):
        for name, value in trial.constants.items():
            low, high = BOUNDS[name]
            assert low <= value <= high


def test_flocks_of_hopeless_boats_are_not_run(quick):
    before = next(quick)
    constants = {"c1": 5.0, "c2": 0.5, "c3": 0.03, "c4": 0.01, "reverse_speed_cm_s": 2.0}
    trial = Fit().trial(constants, range(2))
    assert trial.loss > Fit.HOPELESS
    assert next(quick) == before + 1


def test_a_response_surface_finds_what_lucky_trials_hide():
    rng = np.random.default_rng(3)
    trials = []
    for _ in range(60):
        c3, c1 = np.exp(rng.normal(np.log(0.1), 0.5)), np.exp(rng.normal(np.log(0.3), 0.5))
        values = dict.fromkeys((target.key for target in TARGETS), 0.95)
        values |= {"forward_speed": 15.0, "backing_turn": 1.0, "critical_bw_3": 2.0}
        values |= {"high_noise_0": 0.2, "high_noise_3": 0.2, "off_tangent": 0.1}
        values |= {"backing_speed": 0.2}
        values["critical_bw_0"] = 1.4 + np.log(c3 / 0.15) + rng.normal(0, 0.2)
        trials.append(Trial({"c1": c1, "c3": c3}, values, 0.0))
    (found,) = surface_minimum(trials)
    assert found["c3"] == pytest.approx(0.15, rel=0.15)
    assert surface_minimum(trials[:10]) == []


def test_a_fit_is_written_and_reported(quick, tmp_path):
    steps = []
    fit = Fit(trials=22, seeds=1, finalists=2)
    result = fit_report.report(fit, 4, tmp_path, lambda words, count: steps.append(count))
    # The response surface needs more trials with flocks than there may be here.
    assert fit_report.work(fit, 4) - 1 <= sum(steps) <= fit_report.work(fit, 4)
    names = {"fit.toml", "trials.csv", "parameters.toml", "residuals.csv"}
    assert {path.name for path in tmp_path.iterdir()} == names
    text = (tmp_path / "parameters.toml").read_text(encoding="utf-8")
    assert flockenv.FlockParameters.from_toml(text) == result.parameters
    assert result.residuals["best_seen"].notna().all()
    assert result.table().row_count == len(result.residuals)


def test_a_folder_takes_one_fit_at_a_time(quick, tmp_path):
    refused = []

    def meanwhile(words, count):
        with pytest.raises(flockenv.InUseError, match="is in use by another process"):
            fit_report.report(fit, 4, tmp_path, lambda words, count: None)
        refused.append(words)

    fit = Fit(trials=2, seeds=1, finalists=1)
    fit_report.report(fit, 4, tmp_path, meanwhile)
    assert refused
    names = {"fit.toml", "trials.csv", "parameters.toml", "residuals.csv"}
    assert {path.name for path in tmp_path.iterdir()} == names


@pytest.mark.parametrize(
    "options",
    [
        {"free": ("c9",)},
        {"free": ()},
        {"only": ("beauty",)},
        {"trials": 0},
        {"seeds": 0},
        {"finalists": 0},
        {"jobs": 0},
        {"seed": -1},
        {"seed": 2**32},
    ],
)
def test_options_out_of_range_are_refused_by_name(options):
    with pytest.raises(flockenv.ParameterError, match=next(iter(options))):
        Fit(**options)


def test_an_unknown_constant_is_refused_with_the_nearest() -> None:
    with pytest.raises(flockenv.ParameterError, match="did you mean 'reverse_speed_cm_s'"):
        Fit(free=("reverse_speed",))
