"""Leader policies against each other."""

from flockenv.comparison.episodes import (
    CONTROL_HZ,
    EVERY_SUBSTEP,
    NO_LEADERS,
    ORDERING_TIMES,
    POLICIES,
    POOL_POLICIES,
    QUANTITIES,
    compare_leaders,
    named_policy,
    run_episodes,
)

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
