"""Law: a leader is counted where it is, and each pool and policy has a row."""

import numpy as np
import pandas as pd
import pytest

import flockenv


def test_a_leader_at_the_wall_is_counted_there(script, monkeypatch) -> None:
    monkeypatch.setattr(script, "EPISODE_S", 4.0)
    run = flockenv.simulate(script.flock("wide"), 0, 4.0, sample_hz=script.SAMPLE_HZ)
    at_wall, away = (script.motion(run, np.hypot(*run.pose[..., :2].T).max() + d) for d in (0.1, 9))
    assert at_wall["at_wall"] >= away["at_wall"]
    assert away["at_wall"] == 0.0
    assert away["velocity_cm_s"] == pytest.approx(at_wall["velocity_cm_s"])


def test_a_short_run(script, tmp_path, monkeypatch) -> None:
    (tmp_path / "pictures").mkdir()
    for name, value in {"EPISODES": 2, "EPISODE_S": 130.0, "FOLDER": tmp_path}.items():
        monkeypatch.setattr(script, name, value)
    script.main()
    found = pd.read_csv(tmp_path / "results" / "motion.csv")
    assert found["policy"].tolist() == [*script.POLICIES, *script.POLICIES[:2]]
    assert found[["at_wall", "beside_wall", "beside_leader"]].stack().between(0.0, 1.0).all()
    assert (tmp_path / "pictures" / "tracks-wide.png").exists()
    path = tmp_path / "results" / "motion.csv"
    before = path.read_bytes()
    path.write_bytes(b"".join(before.splitlines(keepends=True)[:-1]))
    made = []
    leaders = script.leaders
    monkeypatch.setattr(script, "leaders", lambda *run: made.append(run) or leaders(*run))
    script.main()
    assert path.read_bytes() == before
    assert [run for run in made if run[0] == "narrow"] == [
        ("narrow", script.POLICIES[1], seed) for seed in range(2)
    ]
