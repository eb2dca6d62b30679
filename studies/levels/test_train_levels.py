"""Law: a training is made once, and what it writes is an entry that the suite takes."""

import pytest

from flockenv.comparison.suite_entry import SuiteEntry
from studies.levels.level_curves import HOURS, ORDER, POINTS

pytest.importorskip("torch")
pytest.importorskip("sb3_contrib")


@pytest.mark.parametrize("algorithm", ["trpo", "a2c", "sac", "evolution", "branches"])
def test_a_training_is_made_once_and_entered(script, algorithm, tmp_path) -> None:
    hours = 1.1  # A generation of the evolution strategy.
    given = ["--algorithms", algorithm, "--flock-hours", f"{hours}", "--entries", str(tmp_path)]
    script.main([*given, "--seeds", "1"])
    (path,) = (each for each in tmp_path.glob("*/order-easy-1.*"))
    first = path.read_bytes()
    script.main([*given, "--seeds", "1", "0"])
    assert path.read_bytes() == first
    entry = SuiteEntry.from_file(tmp_path / f"{algorithm}-1.1.toml")
    names = [each.given.rpartition("/")[2] for each in entry.trainings["order-easy"]]
    assert names == [f"order-easy-0{path.suffix}", path.name]
    assert hours / 2 < entry.flock_hours < 2 * hours
    provenance = entry.trainings["order-easy"][1].provenance
    assert provenance["seed"] == "1"
    # So short a training is a few steps long, and its curve has no more points than steps.
    looked, orders = (provenance[name].split() for name in (HOURS, ORDER))
    assert 2 <= len(looked) == len(orders) <= POINTS
    assert float(looked[-1]) == pytest.approx(entry.flock_hours, rel=1e-4)
    assert f"--algorithms {algorithm}" in provenance["command"]
