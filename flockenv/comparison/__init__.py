"""Leader policies against each other."""

from flockenv.comparison.episodes import (
    CONTROL_HZ,
    NO_LEADERS,
    ORDERING_TIMES,
    QUANTITIES,
    compare_leaders,
    run_episodes,
)
from flockenv.policies.registry import EVERY_SUBSTEP, POLICIES, POOL_POLICIES, named_policy

__all__ = [
    "CONTROL_HZ",
    "EVERY_SUBSTEP",
    "NO_LEADERS",
    "ORDERING_TIMES",
    "POLICIES",
    "POOL_POLICIES",
    "QUANTITIES",
    "compare_leaders",
    "named_policy",
    "run_episodes",
]
