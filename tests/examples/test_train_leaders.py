"""Law: the example trains, saves, compares and draws, with the settings of `flockenv train`."""

import runpy
from pathlib import Path

import pytest
from matplotlib import pyplot
from matplotlib.image import imread

from flockenv.policies import LeaningLaw, load

pytest.importorskip("stable_baselines3")

from flockenv.training.ppo import TrainingSettings

EXAMPLE = Path(__file__).parents[2] / "examples" / "train_leaders.py"


def test_it_trains_compares_and_draws(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", [str(EXAMPLE), "3", "17", "2"])
    pyplot.switch_backend("agg")
    try:
        run = runpy.run_path(str(EXAMPLE))
    finally:
        pyplot.close("all")
    folder = tmp_path / "results" / "train_leaders" / "3"
    law = load(folder / "policy.json")
    assert isinstance(law, LeaningLaw)
    # Something was learned in two rollouts: the weights of an untrained lean have a norm of 0.01.
    assert 0.02 < max(map(abs, law.weights.values())) < 1.0
    printed = capsys.readouterr().out
    assert all(name in printed for name in ("paper's law", "tuned law", "mine"))
    assert imread(folder / "curve.png")[..., :3].min() < 0.5
    _has_the_settings_of_the_command(run)


def _has_the_settings_of_the_command(run):
    own, command = run["Settings"](), TrainingSettings()
    assert (own.seed, own.flock_hours) == (command.seed, command.flock_hours)
    envs = run["environment"](run["Task"]()), command.venv()
    found, expected = ({**each._batch.settings, "flocks": each.num_flocks} for each in envs)
    assert found == expected
    assert envs[0].slots[0].parameters == envs[1].slots[0].parameters
    models = run["untrained"](run["Learner"](), envs[0], own.seed), command.model(envs[1])
    for name in ("n_steps", "batch_size", "n_epochs", "gamma", "gae_lambda", "seed", "use_sde"):
        assert getattr(models[0], name) == getattr(models[1], name), name
    assert models[0].policy_kwargs == models[1].policy_kwargs
    assert not any(each.policy.log_std.requires_grad for each in models)
    for left in (1.0, 0.5, 0.0):
        rates = [each.lr_schedule(left) for each in models]
        assert rates[0] == pytest.approx(rates[1], abs=1e-12)
