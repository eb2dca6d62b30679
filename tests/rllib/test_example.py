"""Law: the example and the notebook of RLlib train leaders whom every command takes.

It pins an older gymnasium: `make test-rllib`.
"""

import runpy
import sys
from pathlib import Path

import pytest

import flockenv

pytestmark = [
    pytest.mark.rllib,
    pytest.mark.timeout(900),
    # RLlib's own use of libraries that have moved on.
    pytest.mark.filterwarnings("ignore"),
]

pytest.importorskip("ray")
EXAMPLE = Path(__file__).parents[2] / "examples/train_with_rllib.py"


def test_the_example_saves_a_policy(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [EXAMPLE.name, "1"])
    runpy.run_path(str(EXAMPLE), run_name="__main__")
    assert "1 iterations" in capsys.readouterr().out
    flockenv.policies.load(tmp_path / "results/train_with_rllib/policy.npz")


def test_the_notebook_trains_and_judges(run_notebook, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = run_notebook("with_rllib.ipynb", FLOCKS="16", ITERATIONS="1", JUDGED="4")
    assert {name: each.shape for name, each in names["orders"].items()} == {
        "no lean": (4,),
        "learned": (4,),
    }
    assert (names["orders"]["learned"] != names["orders"]["no lean"]).any()
    flockenv.policies.load(tmp_path / "policy.npz")
