"""Ctrl-C waits until training is between two steps or writes, and is never lost."""

import signal
from pathlib import Path

import pytest

from flockenv import training
from flockenv.training import TrainingSettings, ppo
from flockenv.training.pools import PooledVecEnv


def press() -> None:
    signal.raise_signal(signal.SIGINT)


@pytest.mark.parametrize(("owner", "name"), [(ppo.Learner, "train"), (ppo.Logger, "dump")])
def test_training_finishes_what_must_not_stop_halfway(
    tiny: TrainingSettings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, owner: type, name: str
) -> None:
    whole, calls = getattr(owner, name), []

    def pressed(self, *arguments) -> None:
        press()
        whole(self, *arguments)
        calls.append(name)

    monkeypatch.setattr(owner, name, pressed)
    with pytest.raises(KeyboardInterrupt):
        training.train(tiny, tmp_path)
    assert calls == [name]


def test_a_rollout_is_left_at_its_next_step(
    tiny: TrainingSettings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    steps = []
    step = PooledVecEnv.step_wait

    def pressed(self):
        press()
        steps.append(1)
        return step(self)

    monkeypatch.setattr(PooledVecEnv, "step_wait", pressed)
    with pytest.raises(KeyboardInterrupt):
        training.train(tiny, tmp_path)
    assert len(steps) == 1


def test_an_interrupt_loses_no_whole_rollout(
    tiny: TrainingSettings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ppo.time, "perf_counter", lambda: 0.0)
    seldom = tiny.replace(checkpoint_every=10**9, validate_every=10**9)
    step, steps = PooledVecEnv.step_wait, []

    def pressed(self):
        steps.append(1)
        if len(steps) == 2 * tiny.n_steps + 5:
            press()
        return step(self)

    training.train(seldom, tmp_path / "whole")
    monkeypatch.setattr(PooledVecEnv, "step_wait", pressed)
    with pytest.raises(KeyboardInterrupt):
        training.train(seldom, tmp_path / "pressed")
    found = sorted(path.name for path in (tmp_path / "pressed").glob("*.*"))
    assert found == ["checkpoint.npz", "curve.csv", "last.npz", "settings.toml"]
    assert len((tmp_path / "pressed" / "curve.csv").read_text().splitlines()) == 1 + 2
    samples = []
    training.resume(tmp_path / "pressed", report=lambda progress: samples.append(progress.samples))
    assert samples == [384, 576, 768]
    for name in ("best.npz", "last.npz", "checkpoint.npz", "curve.csv", "validations.csv"):
        whole, pressed_on = (tmp_path / run / name for run in ("whole", "pressed"))
        assert whole.read_bytes() == pressed_on.read_bytes(), name


def test_nothing_waits_for_a_log_whose_writing_was_interrupted(
    tiny: TrainingSettings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("tensorboard")
    closed = []

    def pressed_twice(self, *arguments) -> None:
        press()
        press()

    monkeypatch.setattr(ppo.TensorBoardOutputFormat, "write", pressed_twice)
    monkeypatch.setattr(ppo.TensorBoardOutputFormat, "close", lambda self: closed.append(1))
    with pytest.raises(KeyboardInterrupt):
        training.train(tiny, tmp_path)
    assert closed == []
