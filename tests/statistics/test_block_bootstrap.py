"""Intervals of time averages hold for correlated samples, and see what differs between runs.

On paper: the mean of t samples of an AR(1) process x' = a·x + N(0, 1) has for long t the standard
deviation 1/((1 - a)·sqrt(t)), (1 + a)/(1 - a) times in variance what independent samples have.
"""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lfilter

from flockenv.statistics import (
    binder_cumulant,
    block_sums,
    block_sums_resampled,
    interval,
    time_average_interval,
)

A = 0.9
SAMPLES = 4000


def autoregressive(seed: int) -> NDArray[np.float64]:
    noise = np.random.default_rng(seed).normal(size=SAMPLES + 200)
    return np.asarray(lfilter([1.0], [1.0, -A], noise))[200:]


def means(runs: list[NDArray[np.float64]], block: float) -> NDArray[np.float64]:
    sums = []
    for values in runs:
        pairs = np.stack([np.ones(len(values)), values], axis=1)
        sums.append(block_sums(np.arange(len(values), dtype=float), pairs, block))
    counted, summed = block_sums_resampled(sums, seed=1).T
    return summed / counted


def test_the_spread_of_a_correlated_mean() -> None:
    expected = 1 / ((1 - A) * np.sqrt(SAMPLES))
    with_blocks = np.mean([means([autoregressive(s)], 100.0)[1:].std() for s in range(20)])
    # Blocks of 100 samples, ten correlation times, omit some 5 % of the variance on average.
    assert with_blocks == pytest.approx(expected, rel=0.12)
    single = np.mean([means([autoregressive(s)], 1.0)[1:].std() for s in range(20)])
    assert single == pytest.approx(expected * np.sqrt((1 - A) / (1 + A)), rel=0.12)


def test_the_interval_covers_the_mean_as_often_as_it_says() -> None:
    covered = 0
    for seed in range(60):
        _, low, high = interval(means([autoregressive(seed)], 100.0))
        covered += low <= 0.0 <= high
    # Binomial with n = 60 and 0.95: 49 or fewer has a chance of about 1e-4.
    assert covered >= 50


def test_runs_that_stay_in_different_states_widen_the_interval() -> None:
    runs = [autoregressive(seed) + shift for seed, shift in enumerate((-20.0, 0.0, 20.0))]
    mean, low, high = interval(means(runs, 100.0))
    assert mean == pytest.approx(0.0, abs=1.0)
    # Drawn thrice from {-20, 0, 20}: standard deviation 20·sqrt(2/3)/sqrt(3) = 9.4.
    assert means(runs, 100.0)[1:].std() == pytest.approx(9.43, rel=0.1)
    assert low < -15
    assert high > 15


def test_a_function_of_time_averages_has_the_interval_of_its_parts() -> None:
    times = np.arange(SAMPLES, dtype=float)
    runs = [(times, autoregressive(seed)) for seed in range(4)]
    # The same draws as step by step.
    assert time_average_interval(runs, 100.0, seed=1) == interval(
        means([values for _, values in runs], 100.0)
    )
    moments = [(times, np.stack([m**2, m**4], axis=1)) for _, m in runs]
    value, low, high = time_average_interval(moments, 100.0, binder_cumulant)
    assert low < 0.0 < high  # Normal samples have none.
    assert low < value < high < 0.1
    one = np.ones((SAMPLES, 2))  # |m| = 1 throughout.
    ordered = time_average_interval([(times, one)], 100.0, binder_cumulant)
    assert ordered == pytest.approx((2 / 3,) * 3)
    with pytest.raises(ValueError, match="no runs"):
        time_average_interval([], 100.0)


def test_blocks_are_of_time_and_lose_nothing() -> None:
    time_s = np.array([0.0, 0.9, 1.0, 5.0, 5.5])
    sums = block_sums(time_s, [[1.0], [2.0], [4.0], [8.0], [16.0]], 1.0)
    assert sums.tolist() == [[3.0], [4.0], [24.0]]
    with pytest.raises(ValueError, match="no samples"):
        block_sums(np.zeros(0), np.zeros((0, 1)), 1.0)


def test_the_first_row_is_the_data_and_draws_belong_to_the_seed() -> None:
    runs = [np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([[5.0, 6.0]])]
    sums = block_sums_resampled(runs, seed=3, resamples=50)
    assert sums[0].tolist() == [9.0, 12.0]
    assert (sums == block_sums_resampled(runs, seed=3, resamples=50)).all()
    assert (sums != block_sums_resampled(runs, seed=4, resamples=50)).any()


def test_an_undefined_quantity_has_no_interval() -> None:
    assert np.isnan(interval(np.full(100, np.nan))).all()
    value, low, high = interval(np.array([1.0, np.nan, 2.0, 2.0, 2.0]))
    assert (value, low, high) == (1.0, 2.0, 2.0)
