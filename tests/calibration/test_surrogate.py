"""Law: the surrogate averages over luck, and fronts are Pareto's."""

import numpy as np
import pytest

from flockenv.calibration.surrogate import Surrogate, front_ranks, learn


def test_ranks_are_fronts_within_fronts():
    costs = np.array([[1, 3], [2, 2], [3, 1], [2, 3], [3, 3], [4, 4], [1, 3]], float)
    # Equal rows do not dominate each other.
    assert front_ranks(costs, 7).tolist() == [0, 0, 0, 1, 2, 3, 0]
    # Enough are ranked with the first front: the rest shares the next rank.
    assert front_ranks(costs, 1).tolist() == [0, 0, 0, 1, 1, 1, 0]


@pytest.fixture(scope="module")
def planes():
    """Return places and values: a plane with luck of 0.1, undefined in half of the space."""
    rng = np.random.default_rng(5)
    places = rng.random((150, 3))
    truth = 1.0 + places[:, 0] - 0.5 * places[:, 1]
    noisy = truth + rng.normal(0, 0.1, 150)
    return places, {
        "critical_bw_0": noisy,
        "off_tangent": np.where(places[:, 0] < 0.5, noisy, np.nan),
        "ordering_slope_0": np.where(np.arange(150) < 12, noisy, np.nan),
    }


def test_a_process_finds_the_plane_under_the_luck(planes):
    places, values = planes
    kernels = learn(places, values)
    # Twelve values are too few.
    assert set(kernels) == {"critical_bw_0", "off_tangent"}
    surrogate = Surrogate.of(kernels, places, values)
    new = np.random.default_rng(6).random((50, 3))
    means, deviations = surrogate.predict(new)
    truth = 1.0 + new[:, 0] - 0.5 * new[:, 1]
    assert np.sqrt(np.mean((means["critical_bw_0"] - truth) ** 2)) < 0.05
    # The deviation is that of the plane, not that of a single trial.
    assert deviations["critical_bw_0"].mean() < 0.06
    assert np.isnan(means["ordering_slope_0"]).all()
    assert np.isnan(deviations["low_noise_0"]).all()


def test_predictions_stay_within_what_was_measured(planes):
    places, values = planes
    surrogate = Surrogate.of(learn(places, values), places, values)
    far = np.full((1, 3), 9.0)
    means, _ = surrogate.predict(far)
    low, high = np.quantile(values["critical_bw_0"], [0.01, 0.99])
    assert low <= means["critical_bw_0"][0] <= high
