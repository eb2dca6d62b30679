"""Law: order is lost where mean Ψ_o falls through the middle, and only order can be lost.

On paper: Ψ_o falls from 0.9 at bw = 0.2 s, where rotation is strongest, through 0.7 at 0.3 s and
0.3 at 0.4 s to 0.2 at 0.5 s. The middle of 0.9 and 0.2 is 0.55, three eighths of the way from 0.3
to 0.4 s.
"""

import numpy as np
import pytest

from flockenv import ParameterError
from flockenv.statistics import critical_noise, loss_of_order

BW_S = [0.1, 0.2, 0.3, 0.4, 0.5]
PSI_O = [0.95, 0.9, 0.7, 0.3, 0.2]
ROTATION = [0.1, 0.85, 0.6, 0.2, 0.1]


def runs(psi_o=PSI_O, rotation=ROTATION, count=24, scatter=0.0):
    random = np.random.default_rng(3)
    means = np.transpose([psi_o, rotation])
    return [mean + scatter * random.standard_normal((count, 2)) for mean in means]


def test_the_middle_counts_from_the_strongest_rotation_not_from_the_jam():
    assert loss_of_order(BW_S, PSI_O, ROTATION) == pytest.approx(0.3375)
    # From the jam at 0.1 s it would be 0.33125.
    assert critical_noise(BW_S, runs())[0] == pytest.approx(0.3375)


def test_many_curves_at_once_are_each_as_alone():
    curves = np.stack([PSI_O, PSI_O[:1] + PSI_O[:-1]], axis=1)
    turning = np.stack([ROTATION, ROTATION[:1] + ROTATION[:-1]], axis=1)
    found = loss_of_order(BW_S, curves, turning)
    assert found.shape == (2,)
    assert found[0] == pytest.approx(0.3375)


def test_the_interval_holds_the_value_and_narrows_with_runs():
    few, many = (critical_noise(BW_S, runs(count=n, scatter=0.1)) for n in (8, 128))
    for value, low, high in (few, many):
        assert low < value < high
        assert low < 0.3375 < high
    assert many[2] - many[1] < (few[2] - few[1]) / 2


def test_a_flock_without_order_loses_none():
    jammed = critical_noise(BW_S, runs(rotation=[0.49, 0.3, 0.2, 0.1, 0.1]))
    assert np.isnan(jammed).all()
    assert not np.isnan(critical_noise(BW_S, runs(rotation=[0.51, 0.3, 0.2, 0.1, 0.1]))).any()
    assert np.isnan(critical_noise(BW_S, runs(count=2))).all()


def test_means_that_are_unknown_leave_the_noise_unknown():
    for index in range(2):
        groups = runs()
        groups[-1][0, index] = np.nan
        assert np.isnan(critical_noise(BW_S, groups)).all()
    curves = np.stack([PSI_O, [*PSI_O[:-1], np.nan]], axis=1)
    found = loss_of_order(BW_S, curves, np.stack([ROTATION, ROTATION], axis=1))
    assert found[0] == pytest.approx(0.3375)
    assert np.isnan(found[1])


@pytest.mark.parametrize(
    ("noise", "groups"),
    [
        ([0.1], runs()[:1]),
        (BW_S[::-1], runs()),
        (BW_S, runs()[:4]),
        (BW_S, [each[:, 0] for each in runs()]),
    ],
)
def test_what_does_not_fit_together_is_refused(noise, groups):
    with pytest.raises(ParameterError, match=r"noise|runs"):
        critical_noise(noise, groups)
