"""Law: a run that was killed and resumed leaves the same bytes as one that never stopped."""

import errno
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

import flockenv
from flockenv import InUseError, ParameterError, training
from flockenv._io.atomic_write import atomic_write
from flockenv.policies import load
from flockenv.runs.seeds import FIRST_TRAINING_SEED
from flockenv.training import TrainingError, TrainingSettings, checkpoint, ppo, validation
from flockenv.training.actor import network_policy
from flockenv.training.learner import Learner, learner

EVERY_FILE = ("best.npz", "last.npz", "checkpoint.npz", "curve.csv", "validations.csv")


class Killed(BaseException):
    """Stands for a kill: nothing catches it."""


@pytest.fixture(autouse=True)
def no_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wall time is the one thing in the files that two equal runs do not share."""
    monkeypatch.setattr(ppo.time, "perf_counter", lambda: 0.0)


def killed_after(samples: int):
    def report(progress: checkpoint.Progress) -> None:
        if progress.samples == samples:
            raise Killed

    return report


def test_a_folder_takes_one_training_at_a_time(tiny: TrainingSettings, tmp_path: Path) -> None:
    refused = []

    def meanwhile(progress: checkpoint.Progress) -> None:
        with pytest.raises(InUseError, match="is in use by another process") as raised:
            training.resume(tmp_path) if progress.samples else training.train(tiny, tmp_path)
        refused.append(raised)

    training.train(tiny.replace(samples=192), tmp_path, report=meanwhile)
    assert len(refused) == 2
    with pytest.raises(ParameterError, match="holds a run already"):
        training.train(tiny, tmp_path)


@pytest.mark.parametrize(
    "kind",
    [
        {},
        {"use_sde": True, "sde_sample_freq": 4},
        {"critic": "flock"},
        # Not a whole number of rollouts: a noise is held over the end of one.
        {"shared_noise_s": 2.5},
        {"shared_noise_s": 2.5, "critic": "flock"},
        {"shared_noise_s": 2.5, "critic": "flock", "use_sde": True},
        {"encoder": "deepsets", "average": 0.3, "learn_log_std": False},
        {"encoder": "leaning", "average": 0.5, "critic": "flock", "squash": True},
    ],
    ids=lambda kind: " and ".join(kind) or "own noise",
)
def test_resumed_is_uninterrupted(
    tiny: TrainingSettings, tmp_path: Path, kind: dict[str, Any]
) -> None:
    # Checkpoints every other rollout, a kill after the third: one rollout is done again. Lost
    # frames make sure that the camera continues where it was, too.
    settings = tiny.replace(
        checkpoint_every=384,
        validate_every=768,
        final_learning_rate=1e-5,
        options={"dropout_rate": 0.2, "delay_frames": 1},
        **kind,
    )
    training.train(settings, tmp_path / "whole", command="train")
    with pytest.raises(Killed):
        training.train(settings, tmp_path / "killed", command="train", report=killed_after(576))
    torch.manual_seed(99)
    np.random.seed(99)  # noqa: NPY002 - the generator that PPO shuffles with
    result = training.resume(tmp_path / "killed")
    assert result.progress.samples == 768
    for name in EVERY_FILE:
        whole, resumed = (tmp_path / run / name for run in ("whole", "killed"))
        assert whole.read_bytes() == resumed.read_bytes(), name


def test_another_seed_is_another_run(tiny: TrainingSettings, tmp_path: Path) -> None:
    first = training.train(tiny.replace(samples=192), tmp_path / "first")
    other = training.train(tiny.replace(samples=192, seed=1), tmp_path / "other")
    assert first.progress.curve != other.progress.curve


def test_learning_goes_on_past_the_end(tiny: TrainingSettings, tmp_path: Path) -> None:
    training.train(tiny.replace(samples=192), tmp_path)
    assert training.resume(tmp_path).progress.samples == 192
    assert training.resume(tmp_path, samples=384).progress.samples == 384
    assert len((tmp_path / "curve.csv").read_text().splitlines()) == 3


def test_the_average_is_what_is_stored(tiny: TrainingSettings, tmp_path: Path) -> None:
    last, averaged = [], []
    update_average = Learner.update_average

    def watched(model: Learner) -> None:
        update_average(model)
        last.append(network_policy(model.policy, settings, {}).weights)
        averaged.append(network_policy(model.mean_actor(), settings, {}).weights)

    settings = tiny.replace(average=0.25, learn_log_std=False, validate_from=1.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Learner, "update_average", watched)
        result = training.train(settings, tmp_path)
    assert len(last) == 4
    expected = last[0]
    for weights in last[1:]:
        expected = [0.75 * old + 0.25 * new for old, new in zip(expected, weights, strict=True)]
    stored = load(tmp_path / "last.npz")
    for own, other, latest in zip(stored.weights, expected, last[-1], strict=True):
        np.testing.assert_allclose(own, other, atol=1e-6)
        assert abs(own - latest).max() > 1e-5
    # One validation at the end alone, so that nothing is chosen by it.
    assert [row["samples"] for row in result.progress.validations] == [768]
    assert load(tmp_path / "best.npz").digest == stored.digest


def test_a_budget_in_flock_hours(tiny: TrainingSettings, tmp_path: Path) -> None:
    # A rollout is 16 s of four flocks.
    settings = tiny.replace(flock_hours=4 * 16 / 3600)
    result = training.train(settings, tmp_path)
    assert result.progress.samples == 192
    assert result.policy.provenance["flock_hours"] == "0.0177778"
    for name in ("curve.csv", "validations.csv"):
        header, row = (tmp_path / name).read_text().splitlines()
        assert header.startswith("samples,flock_hours,")
        assert row.startswith("192,0.0177778,")
    result = training.resume(tmp_path, flock_hours=8 * 16 / 3600)
    assert result.progress.samples == 384
    assert training.resume(tmp_path, samples=576).progress.samples == 576
    with pytest.raises(ParameterError, match="one or the other"):
        training.resume(tmp_path, samples=768, flock_hours=1.0)


def test_flocks_restart_together(tiny: TrainingSettings) -> None:
    model = learner(tiny.replace(pools=["wide", "narrow"]))
    model.env.reset()
    ended = [model.env.step(np.zeros((6, 1)))[2] for _ in range(30)]
    # Episodes of 5 s with two decisions per second.
    assert [step for step, dones in enumerate(ended, 1) if dones.all()] == [10, 20, 30]
    assert not any(dones.any() for step, dones in enumerate(ended, 1) if step % 10)


def test_a_full_disk_leaves_the_last_checkpoint(
    tiny: TrainingSettings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class FullDisk:
        """Takes the first bytes of a checkpoint's third version, then no more."""

        versions = 0

    def full(path, arrays, **options):
        FullDisk.versions += 1
        if FullDisk.versions < 3:
            return write_arrays(path, arrays, **options)
        with atomic_write(path) as file:
            file.write(b"PK the start")
            raise OSError(errno.ENOSPC, "No space left on device")

    write_arrays = checkpoint.write_arrays
    monkeypatch.setattr(checkpoint, "write_arrays", full)
    with pytest.raises(TrainingError, match=r"No space left.*last good checkpoint is .*npz"):
        training.train(tiny, tmp_path / "full")
    monkeypatch.undo()
    monkeypatch.setattr(ppo.time, "perf_counter", lambda: 0.0)
    assert not list((tmp_path / "full").glob(".*.tmp"))
    training.resume(tmp_path / "full")
    training.train(tiny, tmp_path / "whole")
    for name in EVERY_FILE:
        whole, resumed = (tmp_path / run / name for run in ("whole", "full"))
        assert whole.read_bytes() == resumed.read_bytes(), name


