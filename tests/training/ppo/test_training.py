"""Law: a training that was killed resumes from its last checkpoint, to the same samples."""

import json
import zipfile
from pathlib import Path

import numpy as np
import pytest
import torch
from stable_baselines3 import PPO

from flockenv import InUseError, ParameterError
from flockenv.runs.seeds import POLICY_SEEDS
from flockenv.sb3 import LeaderVecEnv
from flockenv.training import ppo
from flockenv.training.ppo import Progress, TrainingError, TrainingSettings


class Killed(BaseException):
    """Stands for a kill: nothing catches it."""


def killed_after(samples: int):
    def report(progress: Progress) -> None:
        if progress.samples == samples:
            raise Killed

    return report


def weights(model: PPO) -> np.ndarray:
    return np.concatenate(
        [each.detach().numpy().ravel() for each in model.policy.state_dict().values()]
    )


def test_the_same_settings_train_the_same_leaders(tiny: TrainingSettings, tmp_path: Path) -> None:
    first = ppo.train(tiny, tmp_path / "first")
    again = ppo.train(tiny, tmp_path / "again")
    other = ppo.train(tiny.replace(seed=1), tmp_path / "other")
    np.testing.assert_array_equal(weights(first), weights(again))
    assert (weights(first) != weights(other)).any()
    assert first.num_timesteps == tiny.samples(tiny.venv())


def test_a_killed_training_goes_on(tiny: TrainingSettings, tmp_path: Path) -> None:
    with pytest.raises(Killed):
        ppo.train(tiny, tmp_path, killed_after(64))
    with pytest.raises(ParameterError, match="holds a run already: resume it"):
        ppo.train(tiny, tmp_path)
    stored = PPO.load(tmp_path / "checkpoint.zip", device="cpu")
    seen: list[int] = []
    model = ppo.resume(tmp_path, report=lambda progress: seen.append(progress.samples))
    assert seen[0] == stored.num_timesteps == 64
    assert model.num_timesteps == seen[-1] == 192
    # It starts from what was stored, and learns.
    assert (weights(model) != weights(stored)).any()
    more = ppo.resume(tmp_path, flock_hours=2 * tiny.flock_hours)
    assert more.num_timesteps == 384
    # Each of the flocks' episodes stands once in the files of the three parts, two of them whole.
    curve = ppo.learning_curve(tmp_path, decisions_hz=0.5, points=2)
    assert list(3600 * curve["flock_hours"]) == [192.0, 384.0]


def test_resuming_reads_weights_and_the_optimizer(tiny: TrainingSettings, tmp_path: Path) -> None:
    model = ppo.train(tiny, tmp_path)
    again = ppo.resume(tmp_path)
    np.testing.assert_array_equal(weights(again), weights(model))
    for own, other in zip(
        model.policy.optimizer.state_dict()["state"].values(),
        again.policy.optimizer.state_dict()["state"].values(),
        strict=True,
    ):
        assert torch.equal(own["exp_avg"], other["exp_avg"])


@pytest.mark.parametrize("content", [b"", b"no archive"])
def test_damaged_checkpoints(tiny: TrainingSettings, tmp_path: Path, content: bytes) -> None:
    ppo.train(tiny, tmp_path)
    (tmp_path / "checkpoint.zip").write_bytes(content)
    with pytest.raises(ParameterError, match="is not a checkpoint of these settings"):
        ppo.resume(tmp_path)


def say_in_checkpoint(path: Path, data: bytes) -> None:
    """Let a checkpoint say other things of itself, beside the same weights."""
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in {**parts, "data": data}.items():
            archive.writestr(name, content)


def test_resuming_executes_nothing_in_a_checkpoint(tiny: TrainingSettings, tmp_path: Path) -> None:
    # Without the objects that stable-baselines3 pickles: only weights and a number are read.
    ppo.train(tiny, tmp_path)
    data = b'{"num_timesteps": 192, "policy_class": {":serialized:": "not to be read"}}'
    say_in_checkpoint(tmp_path / "checkpoint.zip", data)
    assert ppo.resume(tmp_path).num_timesteps == 192


