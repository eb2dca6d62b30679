"""Statistics of finished runs.

Intervals of means, of differences and of any statistic of independent runs; a straight line with
its test; times of events that some runs never reach; the noise at which order is lost; and, in the
module `structure`, where boats are relative to each other.
"""

from flockenv.statistics.aggregates import interquartile_mean, probability_of_improvement
from flockenv.statistics.critical_noise import LEAST_ROTATION, critical_noise, loss_of_order
from flockenv.statistics.intervals import (
    CONFIDENCE,
    FEW,
    Difference,
    bootstrap_interval,
    mean_interval,
    paired_difference,
    student_interval,
    summarize,
    two_way_interval,
)
from flockenv.statistics.line import Line, fit_line
from flockenv.statistics.survival import Survival, kaplan_meier

__all__ = [
    "CONFIDENCE",
    "FEW",
    "LEAST_ROTATION",
    "Difference",
    "Line",
    "Survival",
    "bootstrap_interval",
    "critical_noise",
    "fit_line",
    "interquartile_mean",
    "kaplan_meier",
    "loss_of_order",
    "mean_interval",
    "paired_difference",
    "probability_of_improvement",
    "student_interval",
    "summarize",
    "two_way_interval",
]
