"""Every example that people copy runs as it stands, with a small budget."""

import runpy
import sys
from pathlib import Path

import pytest
from PIL import Image

plt = pytest.importorskip("matplotlib.pyplot")
EXAMPLES = Path(__file__).parents[2] / "examples"
SMALL = {
    "compare_policies.py": ["2", "1"],
    "own_reward.py": ["4", "5"],
    "own_order_parameter.py": ["0.5"],
    "own_tracks.py": [],
    "train_with_pettingzoo.py": ["1"],
    "train_with_torchrl.py": ["1"],
}


@pytest.fixture(autouse=True)
def _without_a_screen(tmp_path, monkeypatch):
    plt.switch_backend("agg")
    monkeypatch.chdir(tmp_path)
    yield
    plt.close("all")


@pytest.mark.parametrize("name", SMALL)
def test_an_example(name, monkeypatch, tmp_path, capsys):
    if name == "train_with_torchrl.py":
        pytest.importorskip("torchrl")
    if name == "train_with_pettingzoo.py":
        pytest.importorskip("torch")
        if not hasattr(pytest.importorskip("pettingzoo"), "register"):
            pytest.skip("PettingZoo has no ids")
    monkeypatch.setattr(sys, "argv", [name, *SMALL[name]])
    runpy.run_path(str(EXAMPLES / name), run_name="__main__")
    assert capsys.readouterr().out
    made = [path for path in (tmp_path / "results").rglob("*") if path.is_file()]
    assert all(path.stat().st_size > 0 for path in made)
    assert made or name == "own_reward.py"


def test_the_notebook_on_noise(run_notebook):
    names = run_notebook("order_against_noise.ipynb", MINUTES="0.5", SEEDS="range(0, 2)")
    assert names["rotation"].shape == (len(names["NOISES_S"]), 2)
    assert (names["order"] <= 1.0).all()


def test_the_notebook_on_training(run_notebook, tmp_path):
    pytest.importorskip("stable_baselines3")
    pytest.importorskip("IPython")
    names = run_notebook("train_compare_film.ipynb", DECISIONS="1", FLOCKS="2")
    assert names["model"].num_timesteps == 128 * 4 * 64
    assert [*names["means"].index] == ["mine", "damped law", "paper's law"]
    with Image.open(tmp_path / "film.gif") as film:
        assert (film.size, film.n_frames) == ((600, 300), len(names["times_s"]))


def test_the_notebook_on_gymnasium(run_notebook):
    names = run_notebook("with_gymnasium.ipynb", FLOCKS="2")
    assert names["orders"].shape == (2,)
    assert names["orders"][0] == names["summary"]["signed_order"]


def test_the_notebook_on_pettingzoo(run_notebook):
    """Rivals earn opposite signed orders; only the random one's rudder costs it something."""
    rewards = run_notebook("with_pettingzoo.ipynb")["rewards"]
    left = rewards[:, 1] + rewards[:, 2]
    assert -0.05 - 1e-6 <= left.min() <= left.max() <= 1e-6
    assert left.mean() < -0.01


def test_the_notebook_on_torchrl(run_notebook):
    pytest.importorskip("torchrl")
    names = run_notebook("with_torchrl.ipynb", FLOCKS="8", UPDATES="300")
    assert names["loss"].item() < 0.1 * names["shown"].var().item()


def test_every_example_is_run():
    found = {path.name for path in EXAMPLES.glob("*.py")}
    elsewhere = {"train_leaders.py", "train_with_rllib.py"}
    assert found == {*SMALL, *elsewhere}
    notebooks = {path.name for path in EXAMPLES.glob("*.ipynb")}
    # Those of RLlib and BenchMARL run beside their other tests, with the versions that they pin.
    names = ("gymnasium", "pettingzoo", "torchrl", "rllib", "benchmarl")
    interfaces = {f"with_{name}.ipynb" for name in names}
    assert notebooks == {"order_against_noise.ipynb", "train_compare_film.ipynb", *interfaces}
