"""Statistics of finished runs: intervals, structure, dwell times."""
