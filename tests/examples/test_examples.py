"""Every example that people copy runs as it stands, with a small budget."""

import json
import runpy
import sys
from pathlib import Path

import pytest

plt = pytest.importorskip("matplotlib.pyplot")
EXAMPLES = Path(__file__).parents[2] / "examples"
SMALL = {
    "compare_policies.py": ["2", "1"],
    "own_reward.py": ["4", "5"],
    "own_order_parameter.py": ["0.5"],
    "own_tracks.py": [],
}


@pytest.fixture(autouse=True)
def _without_a_screen(tmp_path, monkeypatch):
    plt.switch_backend("agg")
    monkeypatch.chdir(tmp_path)
    yield
    plt.close("all")


@pytest.mark.parametrize("name", SMALL)
def test_an_example(name, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(sys, "argv", [name, *SMALL[name]])
    runpy.run_path(str(EXAMPLES / name), run_name="__main__")
    assert capsys.readouterr().out
    made = [path for path in (tmp_path / "results").rglob("*") if path.is_file()]
    assert all(path.stat().st_size > 0 for path in made)
    assert made or name == "own_reward.py"


def test_the_notebook():
    cells = json.loads((EXAMPLES / "order_against_noise.ipynb").read_text())["cells"]
    names: dict[str, object] = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []
            source = "".join(cell["source"])
            source = source.replace("MINUTES = 8", "MINUTES = 0.5").replace("range(6)", "range(2)")
            exec(source, names)  # noqa: S102 - the notebook is ours
    assert names["rotation"].shape == (len(names["NOISES_S"]), 2)
    assert (names["order"] <= 1.0).all()


def test_every_example_is_run():
    found = {path.name for path in EXAMPLES.glob("*.py")}
    assert found == {*SMALL, "train_leaders.py"}
