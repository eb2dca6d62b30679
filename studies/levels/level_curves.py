"""Curves of the trainings in suite v3: what has been learned after parts of a budget.

A policy's file has its curve in two texts of its provenance. What an entry says of its curve cannot
be scored again, unlike its policies.
"""

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

import pandas as pd

from flockenv.comparison.levels import BUDGETS, LEVELS, NO_STEERING, REFERENCE
from flockenv.comparison.suite_entry import SuiteEntry
from flockenv.policies.base import Policy
from flockenv.statistics import mean_interval

POINTS, POINT_S = 5, 256 * 60.0
"""Of a curve, and simulated time of the flocks of a point."""

HOURS, ORDER = "curve_flock_hours", "curve_signed_order"
"""Texts of a policy's provenance."""
KEY, ENDS = ["level", "budget", "entry"], ("area", "area_low", "area_high")


def flocks_of(level: str) -> int:
    """Return how many of a level's flocks, the first ones, a point has."""
    return round(POINT_S / LEVELS[level].episode_s)


@dataclass
class Curve:
    """The mean order of what a training has learned, at a fifth of its budget, two fifths, ..."""

    level: str
    #: Flock-hours of the whole training.
    budget: float
    #: Flock-hours and mean signed order.
    points: list[tuple[float, float]] = field(default_factory=list)
    #: Processor seconds of looking, which are not the training's.
    cpu_s: float = 0.0

    def look(self, hours: float, learned: Callable[[], Policy]) -> None:
        """Add what is learned after these flock-hours, if a point is due before the last."""
        place = len(self.points) + 1
        if place < POINTS and hours >= place * self.budget / POINTS:
            self.add(hours, learned())

    def add(self, hours: float, learned: Policy) -> None:
        """Add a point."""
        start = time.process_time()
        led = LEVELS[self.level].run(learned, flocks_of(self.level))
        order = float(led["signed_order"].mean())
        self.points.append((hours, order))
        self.cpu_s += time.process_time() - start

    def texts(self) -> dict[str, str]:
        """Return the curve as texts of a provenance."""
        hours, orders = zip(*self.points, strict=True)
        return {
            HOURS: " ".join(f"{each:g}" for each in hours),
            ORDER: " ".join(f"{each:.5f}" for each in orders),
        }


def trained_in(entries: Iterable[SuiteEntry]) -> set[str]:
    """Return the results versions that policies with a curve name: its orders are of these."""
    every = (
        training.provenance
        for each in entries
        for own in each.trainings.values()
        for training in own
    )
    return {made.get("results_version", "unknown") for made in every if ORDER in made}


def points(entries: Iterable[SuiteEntry], orders: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each point of each training that has a curve, with its score.

    `orders` has the references' signed order in each flock of the levels, in the results version
    of the trainings: in another one the same seeds are other flocks.
    """
    first = orders["flock"] < orders["level"].map(flocks_of)
    ends = orders[(orders["entry"] == "reference") & first]
    scales = ends.groupby(["level", "policy"])["signed_order"].mean()
    rows = []
    for entry, level, given, hours, order in _points(entries):
        none, law = scales[level, NO_STEERING], scales[level, REFERENCE]
        row = {"level": level, "budget": entry.budget, "entry": entry.name, "policy": given}
        score = (order - none) / (law - none)
        rows.append({**row, "flock_hours": hours, "signed_order": order, "score": score})
    return pd.DataFrame(rows, columns=[*KEY, "policy", "flock_hours", "signed_order", "score"])


def _points(
    entries: Iterable[SuiteEntry],
) -> Iterator[tuple[SuiteEntry, str, str, float, float]]:
    for entry in entries:
        for level, trainings in entry.trainings.items():
            for each in trainings:
                texts = (each.provenance.get(name, "").split() for name in (HOURS, ORDER))
                for hours, order in zip(*texts, strict=True):
                    yield entry, level, each.given, float(hours), float(order)


def areas(curves: pd.DataFrame) -> pd.DataFrame:
    """Return the mean area under the curves of each entry, the mean of a curve's scores.

    Its 95 % interval is over trainings, and NaN for a single one.
    """
    rows = []
    for key, own in curves.groupby(KEY, sort=False):
        each = own.groupby("policy")["score"].mean()
        rows.append([*key, len(each), *mean_interval(each)])
    found = pd.DataFrame(rows, columns=[*KEY, "trainings", *ENDS]).sort_values(
        "area", ascending=False, kind="stable"
    )
    places = {name: place for place, name in enumerate([*LEVELS, *map(str, BUDGETS), "more"])}
    return found.sort_values(["level", "budget"], key=lambda each: each.map(places), kind="stable")
