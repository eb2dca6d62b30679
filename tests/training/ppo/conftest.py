import pytest

pytest.importorskip("stable_baselines3")

from flockenv.training.ppo import TrainingSettings

#: Two flocks with two leaders and three short episodes: three rollouts.
TINY = {
    "n_leaders": 2,
    "num_flocks": 2,
    "flock_hours": 2 * 48 / 3600,
    "environment": {"n_boats": 6, "episode_s": 16.0, "decision_period_s": 1.0},
    "ppo": {"n_steps": 16, "batch_size": 32, "policy_kwargs": {"net_arch": {"pi": [], "vf": [8]}}},
}


@pytest.fixture(scope="session")
def tiny() -> TrainingSettings:
    return TrainingSettings.from_dict(TINY)
