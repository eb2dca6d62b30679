"""Law: trainings with several seeds are judged in the same held-out flocks, and are resumable."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from flockenv import ParameterError
from flockenv.runs.seeds import FIRST_TRAINING_SEED
from flockenv.statistics.intervals import mean_interval
from flockenv.training import TrainingSettings, ppo, seeds, train_seeds

FILES = ("learning_curves.csv", "learning_curves.png", "episodes.csv", "evaluation.csv")


@pytest.fixture(autouse=True)
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(seeds, "_EPISODE_S", 5.0)
    monkeypatch.setattr(ppo.time, "perf_counter", lambda: 0.0)


@pytest.fixture(scope="module")
def short(tiny: TrainingSettings) -> TrainingSettings:
    return tiny.replace(
        pools=["narrow"], n_leaders=[2], batch_size=32, samples=256, validate_every=128
    )


def test_the_tables(short: TrainingSettings, tmp_path: Path) -> None:
    result = train_seeds(short, tmp_path, 2, episodes=4)
    assert [each.settings.seed for each in result.trainings] == [0, 1]
    orders = pd.read_csv(tmp_path / "episodes.csv")
    assert set(orders["policy"]) == {"seed 0", "seed 1", *seeds.RIVALS}
    assert (orders["seed"] < FIRST_TRAINING_SEED).all()
    of_policy = {
        name: part.sort_values("seed")["signed_order"].to_numpy()
        for name, part in orders.groupby("policy")
    }
    assert {len(each) for each in of_policy.values()} == {4}
    found = result.evaluation.set_index(["policy", "minus"])
    own, law = of_policy["seed 1"], of_policy["tuned damped law"]
    columns = ["signed_order", "low", "high"]
    expected = mean_interval(own - law)
    assert found.loc[("seed 1", "tuned damped law"), columns].tolist() == pytest.approx(expected)
    both = np.stack([of_policy["seed 0"], own]) - law
    every = found.loc[("all seeds", "tuned damped law"), columns]
    assert every["signed_order"] == pytest.approx(both.mean())
    assert every["low"] < both.mean() < every["high"]
    curves = result.curves
    own_curves = dict(list(curves[curves["policy"] == "seed 1"].groupby("flocks")))
    assert list(own_curves["validation"]["samples"]) == [128, 256]
    stored = pd.read_csv(tmp_path / "seed-1" / "curve.csv")
    assert list(own_curves["training"]["samples"]) == list(stored["samples"])
    assert own_curves["training"]["mean"].tolist() == pytest.approx(
        stored["signed_order"].tolist(), nan_ok=True
    )
    hours = short.flock_hours_at(256)
    assert curves["flock_hours"].max() == pytest.approx(hours, rel=1e-5)
    assert curves[curves["policy"] == "damped law"]["flock_hours"].isna().all()


def test_the_same_command_resumes(
    short: TrainingSettings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = train_seeds(short, tmp_path / "whole", 2, episodes=2)

    class Killed(BaseException):
        """Stands for a kill: nothing catches it."""

    def in_the_second_training(words: str, done: float) -> None:
        if done > 0.6:
            raise Killed

    def in_the_evaluation(words: str, done: float) -> None:
        if words.startswith("damped law in"):
            raise Killed

    for report in (in_the_second_training, in_the_evaluation):
        with pytest.raises(Killed):
            train_seeds(short, tmp_path / "killed", 2, episodes=2, report=report)
    reported = []
    train_seeds(
        short, tmp_path / "killed", 2, episodes=2, report=lambda words, _: reported.append(words)
    )
    # The evaluations of the trained policies were finished.
    assert [words for words in reported if " in " in words] == [
        f"{name} in narrow k=2" for name in seeds.RIVALS
    ]
    for name in FILES:
        first, again = (tmp_path / run / name for run in ("whole", "killed"))
        assert first.read_bytes() == again.read_bytes(), name
    # More samples continue the trainings, and judge what came out again.
    longer = train_seeds(short.replace(samples=384), tmp_path / "killed", 2, episodes=2)
    assert longer.trainings[1].progress.samples == 384
    assert whole.trainings[1].progress.samples == 256


def test_what_is_refused(short: TrainingSettings, tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match="seeds = 0 is not accepted: at least 1"):
        train_seeds(short, tmp_path, 0)
    with pytest.raises(ParameterError, match="episodes = 1 is not accepted: at least 2"):
        train_seeds(short, tmp_path, 1, episodes=1)
    with pytest.raises(ParameterError, match="seed = 4294967296 is not accepted"):
        train_seeds(short.replace(seed=2**32 - 1), tmp_path, 2)
    assert not any(tmp_path.iterdir())
    last = short.replace(samples=64, seed=1)
    train_seeds(last, tmp_path, 1, episodes=2)
    with pytest.raises(ParameterError, match="seed-1 holds a run of other settings"):
        train_seeds(last.replace(gamma=0.5, seed=0), tmp_path, 2, episodes=2)
    assert not (tmp_path / "seed-0").exists()
