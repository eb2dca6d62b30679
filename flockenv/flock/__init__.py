"""A flock that a program advances, with its contacts, order parameters and statistics."""

from flockenv.flock.contacts import Contacts, ContactSeries
from flockenv.flock.flock import Flock
from flockenv.flock.statistics import STEP_STATISTICS, Statistics, StepStatistics

__all__ = ["STEP_STATISTICS", "ContactSeries", "Contacts", "Flock", "Statistics", "StepStatistics"]
