"""Runs as data: what to run, where results are stored, and how many run at once."""

from flockenv.runs.spec import KEEP, RunSpec, execute

__all__ = ["KEEP", "RunSpec", "execute"]
