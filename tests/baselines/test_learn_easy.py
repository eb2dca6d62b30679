"""Law: the script writes a learning curve from training seeds, scored on held-out episodes."""

import csv
import pickle

import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread

from flockenv.runs.executors import local

pytest.importorskip("stable_baselines3")


def test_a_short_run(script, tmp_path, monkeypatch):
    # A thread needs no PyTorch of its own; a process could be given the same task.
    assert pickle.loads(pickle.dumps(script.learn)) is script.learn
    monkeypatch.setattr(script, "joblib", local)
    monkeypatch.setattr(script, "EPISODES", 8)
    script.main(["--seeds", "3", "--samples", "4096", "--out", str(tmp_path)])
    with (tmp_path / "curve.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    references = [row["policy"] for row in rows if not row["seed"]]
    assert references == ["random rudders", "steering law", "damped law"]
    curve = [row for row in rows if row["seed"] == "3"]
    assert [row["samples"] for row in curve] == ["0", "4096"]
    assert float(curve[1]["cpu_s"]) > 0.0
    for row in rows:
        assert float(row["reward_low"]) < float(row["reward"]) < float(row["reward_high"])
    pixels = imread(tmp_path / "curve.png")[..., :3]
    assert (abs(pixels - to_rgb("C0")).max(axis=-1) < 0.02).sum() > 500
