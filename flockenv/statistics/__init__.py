"""Statistics of finished runs: each rule stands here once.

Intervals of means, of differences and of any statistic of independent runs; time averages of
correlated samples; a straight line with its test; times of events that did not come to all runs;
the Binder cumulant. `structure` and `dwell_times` have files of their own.
"""

from flockenv.statistics.aggregates import interquartile_mean, probability_of_improvement
from flockenv.statistics.binder_cumulant import binder_cumulant
from flockenv.statistics.block_bootstrap import (
    block_sums,
    block_sums_resampled,
    time_average_interval,
)
from flockenv.statistics.dwell_times import DwellTimes, dwell_times
from flockenv.statistics.intervals import (
    CONFIDENCE,
    FEW,
    Difference,
    bootstrap_interval,
    crossed_replicates,
    interval,
    mean_interval,
    paired_difference,
    student_interval,
    summarize,
)
from flockenv.statistics.line import Line, fit_line
from flockenv.statistics.survival import Survival, kaplan_meier, logrank_p

__all__ = [
    "CONFIDENCE",
    "FEW",
    "Difference",
    "DwellTimes",
    "Line",
    "Survival",
    "binder_cumulant",
    "block_sums",
    "block_sums_resampled",
    "bootstrap_interval",
    "crossed_replicates",
    "dwell_times",
    "fit_line",
    "interquartile_mean",
    "interval",
    "kaplan_meier",
    "logrank_p",
    "mean_interval",
    "paired_difference",
    "probability_of_improvement",
    "student_interval",
    "summarize",
    "time_average_interval",
]
