"""The proportion of leaders that guides a flock, against the number of boats."""
