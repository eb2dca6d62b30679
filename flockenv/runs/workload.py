"""Shards, which divide many runs among machines, and the amount of work that remains."""

import re
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from flockenv.errors import FlockError, ParameterError
from flockenv.runs.spec import RunSpec, execute
from flockenv.runs.store import RunStore

_TRIAL_S = 60.0


@dataclass(frozen=True, slots=True)
class Shard:
    """One of several parts of many runs, for machines that do not communicate.

    The hash of a run's spec determines the shard that makes the run. Shards never overlap, hold
    about equally many runs, and are the same on each machine. Raises ParameterError for a number
    outside 1 to `of`.

    Attributes
    ----------
    number : int
        Number of this shard, 1 to `of`.
    of : int
        Number of shards.
    """

    number: int
    of: int

    def __post_init__(self) -> None:
        if not 1 <= self.number <= self.of:
            raise ParameterError(f"shard {self} is not accepted: 1/N to N/N for N shards")

    @classmethod
    def parse(cls, text: str) -> "Shard":
        """Return the shard that a text such as "3/8" names.

        Raises ParameterError for any other text and number.
        """
        match = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text, re.ASCII)
        if match is None:
            raise ParameterError(
                f"shard {text!r} is not accepted: a number and how many there are, such as 3/8"
            )
        return cls(*(int(digits) for digits in match.groups()))

    def runs_of(self, specs: Iterable[RunSpec]) -> list[RunSpec]:
        """Return the runs of this shard, in their order."""
        return [spec for spec in specs if int(spec.key, 16) % self.of == self.number - 1]

    def __str__(self) -> str:
        return f"{self.number}/{self.of}"


@dataclass(frozen=True, slots=True)
class Workload:
    """Amount of work that remains.

    Attributes
    ----------
    runs : int
        Different runs.
    stored : int
        Runs that have a file in the store. Only reading a file shows whether it is complete.
    flock_hours : float
        Simulated hours of the runs that have no file.
    core_hours : float or None
        Time that these hours take on one core of this machine, extrapolated from trial runs of a
        minute; None if a trial run failed.
    """

    runs: int
    stored: int
    flock_hours: float
    core_hours: float | None


def measure_workload(specs: Iterable[RunSpec], store: RunStore) -> Workload:
    """Return the amount of work that remains, estimated from a trial run for each policy.

    Parameters
    ----------
    specs
        The runs; repeated ones count once.
    store
        Where finished runs are stored; nothing is written there.
    """
    specs = list(dict.fromkeys(specs))
    missing = [spec for spec in specs if not store.path(spec).exists()]
    by_policy: dict[str, list[RunSpec]] = {}
    for spec in missing:
        by_policy.setdefault(spec.policy, []).append(spec)
    estimates_s = [_core_seconds(policy_specs) for policy_specs in by_policy.values()]
    known_s = [estimate_s for estimate_s in estimates_s if estimate_s is not None]
    return Workload(
        runs=len(specs),
        stored=len(specs) - len(missing),
        flock_hours=sum(spec.duration_s for spec in missing) / 3600,
        core_hours=sum(known_s) / 3600 if len(known_s) == len(estimates_s) else None,
    )


def _core_seconds(specs: Sequence[RunSpec]) -> float | None:
    """Return the processor time of runs in s, extrapolated from a trial of the median run.

    None means that the trial failed.
    """
    median = sorted(specs, key=lambda spec: spec.cost)[len(specs) // 2]
    trial = replace(median, duration_s=min(_TRIAL_S, median.duration_s))
    start = time.process_time()
    try:
        execute(trial)
    except FlockError:
        return None
    seconds_per_cost = (time.process_time() - start) / trial.cost
    return seconds_per_cost * sum(spec.cost for spec in specs)
