"""Runs as data: what to run, where results are stored, and how many run at once."""

from flockenv.runs.spec import KEEP, RunResult, RunSpec, execute

__all__ = ["KEEP", "RunResult", "RunSpec", "execute"]
