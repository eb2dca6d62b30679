"""The straight line is the one of least squares, and its tests know what they say.

On paper: y = 1, 2, 2 at x = 0, 1, 2 has slope 1/2, intercept 7/6, F = 3 and p = 1/3.
"""

import numpy as np
import pytest

from flockenv.statistics import fit_line


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
