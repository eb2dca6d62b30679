"""Law: the sign of z says whether a reward grows along the direction, and chance gives none."""

import csv

import numpy as np
import pytest

from flockenv.policies import LeaningLaw


def found_with(random, slope: float, flocks: int = 400, leaders: int = 2, steps: int = 30):
    """Made-up episodes: the reward is `slope` times the score, and noise."""
    scores = random.standard_normal((steps, flocks * leaders))
    reward = slope * scores + random.standard_normal(scores.shape)
    inputs = random.standard_normal((*scores.shape, 3))
    return {"scores": scores, "inputs": inputs, "signed_order": reward}


def test_the_gradient_of_a_known_reward(script) -> None:
    random, gamma = np.random.default_rng(0), 0.5
    for slope in (0.7, -0.7):
        values = script.estimates(found_with(random, slope), "signed_order", gamma, 2)
        # Of each of 30 decisions of two leaders, 1 - gamma of its own reward.
        assert values.mean() == pytest.approx(30 * 2 * 0.5 * slope, rel=0.1)
    values = script.estimates(found_with(random, 0.0), "signed_order", gamma, 2)
    z, error = script.significance(values, samples=1_000_000)
    assert abs(z) < 3.0
    assert error == pytest.approx(1.0, abs=0.02)


def test_z_is_scaled_to_a_million_samples(script) -> None:
    values = np.random.default_rng(1).standard_normal(1000) + 0.1
    z, error = script.significance(values, samples=1_000_000)
    quarter, its_error = script.significance(values, samples=250_000)
    assert (quarter, its_error) == (pytest.approx(2 * z), pytest.approx(2 * error))


def test_it_measures_a_velocity_that_a_law_raises(script, tmp_path) -> None:
    out = tmp_path / "signals.csv"
    script.main(["--flocks", "16", "--minutes", "1", "--horizon", "8", "--out", str(out)])
    with out.open(newline="") as file:
        found = {row["reward"]: row for row in csv.DictReader(file)}
    assert set(found) == set(script.REWARDS)
    assert {row["samples"] for row in found.values()} == {str(16 * 3 * 60 * 5)}
    assert all(np.isfinite(float(row["z_per_million"])) for row in found.values())
    leans = ["--action-mode", "lean", "--shared", "--hold-s", "2", "--flocks", "4"]
    script.main([*leans, "--minutes", "0.2", "--out", str(out)])
    # Towards a policy that observes lean features alone and decides every two seconds.
    LeaningLaw("narrow", 0.1, {}, decision_period_s=2.0).save(tmp_path / "policy.json")
    script.main(
        [*leans, "--to", str(tmp_path / "policy.json"), "--minutes", "0.2", "--out", str(out)]
    )
    with out.open(newline="") as file:
        assert {row["samples"] for row in csv.DictReader(file)} == {str(4 * 3 * 6)}


def test_odd_numbers_of_flocks_are_refused(script, capsys) -> None:
    with pytest.raises(SystemExit):
        script.main(["--flocks", "5"])
    assert "--flocks is even" in capsys.readouterr().err
