"""Law: critical noises of the core follow from the committed runs, and a scan is whole."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from flockenv import FlockParameters
from flockenv.statistics import critical_noise
from studies.store import Row, StudyError

RESULTS = Path(__file__).parent / "results"


@pytest.mark.parametrize(
    ("file", "preset", "pool"),
    [
        ("critical_noise.csv", "simulation", "wide"),
        ("critical_noise.csv", "paper", "wide"),
        ("critical_noise_experiment.csv", "experiment", "narrow"),
    ],
)
def test_the_core_names_what_was_measured(file: str, preset: str, pool: str) -> None:
    runs = pd.read_csv(RESULTS / file)
    levels = runs[(runs["preset"] == preset) & (runs["pool"] == pool)].groupby("bw_s")
    groups = [own[["psi_o", "rotation"]].to_numpy() for _, own in levels]
    found, _, _ = critical_noise(list(levels.groups), groups)
    assert FlockParameters.critical_bw_s(preset, pool) == pytest.approx(found, abs=0.0051)


def test_a_short_scan(script, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(script.NOISE_S, "simulation", np.array([0.0, 0.3, 0.6]))
    out = tmp_path / "noise.csv"
    arguments = ["--boats", "5", "--seeds", "3", "--minutes", "0.5", "--preset", "simulation"]
    script.main([*arguments, "--pool", "narrow", "--out", str(out)])
    found = pd.read_csv(out)
    assert found[["bw_s", "seed"]].to_numpy().tolist() == [
        [noise, seed] for noise in (0.0, 0.3, 0.6) for seed in range(3)
    ]
    assert found["psi_o"].between(0.0, 1.0).all()


def test_a_scan_goes_on_where_it_ended(
    script, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[tuple[float, int]] = []

    def measure(row: Row) -> Row:
        made.append((row["bw_s"], row["seed"]))
        return {"psi_o": 0.9 - row["bw_s"], "rotation": 0.5}

    monkeypatch.setitem(script.NOISE_S, "simulation", np.array([0.0, 0.3, 0.6]))
    monkeypatch.setattr(script, "order_of_run", measure)
    scan = ["--preset", "simulation", "--pool", "wide", "--out", str(tmp_path / "noise.csv")]
    script.main([*scan, "--seeds", "2"])
    script.main([*scan, "--seeds", "3"])
    again = [(noise, 2) for noise in (0.0, 0.3, 0.6)]
    assert sorted(made[6:]) == again
    # Runs of other flocks are other runs.
    script.main([*scan, "--seeds", "2", "--boats", "5"])
    assert len(made) == 15
    assert len(pd.read_csv(tmp_path / "noise.csv")) == 15


def test_a_scan_leaves_runs_of_other_code(script, tmp_path: Path) -> None:
    for file in RESULTS.glob("*.csv"):
        copied = tmp_path / file.name
        copied.write_bytes(before := file.read_bytes())
        with pytest.raises(StudyError, match="a store of another design"):
            script.main(["--out", str(copied)])
        assert copied.read_bytes() == before