@pytest.mark.parametrize("samples", [-5, -192, 7, 64.0, True, "192", None, [192]])
def test_a_checkpoint_after_no_whole_rollouts_is_refused(tiny, tmp_path, samples) -> None:
    ppo.train(tiny, tmp_path)
    data = json.dumps({"num_timesteps": samples}).encode()
    say_in_checkpoint(tmp_path / "checkpoint.zip", data)
    before = sorted(each.name for each in tmp_path.iterdir())
    with pytest.raises(ParameterError, match="are not a whole number of rollouts"):
        ppo.resume(tmp_path)
    assert sorted(each.name for each in tmp_path.iterdir()) == before


def noted(method, given):
    """The same method, which takes note of what it is given."""

    def called(self, seed=None):
        given.append(seed)
        return method(self, seed)

    return called


def test_a_resumed_training_meets_other_flocks(tiny, tmp_path, monkeypatch) -> None:
    """And explores otherwise: the seeds of flocks and of PPO go on with the rollouts."""
    flocks, own = [], []
    for kind, name, given in ((LeaderVecEnv, "seed", flocks), (PPO, "set_random_seed", own)):
        monkeypatch.setattr(kind, name, noted(getattr(kind, name), given))
    ppo.train(tiny, tmp_path)
    trained, own[:] = [each for each in flocks if each is not None][-1], own[-1:]
    flocks.clear()
    ppo.resume(tmp_path, flock_hours=2 * tiny.flock_hours)
    resumed = [each for each in flocks if each is not None][-1]
    first = POLICY_SEEDS["training"].seeds(1, tiny.seed)[0]
    # Three rollouts of two flocks each.
    assert (trained, resumed) == (first, first + 3 * 2)
    assert own[-1] == own[0] + 3


def test_resuming_removes_what_a_killed_training_left(tiny, tmp_path) -> None:
    ppo.train(tiny, tmp_path)
    (tmp_path / ".0123456789abcdef.tmp").write_bytes(b"half a checkpoint")
    ppo.resume(tmp_path)
    assert not [each for each in tmp_path.iterdir() if each.suffix == ".tmp"]


def test_a_checkpoint_of_other_settings_is_refused(tiny: TrainingSettings, tmp_path: Path) -> None:
    ppo.train(tiny, tmp_path)
    policy = {"policy_kwargs": {"net_arch": {"pi": [], "vf": [16]}}}
    (tmp_path / "settings.toml").write_text(tiny.replace(ppo={**tiny.ppo, **policy}).to_toml())
    with pytest.raises(ParameterError, match="is not a checkpoint of these settings"):
        ppo.resume(tmp_path)
    with pytest.raises(ParameterError, match="holds no checkpoint to resume"):
        ppo.resume(tmp_path / "nowhere")


def test_a_folder_takes_one_training_at_a_time(tiny: TrainingSettings, tmp_path: Path) -> None:
    def meanwhile(progress: Progress) -> None:
        for start in (ppo.resume, lambda folder: ppo.train(tiny.replace(seed=9), folder)):
            with pytest.raises(InUseError, match="is in use by another process"):
                start(tmp_path)

    ppo.train(tiny, tmp_path, meanwhile)
    assert TrainingSettings.from_file(tmp_path / "settings.toml") == tiny
    # The file stays, so that no two hold different ones of its name; it holds nobody up.
    assert (tmp_path / ".lock").exists()
    ppo.resume(tmp_path, report=meanwhile)
    (tmp_path / ".lock").unlink()
    (tmp_path / ".lock").mkdir()
    with pytest.raises(TrainingError, match="cannot be locked"):
        ppo.resume(tmp_path)


def test_weights_of_nan_end_the_training(tiny: TrainingSettings, tmp_path: Path) -> None:
    def spoil(progress: Progress) -> None:
        if progress.samples == 128:
            model.policy.action_net.weight.data.fill_(torch.nan)

    model = tiny.model(tiny.venv())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(TrainingSettings, "model", lambda self, venv: model)
        with pytest.raises(TrainingError, match=r"not finite after .* last good checkpoint"):
            ppo.train(tiny, tmp_path, spoil)
    stored = PPO.load(tmp_path / "checkpoint.zip", device="cpu")
    assert np.isfinite(weights(stored)).all()


def test_a_full_disk_is_named(
    tiny: TrainingSettings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(path: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("flockenv.training.ppo.run.atomic_write", full)
    with pytest.raises(TrainingError, match=r"No space left .* there is no checkpoint yet"):
        ppo.train(tiny, tmp_path)
