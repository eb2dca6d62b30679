"""Means have intervals that hold, and the straight line is the one of least squares.

On paper: y = 1, 2, 2 at x = 0, 1, 2 has slope 1/2, intercept 7/6, F = 3 and p = 1/3.
"""

import numpy as np
import pandas as pd
import pytest

from flockenv.statistics.intervals import (
    crossed_replicates,
    fit_line,
    interval,
    mean_interval,
    paired_difference,
    summarize,
)


def test_a_line_through_three_points() -> None:
    line = fit_line([0, 1, 2], [1, 2, 2])
    assert line.slope == pytest.approx(1 / 2)
    assert line.intercept == pytest.approx(7 / 6)
    # Residual sum of squares 1/6 with one degree of freedom, explained 1/2.
    assert line.f == pytest.approx(3)
    # The F distribution with 1 and 1 degrees of freedom: p = 1 - (2/π)·atan(sqrt(F)).
    assert line.p == pytest.approx(1 - 2 / np.pi * np.arctan(np.sqrt(3)))
    assert line.n == 3


def test_points_on_a_line_leave_no_doubt() -> None:
    line = fit_line(range(5), [3 - 2 * x for x in range(5)])
    assert (line.slope, line.intercept) == pytest.approx((-2, 3))
    assert line.f > 1e12
    assert line.p < 1e-12


def test_equal_values_have_no_line() -> None:
    line = fit_line(range(5), [0.25] * 5)
    assert (line.slope, line.intercept, line.n) == (0.0, 0.25, 5)
    assert np.isnan([line.f, line.p]).all()
    assert str(line) == "0.250 in all 5 runs: no line to fit"


@pytest.mark.parametrize(("x", "y"), [([1, 2], [1, 2]), ([1, 1, 1], [1, 2, 3])])
def test_too_little_for_a_line_is_refused(x: list[float], y: list[float]) -> None:
    with pytest.raises(ValueError, match="three points at two different x"):
        fit_line(x, y)


def test_the_interval_covers_the_mean_as_often_as_it_says() -> None:
    rng = np.random.default_rng(1)
    covered = 0
    for _ in range(60):
        mean, low, high = mean_interval(rng.normal(2.0, 1.0, 40))
        assert low < mean < high
        covered += low <= 2.0 <= high
    # Binomial with n = 60 and 0.95: 49 or fewer has a chance of about 1e-4.
    assert covered >= 50


def test_intervals_of_one_value_and_of_equal_values() -> None:
    mean, low, high = mean_interval([3.0])
    assert mean == 3.0
    assert np.isnan([low, high]).all()
    assert mean_interval([2.0, 2.0, 2.0]) == (2.0, 2.0, 2.0)


def test_groups_keep_their_order_and_their_own_means() -> None:
    runs = pd.DataFrame({"policy": list("bbaa"), "k": [1, 1, 0, 0], "psi_o": [1.0, 3.0, 5.0, 9.0]})
    means = summarize(runs, ["policy", "k"], ["psi_o"])
    assert means["policy"].tolist() == ["b", "a"]
    assert means["psi_o"].tolist() == [2.0, 7.0]
    assert means["runs"].tolist() == [2, 2]
    assert list(means) == ["policy", "k", "runs", "psi_o", "psi_o_low", "psi_o_high"]


def test_pairs_are_compared_seed_by_seed() -> None:
    theirs = np.array([0.0, 10.0, -5.0, 3.0])
    found = paired_difference(theirs + np.array([1.0, 2.0, 3.0, 2.0]), theirs)
    assert found.mean == pytest.approx(2.0)
    assert found.effect == pytest.approx(2.0 / np.sqrt(2.0 / 3.0))
    assert 1.0 <= found.low < 2.0 < found.high <= 3.0
    same = paired_difference(theirs, theirs)
    assert (same.mean, same.low, same.high, same.n) == (0.0, 0.0, 0.0, 4)
    assert np.isnan(same.effect)
    with pytest.raises(ValueError, match="3 and 2"):
        paired_difference([1, 2, 3], [1, 2])


def test_ratios_stand_where_what_divides_is_above_zero() -> None:
    random = np.random.default_rng(0)
    theirs = random.normal(0.4, 0.2, 400)
    ours = 1.5 * theirs + random.normal(0.0, 0.05, 400)
    found = paired_difference(ours, theirs)
    assert found.ratio == pytest.approx(ours.mean() / theirs.mean())
    # Paired, what both share cancels: the ratio's standard error is 0.05/20/0.4.
    assert found.ratio_low == pytest.approx(found.ratio - 1.96 * 0.00625, abs=0.003)
    assert found.ratio_high == pytest.approx(found.ratio + 1.96 * 0.00625, abs=0.003)
    same = paired_difference(theirs, theirs)
    assert (same.ratio, same.ratio_low, same.ratio_high) == (1.0, 1.0, 1.0)
    assert np.isnan(paired_difference(ours, theirs - 0.4).ratio)
    assert np.isnan(paired_difference([1.0], [1.0]).ratio)


def test_crossed_intervals_hold_where_rows_and_columns_vary() -> None:
    rng = np.random.default_rng(2)
    covered = 0
    for _ in range(100):
        table = 2.0 + rng.normal(size=(20, 1)) + rng.normal(size=30) + rng.normal(size=(20, 30))
        mean, low, high = interval(crossed_replicates(table))
        assert mean == pytest.approx(table.mean())
        covered += low <= 2.0 <= high
    # Binomial with n = 100 and 0.95: 86 or fewer has a chance of about 5e-4.
    assert covered >= 87
    # Equal rows leave the columns' spread alone, and the other way round.
    columns = rng.normal(size=200)
    replicates = crossed_replicates(np.tile(columns, (3, 1)))
    assert replicates[1:].std() == pytest.approx(columns.std() / 200**0.5, rel=0.15)
    replicates = crossed_replicates(np.tile(columns[:, None], (1, 7)))
    assert replicates[1:].std() == pytest.approx(columns.std() / 200**0.5, rel=0.15)
