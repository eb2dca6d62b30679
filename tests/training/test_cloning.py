"""Law: a clone steers as its law does, on states that it was not fitted to."""

from pathlib import Path

import numpy as np
import pytest
from stable_baselines3 import PPO

from flockenv import LeadersEnv, ParameterError
from flockenv.policies import DampedLaw, LeaningLaw, SignCorrectedLaw, load
from flockenv.sb3 import LeaderVecEnv
from flockenv.training import TrainingSettings, clone_law, train


def test_a_clone_is_much_nearer_than_going_straight(tiny: TrainingSettings) -> None:
    settings = tiny.replace(net_arch=[32, 32])
    law = DampedLaw(mirror_to_target=True)
    clone = clone_law(law, settings, samples=12_000, epochs=15)
    # Its rudders have a root mean square of 0.9: they are at an end most of the time.
    assert float(clone.provenance["clone_rms"]) < 0.4
    assert clone.provenance["cloned"].startswith("DampedLaw")


def test_the_same_seed_clones_the_same_bits(tiny: TrainingSettings) -> None:
    law = DampedLaw(mirror_to_target=True)
    once, again = (clone_law(law, tiny, samples=600, epochs=2) for _ in range(2))
    for own, other in zip(once.weights, again.weights, strict=True):
        np.testing.assert_array_equal(own, other)


@pytest.mark.usefixtures("_quick_clones")
def test_a_run_starts_from_a_clone_of_a_leaning_law(tiny: TrainingSettings, tmp_path: Path) -> None:
    gains = {"gain": 1.0, "backward_gain": 2.0, "damping": 9.0}
    LeaningLaw(gains, 0.1, {"near": 0.2}).save(tmp_path / "law.npz")
    settings = tiny.replace(start=str(tmp_path / "law.npz"), samples=192)
    train(settings, tmp_path / "run")
    start = load(tmp_path / "run" / "start.npz")
    assert start.provenance["cloned"].startswith("LeaningLaw")
    assert [matrix.shape[1] for matrix in start.weights] == [8, 1]


@pytest.mark.parametrize("encoder", ["deepsets", "leaning"])
@pytest.mark.usefixtures("_quick_clones")
def test_a_clone_has_the_encoder_of_the_settings(
    tiny: TrainingSettings, tmp_path: Path, encoder: str
) -> None:
    settings = tiny.replace(start="damped law", samples=192, encoder=encoder, squash=True)
    train(settings, tmp_path)
    start = load(tmp_path / "start.npz")
    assert start.encoder.kind == encoder
    assert start.squashed
    # The measured means, not the zeros that an extractor starts with.
    assert encoder != "leaning" or start.encoder.mean.any()


@pytest.mark.usefixtures("_quick_clones")
def test_a_run_starts_from_a_trusted_model(tiny: TrainingSettings, tmp_path: Path) -> None:
    path = tmp_path / "model.zip"
    env = LeaderVecEnv(2, n_boats=6, n_leaders=2, mirror_to_target=True)
    PPO("MlpPolicy", env, n_steps=8, batch_size=8, device="cpu").save(path)
    settings = tiny.replace(start=str(path), samples=192)
    with pytest.raises(ParameterError, match="on the command line --trust"):
        train(settings, tmp_path / "run")
    assert not (tmp_path / "run").exists()
    train(settings, tmp_path / "run", trust=True)
    start = load(tmp_path / "run" / "start.npz")
    assert start.provenance["cloned"].startswith("ModelPolicy(model.zip")


def test_a_model_of_two_leaders_at_once_is_no_start_for_one(
    tiny: TrainingSettings, tmp_path: Path
) -> None:
    path = tmp_path / "model.zip"
    env = LeadersEnv(n_boats=6, n_leaders=2, mirror_to_target=True)
    PPO("MlpPolicy", env, n_steps=8, batch_size=8, device="cpu").save(path)
    with pytest.raises(ParameterError, match="n_leaders = 1 is not accepted"):
        train(tiny.replace(start=str(path)), tmp_path / "run", trust=True)


def test_another_layout_is_refused(tiny: TrainingSettings) -> None:
    with pytest.raises(ParameterError, match="layout"):
        clone_law(SignCorrectedLaw(), tiny)
