import pytest

pytest.importorskip("stable_baselines3")

from flockenv.training import TrainingSettings

#: Two pools with two flocks each, 1 + 2 leaders: 6 slots; three short episodes in a rollout.
TINY = {
    "n_boats": 6,
    "n_leaders": [1, 2],
    "noise": [0.25, 0.5],
    "episode_s": 5.0,
    "control_hz": 2.0,
    "num_flocks": 2,
    "n_steps": 32,
    "batch_size": 64,
    "n_epochs": 2,
    "net_arch": [8],
    "samples": 4 * 192,
    "checkpoint_every": 1,
    "validate_every": 384,
    "validation_episodes": 2,
    "validation_s": 5.0,
    "validation_hz": 2.0,
    "device": "cpu",
}


@pytest.fixture(scope="session")
def tiny() -> TrainingSettings:
    return TrainingSettings.from_dict(TINY)
