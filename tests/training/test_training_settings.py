"""Law: settings survive TOML, and nonsense is refused in words before anything runs."""

import re
from pathlib import Path

import pytest

from flockenv import ParameterError
from flockenv.runs.seeds import FIRST_TRAINING_SEED
from flockenv.training import TrainingSettings
from flockenv.training.pools import PooledVecEnv


def test_toml_round_trip(tiny: TrainingSettings) -> None:
    for settings in (
        TrainingSettings(),
        tiny,
        tiny.replace(observation={"order": False}),
        tiny.replace(flock_hours=0.5, critic_arch=[], encoder="deepsets"),
    ):
        assert TrainingSettings.from_toml(settings.to_toml()) == settings


ROOT = Path(__file__).parents[2]
COMMITTED = [
    *ROOT.glob("baselines/ppo_*.toml"),
    *ROOT.glob("docs/training/*.toml"),
    *ROOT.glob("docs/training/*/*.toml"),
]


@pytest.mark.parametrize("path", COMMITTED, ids=lambda path: str(path.relative_to(ROOT)))
def test_committed_settings_are_accepted(path: Path) -> None:
    assert TrainingSettings.from_toml(path.read_text()).flock_hours is not None


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"learning_rte": 1e-3}, "did you mean 'learning_rate'"),
        ({"foo": 1}, "'foo' is no setting of the training: there are preset"),
        ({"samples": 10**400}, "samples = 1000"),
        ({"learning_rate": -1.0}, "learning_rate = -1.0"),
        ({"learning_rate": float("nan")}, "learning_rate = nan"),
        ({"samples": 1.5}, "samples = 1.5"),
        ({"samples": True}, "samples = True"),
        ({"n_leaders": []}, "n_leaders"),
        ({"n_leaders": [0]}, "n_leaders"),
        ({"n_leaders": [30]}, "n_leaders"),
        ({"noise": [1.0]}, "noise"),
        ({"noise": [1.0, 0.5]}, "lowest, highest"),
        ({"pools": ["bath", "narrow"]}, "bath"),
        ({"preset": "simulatoin"}, "simulation"),
        ({"reward": {"order": 1.0}}, "order"),
        ({"reward": 1.0}, "a table"),
        ({"options": {"delay": 1}}, "delay"),
        ({"options": {"delay_frames": "one"}}, "delay_frames must be an integer, not 'one'"),
        ({"observation": {"neighbors": "a"}}, "observation neighbors must be an integer"),
        ({"options": {"rudder_levels": 3}}, "rudder_levels"),
        ({"options": {"episode_s": 3.0}}, "another setting"),
        ({"activation": "gelu"}, "tanh"),
        ({"use_sde": 1}, "true or false"),
        ({"shared_noise_s": 0.7}, "shared_noise_s: hold_s = 0.7"),
        ({"start": 3}, "a text"),
        ({"batch_size": 77}, "samples of a rollout"),
        ({"device": "tpu"}, "auto"),
        (
            {"encoder": "attention"},
            "not accepted: none, deepsets, leaning",
        ),
        ({"encoder": "deepsets", "observation": {"neighbors": 0}}, "needs the block neighbors"),
        ({"encoder": "leaning", "observation": {"neighbors": 0}}, "blocks own, neighbors and"),
        ({"encoder": "leaning", "mirror_to_target": False}, "without mirror_to_target"),
        ({"encoder_arch": []}, "encoder_arch = [] is not accepted"),
        ({"average": 0.0}, "average = 0.0"),
        ({"average": 1.5}, "average = 1.5"),
        ({"flock_hours": 0.0}, "flock_hours = 0.0"),
        ({"flock_hours": -1.0}, "flock_hours = -1.0"),
        ({"flock_hours": 1.0, "samples": 100}, "flock_hours = 1.0 is not accepted with samples"),
        ({"validate_from": 1.5}, "validate_from = 1.5"),
        ({"learn_log_std": 0}, "true or false"),
    ],
)
def test_nonsense_is_refused(tiny: TrainingSettings, change: dict, words: str) -> None:
    with pytest.raises(ParameterError, match=re.escape(words)):
        tiny.replace(**change)


def test_the_batch_must_divide_a_rollout(tiny: TrainingSettings) -> None:
    # Two pools, two flocks with one and two leaders, 32 steps.
    assert tiny.leaders == 6
    assert tiny.rollout_samples == 192


def test_the_learning_rate_falls_with_the_samples(tiny: TrainingSettings) -> None:
    settings = tiny.replace(samples=100, learning_rate=0.3, final_learning_rate=0.1)
    assert settings.learning_rate_at(0) == 0.3
    assert settings.learning_rate_at(50) == pytest.approx(0.2)
    assert settings.learning_rate_at(500) == pytest.approx(0.1)


def test_flock_hours_are_the_time_that_all_flocks_take(tiny: TrainingSettings) -> None:
    # Four flocks with six leaders decide twice a second: 24 samples in 0.5 s of each flock.
    assert tiny.flock_hours_at(6 * 7200) == pytest.approx(4.0)
    settings = tiny.replace(flock_hours=4.0)
    assert settings.samples is None
    assert settings.total_samples == 6 * 7200
    assert settings.learning_rate_at(3 * 7200) == settings.learning_rate
    assert settings.replace(samples=100).total_samples == 100
    held = tiny.replace(flock_hours=4.0, options={"decision_period_s": 2.0})
    assert held.total_samples == 6 * 1800
    assert TrainingSettings().total_samples == 2_000_000


def test_decisions_once_a_motor_cycle(tiny: TrainingSettings) -> None:
    # 2 s forward, 0.31 s backward and 1 s of drift after each, at two control steps per second.
    options = {"decision_period_cycles": 1.0}
    cycled = tiny.replace(pools=["wide"], noise=[1.0, 1.0], batch_size=32, options=options)
    assert cycled.decisions["decision_period_s"] == 4.5
    assert cycled.decisions_hz == pytest.approx(1 / 4.5)
    with pytest.raises(ParameterError, match="not accepted with a drawn bw_s"):
        tiny.replace(options=options)
    with pytest.raises(ParameterError, match="motor cycles differ between pools"):
        tiny.replace(noise=[1.0, 1.0], control_hz=10.0, validation_hz=10.0, options=options)


def test_seeds_are_training_seeds_and_differ(tiny: TrainingSettings) -> None:
    seeds: list[int] = []
    for number in range(3):
        env = PooledVecEnv(tiny.replace(seed=number))
        env.reset()
        episodes = env.env_method("episode")
        reported = [int(episode["flock_seed"]) for episode in episodes]
        seeds += reported
        assert min(reported) >= FIRST_TRAINING_SEED
        # 1 and 2 leaders in the flocks of each pool: six slots of four flocks.
        assert len(set(reported)) == 4
    assert len(set(seeds)) == 12


def test_one_leader_of_two_boats(tiny: TrainingSettings) -> None:
    assert tiny.replace(n_boats=2, n_leaders=[1]).leaders == 4
