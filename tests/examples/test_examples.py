"""Every example that people copy runs as it stands, with a small budget."""

import json
import re
import runpy
import sys
from pathlib import Path
from typing import Any

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


def _run(notebook: str, **smaller: str) -> dict[str, Any]:
    """Return the names that a notebook defines if some of them have smaller values."""
    cells = json.loads((EXAMPLES / notebook).read_text())["cells"]
    names: dict[str, Any] = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []
            source = "".join(cell["source"])
            for name, value in smaller.items():
                source = re.sub(rf"^{name} = [^#\n]*", f"{name} = {value}  ", source, flags=re.M)
            exec(source, names)  # noqa: S102 - the notebook is ours
    assert all(f"{names[name]!r}" == value for name, value in smaller.items())
    return names


def test_the_notebook_on_noise():
    names = _run("order_against_noise.ipynb", MINUTES="0.5", SEEDS="range(0, 2)")
    assert names["rotation"].shape == (len(names["NOISES_S"]), 2)
    assert (names["order"] <= 1.0).all()


def test_the_notebook_on_training(tmp_path):
    pytest.importorskip("stable_baselines3")
    pytest.importorskip("IPython")
    names = _run("train_compare_film.ipynb", DECISIONS="1", FLOCKS="2")
    assert names["model"].num_timesteps == 128 * 4 * 64
    assert [*names["means"].index] == ["mine", "damped law", "paper's law"]
    with Image.open(tmp_path / "film.gif") as film:
        assert (film.size, film.n_frames) == ((600, 300), len(names["times_s"]))


def test_the_notebook_on_gymnasium():
    names = _run("with_gymnasium.ipynb", FLOCKS="2")
    assert names["orders"].shape == (2,)
    assert names["orders"][0] == names["summary"]["signed_order"]


def test_the_notebook_on_pettingzoo():
    """Rivals earn opposite signed orders; only the random one's rudder costs it something."""
    rewards = _run("with_pettingzoo.ipynb")["rewards"]
    left = rewards[:, 1] + rewards[:, 2]
    assert -0.05 - 1e-6 <= left.min() <= left.max() <= 1e-6
    assert left.mean() < -0.01


def test_the_notebook_on_torchrl():
    pytest.importorskip("torchrl")
    names = _run("with_torchrl.ipynb", FLOCKS="8", UPDATES="300")
    assert names["loss"].item() < 0.1 * names["shown"].var().item()


def test_every_example_is_run():
    found = {path.name for path in EXAMPLES.glob("*.py")}
    elsewhere = {"train_leaders.py", "train_with_rllib.py"}
    assert found == {*SMALL, *elsewhere}
    notebooks = {path.name for path in EXAMPLES.glob("*.ipynb")}
    interfaces = {f"with_{name}.ipynb" for name in ("gymnasium", "pettingzoo", "torchrl")}
    assert notebooks == {"order_against_noise.ipynb", "train_compare_film.ipynb", *interfaces}
