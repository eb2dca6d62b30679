"""Law: settings survive their file; what neither environment nor PPO takes is refused by name."""

from pathlib import Path

import pytest

from flockenv import ParameterError
from flockenv.training.ppo import TrainingSettings


def test_settings_survive_their_file(tiny: TrainingSettings, tmp_path: Path) -> None:
    (tmp_path / "settings.toml").write_text(tiny.to_toml())
    assert TrainingSettings.from_file(tmp_path / "settings.toml") == tiny
    assert tiny.replace(seed=7).seed == 7


def test_flock_hours_count_every_flock(tiny: TrainingSettings) -> None:
    # 48 decisions of two leaders in each of two flocks.
    assert tiny.samples(tiny.venv()) == 48 * 4
    fine = tiny.replace(environment={**tiny.environment, "decision_period_s": 0.5})
    assert fine.samples(fine.venv()) == 2 * 48 * 4


def test_changes_reach_the_environment_and_ppo(tiny: TrainingSettings) -> None:
    changed = tiny.replace(pool="narrow", ppo={**tiny.ppo, "gamma": 0.5, "use_sde": False})
    venv = changed.venv()
    model = changed.model(venv)
    assert (model.gamma, model.use_sde, model.n_steps) == (0.5, False, 16)
    assert venv.slots[0].parameters.n_boats == 6
    assert venv.slots[0].parameters.pool == "narrow"
    assert not model.policy.log_std.requires_grad


def test_leaders_are_compared_in_flocks_of_their_training(tiny: TrainingSettings) -> None:
    """The physics of the training and its number of boats; a drawn noise has no single value."""
    flocks = tiny.held_out()
    trained = tiny.venv().slots[0].parameters
    assert (flocks.dt_s, flocks.tolerance_cm) == (trained.dt_s, trained.tolerance_cm)
    assert (flocks.n_boats, flocks.bw_s, flocks.pool) == (6, trained.bw_s, trained.pool)
    changed = tiny.replace(environment={**tiny.environment, "bw_s": 0.2, "c4": 0.05})
    assert (changed.held_out().bw_s, changed.held_out().c4) == (0.2, 0.05)
    drawn = tiny.replace(environment={"bw_s": (0.1, 0.4), "n_leaders": [1, 2]})
    assert drawn.held_out().bw_s == trained.bw_s


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"pool": "500-boats"}, "pool = '500-boats' is not accepted: wide or narrow"),
        ({"flock_hours": 0.0}, "flock_hours = 0.0 is not accepted"),
        ({"flock_hours": "many"}, "flock_hours = 'many' is not accepted"),
        ({"seed": -1}, "seed = -1 is not accepted"),
        ({"pool": ["wide"]}, "pool = ['wide'] is not accepted"),
        ({"flock_hours": True}, "flock_hours = True is not accepted"),
        ({"n_leader": 3}, "did you mean 'n_leaders'"),
        ({"environment": 3}, "environment = 3 is not a table"),
        ({"ppo": {"gama": 0.9}}, "'gama' is not an option of PPO: did you mean 'gamma'"),
        ({"environment": {"n_boat": 6}}, "n_boat"),
        ({"n_leaders": 0}, "n_leaders = 0"),
        ({"num_flocks": 0}, "num_flocks = 0"),
        ({"ppo": {"batch_size": 1}}, "PPO refuses its options"),
        ({"ppo": {"policy_kwargs": {"layers": 3}}}, "PPO refuses its options"),
    ],
)
def test_wrong_settings_are_named(changes: dict[str, object], words: str) -> None:
    with pytest.raises(ParameterError) as raised:
        (settings := TrainingSettings.from_dict(changes)).model(settings.venv())
    assert words in str(raised.value)
    with pytest.raises(TypeError, match="seed must be an integer"):
        TrainingSettings(seed="1")
