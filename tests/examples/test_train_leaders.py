"""Law: the example trains, saves, compares and draws; a small budget takes seconds."""

import runpy
from pathlib import Path

import pytest
from matplotlib import pyplot
from matplotlib.image import imread

from flockenv.policies import LeaningLaw, load

pytest.importorskip("stable_baselines3")

EXAMPLE = Path(__file__).parents[2] / "examples" / "train_leaders.py"


def test_it_trains_compares_and_draws(tmp_path, monkeypatch, capsys):
    assert len(EXAMPLE.read_text(encoding="utf-8").splitlines()) <= 40
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", [str(EXAMPLE), "3", "17", "2"])
    pyplot.switch_backend("agg")
    try:
        runpy.run_path(str(EXAMPLE))
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
