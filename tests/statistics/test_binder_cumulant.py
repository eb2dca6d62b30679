"""The Binder cumulant tells fluctuations about zero from order, and coexistence from both.

On paper: where |m| is 1 in a share w of the time and 0 in the rest, <m²> = <m⁴> = w, and
U = 1 - 1/(3w): 2/3 for w = 1, 0 for w = 1/3 and -1 for w = 1/6.
"""

import numpy as np
import pytest

from flockenv.statistics import binder_cumulant


@pytest.mark.parametrize(("share", "expected"), [(1.0, 2 / 3), (1 / 3, 0.0), (1 / 6, -1.0)])
def test_states_with_and_without_order(share: float, expected: float) -> None:
    assert binder_cumulant(share, share) == pytest.approx(expected)


def test_normal_fluctuations_have_none() -> None:
    m = np.random.default_rng(0).normal(0.0, 0.3, 400_000)
    # The standard error is sqrt(8/(3 n)) = 0.0026.
    assert binder_cumulant((m**2).mean(), (m**4).mean()) == pytest.approx(0.0, abs=0.01)


def test_replicates_keep_their_shape_and_no_motion_has_no_cumulant() -> None:
    found = binder_cumulant([1.0, 0.0], [1.0, 0.0])
    assert found[0] == pytest.approx(2 / 3)
    assert np.isnan(found[1])