def test_a_loss_that_is_no_number_stops_before_the_next_checkpoint(
    tiny: TrainingSettings, tmp_path: Path
) -> None:
    training.train(tiny.replace(samples=192), tmp_path)
    before = (tmp_path / "checkpoint.npz").read_bytes()

    restore = checkpoint.restore

    def spoiled(path, model):
        progress = restore(path, model)
        with torch.no_grad():
            model.policy.value_net.bias.fill_(math.nan)
        return progress

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(checkpoint, "restore", spoiled)
        with pytest.raises(TrainingError, match=r"loss is nan.*last good checkpoint"):
            training.resume(tmp_path, samples=384)
    assert (tmp_path / "checkpoint.npz").read_bytes() == before
    assert training.resume(tmp_path, samples=384).progress.samples == 384


def test_validations_use_the_same_seeds_and_none_that_claims_are_made_with(
    tiny: TrainingSettings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen = []
    run_episodes = validation.run_episodes

    def watched(parameters, policy, seeds, *arguments, **options):
        seen.append((parameters.pool, parameters.n_leaders, tuple(seeds)))
        return run_episodes(parameters, policy, seeds, *arguments, **options)

    monkeypatch.setattr(validation, "run_episodes", watched)
    training.train(tiny, tmp_path)
    assert seen[:4] == seen[4:]
    assert len(set(seen)) == 4
    seeds = {seed for _, _, each in seen for seed in each}
    assert len(seeds) == tiny.validation_episodes
    # Neither those of evaluations nor those of any training run.
    assert min(seeds) > FIRST_TRAINING_SEED + 2**32 * 2**20


def test_folders_are_not_mixed_up(tiny: TrainingSettings, tmp_path: Path) -> None:
    with pytest.raises(flockenv.ParameterError, match="no checkpoint"):
        training.resume(tmp_path)
    training.train(tiny.replace(samples=192), tmp_path)
    with pytest.raises(flockenv.ParameterError, match="holds a run already"):
        training.train(tiny, tmp_path)


@pytest.mark.parametrize("stored", [0, 100, 5000])
def test_damaged_checkpoints_are_refused(
    tiny: TrainingSettings, tmp_path: Path, stored: int
) -> None:
    training.train(tiny.replace(samples=192), tmp_path)
    path = tmp_path / "checkpoint.npz"
    path.write_bytes(path.read_bytes()[:stored])
    with pytest.raises(flockenv.ParameterError, match=r"checkpoint\.npz"):
        training.resume(tmp_path)


def test_a_policy_is_no_checkpoint(tiny: TrainingSettings, tmp_path: Path) -> None:
    training.train(tiny.replace(samples=192), tmp_path)
    (tmp_path / "best.npz").replace(tmp_path / "checkpoint.npz")
    with pytest.raises(flockenv.ParameterError, match="no checkpoint in the format"):
        training.resume(tmp_path)


def test_a_run_that_is_cut_short_has_its_policy(tiny: TrainingSettings, tmp_path: Path) -> None:
    with pytest.raises(Killed):
        training.train(tiny, tmp_path, report=killed_after(192))
    assert not (tmp_path / "best.npz").exists()
    result = training.resume(tmp_path, samples=192)
    assert result.progress.samples == 192
    assert result.policy.provenance["samples"] == "192"


def test_what_a_run_leaves(tiny: TrainingSettings, tmp_path: Path) -> None:
    result = training.train(tiny, tmp_path, command="the command")
    best = load(tmp_path / "best.npz")
    assert best.provenance["command"] == "the command"
    assert best.provenance["seed"] == "0"
    assert set(best.provenance) >= {"commit", "flockenv", "samples", "wall_s", "validation"}
    assert TrainingSettings.from_toml((tmp_path / "settings.toml").read_text()) == tiny
    rows = result.progress.validations
    assert [row["samples"] for row in rows] == [384, 768]
    cells = {"wide k=1", "wide k=2", "narrow k=1", "narrow k=2"}
    assert set(rows[0]) == {"samples", "mean", *cells}
    assert result.progress.best_score == max(row["mean"] for row in rows)
    assert any((tmp_path / "tensorboard").iterdir())
