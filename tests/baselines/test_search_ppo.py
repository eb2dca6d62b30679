"""The search of PPO's settings: what it draws, prunes, stores and resumes from."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from flockenv.policies.pretrained import tuned_law

pytest.importorskip("stable_baselines3")
optuna = pytest.importorskip("optuna")

from flockenv.training import TrainingSettings  # noqa: E402 - after the check for its extra

#: Two flocks for 96 s each, in rollouts of 48 s.
QUICK = ["--flock-hours", str(2 * 96 / 3600), "--rungs", "2", "--episodes", "2", "--quiet"]


@pytest.fixture(autouse=True)
def _short(script, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(script, "ROLLOUT_S", 48.0)
    for name, value in {
        "num_flocks": 2,
        "n_boats": 8,
        "episode_s": 20.0,
        "critic_arch": [8],
        "validation_s": 20.0,
        "validation_hz": 2.0,
        "device": "cpu",
    }.items():
        monkeypatch.setitem(script.SHARED, name, value)


def searched(script, folder: Path, trials: int) -> pd.DataFrame:
    script.main([*QUICK, "--trials", str(trials), "--out", str(folder)])
    return pd.read_csv(folder / "search.csv", keep_default_na=False)


def test_a_table_of_trials_with_the_best_ones_settings(script, tmp_path: Path) -> None:
    table = searched(script, tmp_path, 3)
    assert list(table["trial"]) == [0, 1, 2]
    complete = table[table["state"] == "complete"]
    assert len(complete) >= 1
    assert (table["low"].astype(float) <= table["difference"].astype(float)).all()
    assert (table["high"].astype(float) >= table["difference"].astype(float)).all()
    winner = complete.loc[complete["difference"].astype(float).idxmax()]
    best = TrainingSettings.from_toml((tmp_path / "best.toml").read_text())
    assert best.encoder == winner["encoder"]
    assert best.learning_rate == pytest.approx(float(winner["learning_rate"]), rel=0.01)
    assert best.options["decision_period_s"] == float(winner["decision_s"])
    assert np.exp(best.log_std_init) == pytest.approx(float(winner["deviation"]), rel=0.01)
    with pytest.raises(SystemExit, match="of another search"):
        script.main([*QUICK, "--trials", "3", "--seed", "1", "--out", str(tmp_path)])


def test_pools_that_are_not_accepted_leave_nothing(script, tmp_path: Path) -> None:
    for wrong in (["--pools", "bath"], ["--leaders", "9"], ["--flock-hours", "0"]):
        with pytest.raises(SystemExit, match=r"^Error: .* is not accepted"):
            script.main([*QUICK, *wrong, "--out", str(tmp_path / "search")])
    assert not (tmp_path / "search").exists()


def test_trials_that_all_diverge_leave_the_table_and_no_settings(
    script, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def diverges(*arguments, **options):
        raise script.training.TrainingError("the loss is nan")

    monkeypatch.setattr(script.training, "train", diverges)
    with pytest.raises(SystemExit, match=r"^Error: none of 2 trials was trained to its end"):
        script.main([*QUICK, "--trials", "2", "--out", str(tmp_path)])
    assert list(pd.read_csv(tmp_path / "search.csv")["state"]) == ["fail", "fail"]
    assert not (tmp_path / "best.toml").exists()


class Killed(BaseException):
    """Stands for a kill: nothing catches it."""


def killed_at(call: int, function: Callable) -> Callable:
    """Return a function that is killed when it is called for the n-th time."""
    left = [call]

    def counted(*arguments, **options):
        left[0] -= 1
        if left[0] == 0:
            raise Killed
        return function(*arguments, **options)

    return counted


def test_a_killed_search_ends_with_the_same_bytes(
    script, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    searched(script, tmp_path / "whole", 3)
    # Before the second comparison of the second trial, then before the third trial's training.
    for owner, name, call in ((script, "mean_interval", 4), (script.training, "train", 1)):
        with monkeypatch.context() as patch:
            patch.setattr(owner, name, killed_at(call, getattr(owner, name)))
            with pytest.raises(Killed):
                searched(script, tmp_path / "killed", 3)
    searched(script, tmp_path / "killed", 3)
    for name in ("search.csv", "best.toml"):
        whole, killed = (tmp_path / run / name for run in ("whole", "killed"))
        assert whole.read_bytes() == killed.read_bytes(), name


def finished(differences: list[float]) -> object:
    study = optuna.create_study(direction="maximize")
    steps = dict(enumerate(differences, 1))
    study.add_trial(optuna.trial.create_trial(value=differences[-1], intermediate_values=steps))
    return study


@pytest.mark.parametrize(
    ("high", "pruned"), [(0.019, True), (0.021, False)], ids=["below", "not below"]
)
def test_pruned_where_even_the_upper_end_is_below_the_best(script, high, pruned) -> None:
    study = finished([0.02, 0.05])
    trial = SimpleNamespace(last_step=1, user_attrs={"high 1": high})
    assert script.BelowTheBest().prune(study, trial) == pruned
    # Nothing is finished yet.
    assert not script.BelowTheBest().prune(optuna.create_study(), trial)


def test_every_setting_makes_a_training(script) -> None:
    options = SimpleNamespace(pools=["wide"], leaders=[1, 3], flock_hours=1.0, seed=0, rungs=4)
    ends = {
        name: each.choices if hasattr(each, "choices") else (each.low, each.high)
        for name, each in script.SPACE.items()
    }
    for place in range(12):
        values = {name: each[place % len(each)] for name, each in ends.items()}
        settings = script.settings_of(values, options)
        assert settings.flock_hours_at(settings.total_samples) == pytest.approx(1.0, rel=0.01)
        assert settings.rollout_samples == 8 * settings.batch_size


def test_the_law_is_the_lean_of_zero(script) -> None:
    options = SimpleNamespace(pools=["narrow"], leaders=[2], flock_hours=1.0, seed=0, rungs=1)
    values = {"learning_rate": 1e-3, "deviation": 0.5, "hold_s": 8.0, "horizon_s": 100.0}
    values |= {"lambda_4s": 0.9, "decision_s": 4.0, "encoder": "none", "net_arch": ""}
    settings = script.settings_of(values, options)
    found = script.orders(lambda pool: tuned_law("damped law", pool), settings, 2)
    assert found.shape == (2,)
