"""Law: the script writes a learning curve from training seeds, scored on held-out flocks."""

import csv

import pytest

pytest.importorskip("stable_baselines3")


def test_a_short_run(script, tmp_path, monkeypatch):
    monkeypatch.setattr(script, "EPISODES", 8)
    monkeypatch.setattr(script, "EARLIER_EPISODES", 4)
    script.main(["--seeds", "3", "--samples", "4096", "--out", str(tmp_path)])
    with (tmp_path / "curve.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["policy"] for row in rows if not row["seed"]] == [*script.LAWS]
    curve = [row for row in rows if row["policy"] == "PPO"]
    # The first point is before the first rollout of 128 decisions of 256 leaders, the last after.
    assert [row["samples"] for row in curve] == ["0", str(128 * 256)]
    assert float(curve[1]["cpu_s"]) > 0.0
    difference = float(curve[1]["signed_order"]) - float(rows[0]["signed_order"])
    assert float(curve[1]["gain"]) == pytest.approx(difference, abs=2e-4)
    for row in rows:
        assert float(row["low"]) < float(row["signed_order"]) < float(row["high"])
