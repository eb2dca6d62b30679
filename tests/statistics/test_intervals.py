"""Intervals hold the mean as often as they say, for few values and for many.

On paper: the mean of 1, 2 and 3 is 2, with the standard error 1/√3 and Student's quantile 4.303.
"""

import numpy as np
import pandas as pd
import pytest

from flockenv.statistics import (
    FEW,
    bootstrap_interval,
    mean_interval,
    paired_difference,
    student_interval,
    summarize,
    two_way_interval,
)


def test_few_values_have_students_interval() -> None:
    mean, low, high = mean_interval([1.0, 2.0, 3.0])
    assert (mean, high - mean, mean - low) == pytest.approx((2.0, *[4.302653 / 3**0.5] * 2))


def test_from_a_dozen_on_an_interval_is_a_bootstrap() -> None:
    values = np.random.default_rng(2).exponential(size=FEW)
    found = [mean_interval(values), mean_interval(values[1:])]
    assert found[0] == bootstrap_interval([values], np.mean, 0)
    assert found[1] == student_interval(values[1:])


@pytest.mark.parametrize("count", [3, FEW, 40])
def test_the_interval_covers_the_mean_as_often_as_it_says(count: int) -> None:
    rng = np.random.default_rng(1)
    covered = 0
    for _ in range(100):
        mean, low, high = mean_interval(rng.normal(2.0, 1.0, count))
        assert low < mean < high
        covered += low <= 2.0 <= high
    # Binomial with n = 100 and 0.95: 86 or fewer has a chance of about 5e-4.
    assert covered >= 87


def test_any_statistic_of_runs_has_an_interval() -> None:
    """The median of n normal values has the standard deviation sqrt(π/2n)."""
    values = np.random.default_rng(3).normal(size=400)
    median, low, high = bootstrap_interval([values], np.median)
    assert median == np.median(values)
    assert high - low == pytest.approx(2 * 1.96 * np.sqrt(np.pi / 800), rel=0.25)
    assert np.isnan(bootstrap_interval([[1.0]], np.mean)[1:]).all()


def test_pairs_share_what_moves_both() -> None:
    def difference(a: np.ndarray, b: np.ndarray, axis: int) -> np.ndarray:
        return np.asarray(a.mean(axis) - b.mean(axis))

    rng = np.random.default_rng(4)
    common = rng.normal(size=100)
    samples = [common + rng.normal(0.0, 0.1, 100) for _ in range(2)]
    paired = bootstrap_interval(samples, difference)
    apart = bootstrap_interval(samples, difference, paired=False)
    # Standard errors: 0.1·sqrt(2)/10 and about sqrt(2)/10.
    assert paired[2] - paired[1] == pytest.approx(2 * 1.96 * 0.01414, rel=0.25)
    assert apart[2] - apart[1] == pytest.approx(2 * 1.96 * 0.1414, rel=0.25)


def test_intervals_of_one_value_and_of_equal_values() -> None:
    mean, low, high = mean_interval([3.0])
    assert mean == 3.0
    assert np.isnan([low, high]).all()
    assert mean_interval([2.0, 2.0, 2.0]) == (2.0, 2.0, 2.0)
    # A run without the quantity leaves its mean unknown, not the mean of the others.
    assert np.isnan(mean_interval([1.0, np.nan, 2.0])).all()
    with pytest.raises(ValueError, match="no values"):
        mean_interval([])


def test_groups_keep_their_order_and_their_own_means() -> None:
    runs = pd.DataFrame({"policy": list("bbaa"), "k": [1, 1, 0, 0], "psi_o": [1.0, 3.0, 5.0, 9.0]})
    means = summarize(runs, ["policy", "k"], ["psi_o"])
    assert means["policy"].tolist() == ["b", "a"]
    assert means["psi_o"].tolist() == [2.0, 7.0]
    assert means["runs"].tolist() == [2, 2]
    assert list(means) == ["policy", "k", "runs", "psi_o", "psi_o_low", "psi_o_high"]
    # Runs without a value in a column form a group, too.
    unnamed = summarize(runs.assign(policy=[None, None, "a", "a"]), ["policy", "k"], ["psi_o"])
    assert unnamed["runs"].tolist() == [2, 2]


def test_pairs_are_compared_seed_by_seed() -> None:
    theirs = np.array([0.0, 10.0, -5.0, 3.0])
    found = paired_difference(theirs + np.array([1.0, 2.0, 3.0, 2.0]), theirs)
    assert found.mean == pytest.approx(2.0)
    assert found.effect == pytest.approx(2.0 / np.sqrt(2.0 / 3.0))
    # Student's quantile for four values is 3.182, the standard error sqrt(2/3)/2.
    assert found.high - found.mean == pytest.approx(3.182446 * np.sqrt(2 / 3) / 2)
    same = paired_difference(theirs, theirs)
    assert (same.mean, same.low, same.high, same.n) == (0.0, 0.0, 0.0, 4)
    assert np.isnan(same.effect)
    with pytest.raises(ValueError, match="3 and 2"):
        paired_difference([1, 2, 3], [1, 2])


# Five rows and 101 columns, evenly spaced around 0: a mean of 0, and a spread known on paper.
ROWS, COLUMNS = np.linspace(-1.0, 1.0, 5)[:, None], np.linspace(-3.0, 3.0, 101)


def half_width(table: np.ndarray) -> float:
    mean, low, high = two_way_interval(table)
    assert mean == pytest.approx(0.0, abs=1e-12)
    return (high - low) / 2


@pytest.mark.parametrize("table", [ROWS + 0.0 * COLUMNS, 0.0 * ROWS + COLUMNS])
def test_a_table_of_one_effect_has_its_students_interval(table: np.ndarray) -> None:
    effect = table[:, 0] if np.ptp(table[:, 0]) else table[0]
    _, _, high = student_interval(effect)
    # Percentiles of a mean of five equally spaced values are 4 % below those of a normal one.
    assert half_width(table) == pytest.approx(high, rel=0.06)
    turned = half_width(table.T)
    assert turned == pytest.approx(high, rel=0.06)


def test_independent_effects_add_as_squares() -> None:
    """Five rows have the standard error 1/√8 and the quantile 2.776."""
    both = half_width(ROWS + 2.0 * COLUMNS)
    rows = 2.776 * np.sqrt(1 / 8)
    columns = 1.984 * 2.0 * COLUMNS.std(ddof=1) / np.sqrt(101)
    assert both == pytest.approx(np.hypot(rows, columns), rel=0.06)
    # The interval over the rows' means alone leaves out the columns' luck.
    assert rows < 0.9 * both


def test_rows_that_share_their_columns_are_covered_as_often_as_it_says() -> None:
    rng, covered, covered_by_rows = np.random.default_rng(5), 0, 0
    for _ in range(100):
        table = rng.normal(size=(8, 1)) * 0.02 + rng.normal(size=40) * 0.2
        table = table + rng.normal(size=(8, 40)) * 0.2
        _, low, high = two_way_interval(table)
        covered += low <= 0.0 <= high
        _, low, high = mean_interval(table.mean(axis=1))
        covered_by_rows += low <= 0.0 <= high
    assert covered >= 87  # As above.
    assert covered_by_rows < 75


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ([1.0, 2.0], "shape"),
        ([[1.0, 2.0]], "shape"),
        ([[1.0, np.nan], [1.0, 2.0]], "finite"),
        ([["a", "b"], ["c", "d"]], "numbers"),
    ],
)
def test_a_table_without_rows_and_columns_is_refused(values: object, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        two_way_interval(values)
