"""A straight line by least squares, and the F test of its slope, as in figure 12."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from flockenv._io.arguments import series
from flockenv._io.extras import require
from flockenv.errors import ParameterError


@dataclass(frozen=True, slots=True)
class Line:
    """A straight line fitted by least squares, and the test of its slope.

    Attributes
    ----------
    slope, intercept : float
        The slope in units of y over x, and the intercept in units of y.
    f : float
        F statistic with 1 and n - 2 degrees of freedom, against no linear dependence; NaN if all y
        are the same. The sign of the slope does not change it.
    p : float
        Probability of such an F or a larger one if y did not depend on x; NaN if `f` is NaN.
    n : int
        Number of points.
    """

    slope: float
    intercept: float
    f: float
    p: float
    n: int

    def __str__(self) -> str:
        if math.isnan(self.f):
            return f"{self.intercept:.3f} in all {self.n} runs: no line to fit"
        sign = "-" if self.slope < 0 else "+"
        return (
            f"{self.intercept:.3f} {sign} {abs(self.slope):.4f} k (F = {self.f:.2f}, "
            f"p = {self.p:.2g}, {self.n} runs)"
        )


def fit_line(x: Iterable[float], y: Iterable[float]) -> Line:
    """Fit y = intercept + slope x, one point per run.

    Raises ParameterError for fewer than three points, a single x, and numbers that are not finite.
    """
    stats = require("scipy.stats", "plot")
    x, y = series(x, "x"), series(y, "y")
    if x.shape != y.shape or not np.isfinite([x, y]).all():
        raise ParameterError("x and y must be as many numbers, and finite")
    if len(x) < 3 or np.ptp(x) == 0.0:
        raise ParameterError("a line needs at least three points at two different x")
    if np.ptp(y) == 0.0:
        return Line(0.0, float(y[0]), math.nan, math.nan, len(x))
    fit = stats.linregress(x, y)
    unexplained = 1.0 - fit.rvalue**2
    f = fit.rvalue**2 / unexplained * (len(x) - 2) if unexplained > 0 else np.inf
    return Line(float(fit.slope), float(fit.intercept), float(f), float(fit.pvalue), len(x))
