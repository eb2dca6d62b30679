"""Law: the policy is the mean of the trainings of all seeds, and a training is not made twice."""

import pytest

from flockenv.policies import load


def test_the_mean_of_all_seeds_is_written(script, tmp_path, monkeypatch):
    small = ["--flock-hours", "1.5", "--flocks", "8", "--out", str(tmp_path)]
    script.main(small)
    laws = [load(tmp_path / str(seed) / "policy.json") for seed in script.SEEDS]
    assert len({law.bias for law in laws}) == len(laws)
    mean = load(tmp_path / "mean.json")
    assert mean.bias == pytest.approx(sum(law.bias for law in laws) / len(laws))
    hours = [float(law.provenance["flock_hours"]) for law in laws]
    assert float(mean.provenance["flock_hours"]) == pytest.approx(sum(hours))
    assert mean.provenance["seed"] == "0, 1, 2"
    monkeypatch.setattr(script, "trained", None)  # It is not called.
    script.main(small)
    assert load(tmp_path / "mean.json").weights == mean.weights
