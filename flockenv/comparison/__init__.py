"""Leader policies against each other."""

from flockenv.comparison.case import Case
from flockenv.comparison.episodes import (
    NO_LEADERS,
    ORDERING_TIMES,
    QUANTITIES,
    compare_leaders,
    run_episodes,
)
from flockenv.comparison.report import ComparisonReport

__all__ = [
    "NO_LEADERS",
    "ORDERING_TIMES",
    "QUANTITIES",
    "Case",
    "ComparisonReport",
    "compare_leaders",
    "run_episodes",
]
