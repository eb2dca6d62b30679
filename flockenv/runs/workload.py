"""What of many runs is to be made where: shards of them, what is stored already, what it takes."""

import re
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from flockenv.errors import FlockError, ParameterError
from flockenv.runs.spec import RunSpec, execute
from flockenv.runs.store import RunStore

__all__ = ["Shard", "Workload", "measure_workload"]

_TRIAL_S = 60.0


@dataclass(frozen=True, slots=True)
class Shard:
    """One of several shares of many runs, for machines that know nothing of each other.

    The hash of a run's spec decides which shard makes it. Shards never overlap, hold about equally
    many runs, and are the same at each call and on each machine.

    Attributes
    ----------
    number : int
        Which share, 1 to `of`.
    of : int
        How many there are.

    Raises
    ------
    ParameterError
        For a number that is not among them.
    """

    number: int
    of: int

    def __post_init__(self) -> None:
        if not 1 <= self.number <= self.of:
            raise ParameterError(f"shard {self} is not accepted: 1/N to N/N for N shards")

    @classmethod
    def parse(cls, text: str) -> "Shard":
        """Return the shard that a text such as "3/8" names.

        Raises
        ------
        ParameterError
            For any other text, and as for the class.
        """
        found = re.fullmatch(r"\s*(\d{1,9})\s*/\s*(\d{1,9})\s*", text, re.ASCII)
        if found is None:
            raise ParameterError(
                f"shard {text!r} is not accepted: a number and how many there are, such as 3/8"
            )
        return cls(*(int(digits) for digits in found.groups()))

    def runs_of(self, specs: Iterable[RunSpec]) -> list[RunSpec]:
        """Return those runs that are this shard's, in their order."""
        return [spec for spec in specs if int(spec.key, 16) % self.of == self.number - 1]

    def __str__(self) -> str:
        return f"{self.number}/{self.of}"


@dataclass(frozen=True, slots=True)
class Workload:
    """How much there is to be done.

    Attributes
    ----------
    runs : int
        Different runs.
    stored : int
        Those of them that have a file in the store. Whether the file is whole and of this version
        shows when it is read.
    flock_hours : float
        Simulated hours of the runs that have none.
    core_hours : float or None
        What these take on one core of this machine, extrapolated from trial runs of a minute; None
        where those of a protocol could not be made.
    """

    runs: int
    stored: int
    flock_hours: float
    core_hours: float | None


def measure_workload(specs: Iterable[RunSpec], store: RunStore) -> Workload:
    """Return how much there is to be done, measured by trial runs of some of them.

    Parameters
    ----------
    specs
        The runs; repeated ones count once.
    store
        Where finished runs are stored; nothing is written there.

    Returns
    -------
    Workload
        How many runs there are, how many are stored, and what the others take.
    """
    specs = list(dict.fromkeys(specs))
    missing = [spec for spec in specs if not store.path(spec).exists()]
    core_seconds = _core_seconds(missing)
    return Workload(
        runs=len(specs),
        stored=len(specs) - len(missing),
        flock_hours=sum(spec.duration_s for spec in missing) / 3600,
        core_hours=None if core_seconds is None else core_seconds / 3600,
    )


def _core_seconds(specs: Sequence[RunSpec]) -> float | None:
    """Return the processor time of runs; None if none of them could be tried.

    Each protocol is tried with its smallest and its largest flock. A run takes the rate of the
    trial with its protocol that is nearer in size, in s per unit of `RunSpec.cost`.
    """
    seconds = 0.0
    for protocol in dict.fromkeys(spec.protocol for spec in specs):
        by_size = sorted((spec for spec in specs if spec.protocol == protocol), key=_size)
        trials = {_size(spec): spec for spec in (by_size[0], by_size[-1])}
        found = {size: _rate(spec) for size, spec in trials.items()}
        rates = {size: rate for size, rate in found.items() if rate is not None}
        if not rates:
            return None
        for spec in by_size:
            seconds += spec.cost * rates[min(rates, key=lambda size: abs(size - _size(spec)))]
    return seconds


def _size(spec: RunSpec) -> float:
    return spec.cost / spec.duration_s


def _rate(spec: RunSpec) -> float | None:
    trial = replace(spec, duration_s=min(_TRIAL_S, spec.duration_s))
    start = time.process_time()
    try:
        execute(trial)
    except FlockError:
        return None
    return (time.process_time() - start) / trial.cost
