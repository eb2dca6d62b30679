"""Leader policies against each other."""

from flockenv.comparison.case import Case
from flockenv.comparison.comparison import compare_leaders
from flockenv.comparison.episodes import NO_LEADERS, ORDERING_TIMES, QUANTITIES, run_episodes
from flockenv.comparison.report import ComparisonReport
from flockenv.comparison.score import score_policies

__all__ = [
    "NO_LEADERS",
    "ORDERING_TIMES",
    "QUANTITIES",
    "Case",
    "ComparisonReport",
    "compare_leaders",
    "run_episodes",
    "score_policies",
]
