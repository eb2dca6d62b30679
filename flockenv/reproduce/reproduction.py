"""What a reproduced figure is made of: the runs it needs, and what becomes of them."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar

import pandas as pd
from matplotlib.figure import Figure

from flockenv.errors import FlockError, ParameterError
from flockenv.recording import Recording
from flockenv.reproduce.claim import CheckedClaim
from flockenv.runs.spec import RunSpec
from flockenv.runs.store import RunStore

Derived = TypeVar("Derived")

__all__ = ["Outcome", "Reproduction", "Results", "Settings", "designed", "within_budget"]


@dataclass(frozen=True, slots=True)
class Settings:
    """What the user chooses for all figures.

    Attributes
    ----------
    seed : int
        First seed of every figure's runs.
    minutes : float or None
        Length of a run, None for the paper's own.
    budget_core_min : float
        How many minutes of one core each name beyond the paper, such as ``transition-order``, may
        take; its design follows from it.

    Raises
    ------
    ParameterError
        For a length below a third of a minute or above 1e5 minutes, and a budget that is not
        positive.
    """

    seed: int = 0
    minutes: float | None = None
    budget_core_min: float = 40.0

    def __post_init__(self) -> None:
        if self.minutes is not None and not 1 / 3 <= self.minutes <= 1e5:
            raise ParameterError(
                f"minutes = {self.minutes!r} is not accepted: from 1/3 (some cycles) to 1e5"
            )
        if not self.budget_core_min > 0:
            raise ParameterError(
                f"budget = {self.budget_core_min!r} is not accepted: core-minutes above 0"
            )

    def duration_s(self, paper_minutes: float) -> float:
        """Return the length of a run in s, given the paper's in minutes."""
        return 60.0 * (paper_minutes if self.minutes is None else self.minutes)


class _Design(Protocol):
    def core_minutes(self, settings: Settings) -> float: ...

    def all_runs(self, settings: Settings) -> "list[RunSpec]": ...


Design = TypeVar("Design", bound=_Design)


def within_budget(name: str, designs: Sequence[Design], settings: Settings) -> Design:
    """Return the largest design that the budget allows, out of increasing ones.

    Raises
    ------
    ParameterError
        If it does not suffice for the smallest design; the message has `name`.
    """
    for design in reversed(designs):
        if design.core_minutes(settings) <= settings.budget_core_min:
            return design
    least = designs[0].core_minutes(settings)
    raise ParameterError(
        f"budget = {settings.budget_core_min:g} core-minutes is not enough for {name}: "
        f"at least {least:.1f}, or shorter runs"
    )


class Results(Mapping[RunSpec, Recording]):
    """Finished runs by their specs, read from the store when they are needed.

    Parameters
    ----------
    store
        Where they are.
    specs
        Which of them a figure may use.
    derived
        What figures that share runs derive from them, see `derive`.
    """

    def __init__(
        self, store: RunStore, specs: Iterable[RunSpec], derived: dict[Any, Any] | None = None
    ) -> None:
        self._store = store
        self._derived = {} if derived is None else derived
        self._specs = dict.fromkeys(specs)

    def __getitem__(self, spec: RunSpec) -> Recording:
        if spec not in self._specs:
            raise KeyError(spec)
        result = self._store.load(spec)
        if result is None:
            raise FlockError(f"{self._store.path(spec)} has been lost since it was written")
        return result

    def derive(
        self, make: Callable[..., Derived], specs: tuple[RunSpec, ...], *arguments: int
    ) -> Derived:
        """Return ``make([run, …], …)`` of some runs, made once for all figures that share them."""
        key = (make, specs, *arguments)
        if key not in self._derived:
            self._derived[key] = make([self[spec] for spec in specs], *arguments)
        derived: Derived = self._derived[key]
        return derived

    def __iter__(self) -> Iterator[RunSpec]:
        return iter(self._specs)

    def __len__(self) -> int:
        return len(self._specs)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a figure's analysis gives.

    Attributes
    ----------
    tables : dict of pandas.DataFrame
        The data by name; each is written as ``<name>.csv`` and ``<name>.parquet``. The rows are in
        an order of their own, never in that of finishing.
    pictures : dict of matplotlib.figure.Figure
        Each is written as ``<name>.png`` and ``<name>.svg``.
    captions : dict of str
        What a picture shows, by its name, where the title of the figure does not say it.
    claims : list of CheckedClaim
        The paper's claims about the figure, judged.
    notes : list of str
        What a reader needs: how intervals were made, what was left out, what to conclude.
    shown : list of str
        Names of tables that the report shows in full.
    data : list of str
        Names of further tables that go along with a summary, as CSV.
    """

    tables: dict[str, pd.DataFrame]
    pictures: dict[str, Figure] = field(default_factory=dict)
    claims: list[CheckedClaim] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    shown: list[str] = field(default_factory=list)
    captions: dict[str, str] = field(default_factory=dict)
    data: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True, kw_only=True)
class Reproduction:
    """A figure, table or claim of the paper that can be reproduced.

    Attributes
    ----------
    name : str
        As on the command line: "fig14".
    title : str
        What it shows, in a line.
    section : str
        Of the paper.
    runs : callable
        The runs of the settings, in a fixed order. Runs that figures share are made once.
    analyze : callable
        From settings and those runs to what is written: a pure function, so that a resumed
        reproduction equals an uninterrupted one byte for byte.
    """

    name: str
    title: str
    section: str
    runs: Callable[[Settings], list[RunSpec]]
    analyze: Callable[[Settings, Results], Outcome]


def designed(
    name: str,
    title: str,
    section: str,
    chosen: Callable[[Settings], Design],
    analyze: Callable[[Design, Settings, Results], Outcome],
) -> Reproduction:
    """Return a reproduction whose runs are those of the design that is chosen for the settings."""
    return Reproduction(
        name=name,
        title=title,
        section=section,
        runs=lambda settings: chosen(settings).all_runs(settings),
        analyze=lambda settings, results: analyze(chosen(settings), settings, results),
    )
