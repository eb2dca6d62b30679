"""A flock that a program advances, with its contacts, order parameters and statistics."""

from flockenv.flock.flock import (
    STEP_STATISTICS,
    Contacts,
    ContactSeries,
    Flock,
    Statistics,
    StepStatistics,
)

__all__ = ["STEP_STATISTICS", "ContactSeries", "Contacts", "Flock", "Statistics", "StepStatistics"]
