"""Leader policies against each other."""

from flockenv.comparison.case import Case
from flockenv.comparison.episodes import (
    CONTROL_HZ,
    NO_LEADERS,
    ORDERING_TIMES,
    QUANTITIES,
    compare_leaders,
    run_episodes,
)
from flockenv.comparison.report import ComparisonReport, report
from flockenv.policies.registry import EVERY_SUBSTEP, POLICIES, POOL_POLICIES, named_policy

__all__ = [
    "CONTROL_HZ",
    "EVERY_SUBSTEP",
    "NO_LEADERS",
    "ORDERING_TIMES",
    "POLICIES",
    "POOL_POLICIES",
    "QUANTITIES",
    "Case",
    "ComparisonReport",
    "compare_leaders",
    "named_policy",
    "report",
    "run_episodes",
]
