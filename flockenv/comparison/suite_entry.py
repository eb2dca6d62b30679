"""Entries of suite v3: files that name policies, checked before anything runs, and their rows."""

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from flockenv._io.arguments import as_int, number
from flockenv._io.extras import require
from flockenv._io.toml import read_toml_file
from flockenv.comparison.episodes import Progress, no_progress
from flockenv.comparison.levels import (
    BUDGETS,
    FLOCKS,
    LEVELS,
    NO_STEERING,
    REFERENCE,
    SUITE,
    Led,
    Level,
    budget_of,
    score,
    stacked,
)
from flockenv.envs.spaces import differing_options
from flockenv.errors import FlockError, ParameterError, refuse_unknown, short_repr
from flockenv.policies.base import Policy
from flockenv.policies.registry import FILES, policy
from flockenv.policies.wrapped import WrappedPolicy
from flockenv.runs.seeds import FIRST_TRAINING_SEED

if TYPE_CHECKING:
    import pandas as pd

_LONGEST_TEXT = 200


@dataclass(frozen=True)
class Training:
    """A policy of an entry."""

    #: The policy as the entry names it.
    given: str
    policy: Policy
    #: Provenance in the policy's file: short texts by name.
    provenance: Mapping[str, str]


@dataclass(frozen=True)
class SuiteEntry:
    """An entry of suite v3; `from_file` reads and checks it."""

    #: Name of the algorithm and its settings.
    name: str
    #: The class of the algorithm, such as "policy gradient".
    kind: str
    #: Where code, commit and policies are.
    link: str
    #: Flock-hours of one training.
    flock_hours: float
    #: Flock-hours of searches for its settings; NaN if unknown.
    searched_hours: float
    #: Trainings by level.
    trainings: Mapping[str, tuple[Training, ...]]

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], *, trust: bool = False) -> Self:
        """Return the entry of a TOML file.

        Parameters
        ----------
        path
            The file; names of policies in it are relative to its folder.
        trust
            Whether code of policies may be executed, as for `flockenv.policies.policy`.

        Raises
        ------
        ParameterError
            For a file that is not an entry or belongs to another suite, for policies that cannot be
            read or hold numbers that are not finite, and for trainings that used seeds for
            evaluation.
        """
        values = read_toml_file(path, os.fspath(path))
        try:
            return cls._from_values(values, Path(path).parent, trust)
        except (FlockError, TypeError) as error:
            raise ParameterError(f"{os.fspath(path)}: {error}") from error

    @classmethod
    def _from_values(cls, values: Mapping[str, Any], folder: Path, trust: bool) -> Self:
        """Return the entry of a file's values by key; policies are searched in `folder`."""
        refuse_unknown(values, _KEYS, "key of an entry")
        missing = [key for key in _KEYS if key not in values and key != "searched_hours"]
        if missing:
            raise ParameterError(f"{missing[0]} is missing")
        _check_suite(values)
        _check_training_seeds(values["training_seeds"])
        searched_hours = math.nan
        if values.get("searched_hours") is not None:
            searched_hours = _checked_hours(values["searched_hours"], "searched_hours")
        return cls(
            name=_checked_text(values["name"], "name"),
            kind=_checked_text(values["class"], "class"),
            link=_checked_text(values["link"], "link"),
            flock_hours=_checked_hours(values["flock_hours"], "flock_hours"),
            searched_hours=searched_hours,
            trainings={
                name: _trainings(policies, LEVELS[name], folder, trust)
                for name, policies in _levels(values["levels"]).items()
            },
        )

    @property
    def budget(self) -> str:
        """The class of the trainings by flock-hours, one of `BUDGETS` or ``"more"``."""
        return budget_of(self.flock_hours)

    def run(self, level: str, flocks: int = FLOCKS, progress: Progress = no_progress) -> Led:
        """Return `MEASURED` for a level's trainings: shape (trainings, flocks).

        Raises ParameterError if a policy fails before the end of the episode.
        """
        columns_of_trainings = []
        for training in self.trainings[level]:
            try:
                columns_of_trainings.append(LEVELS[level].run(training.policy, flocks, progress))
            except Exception as error:  # The code of a policy may raise anything.
                kind = "" if isinstance(error, FlockError) else f"{type(error).__name__}: "
                raise ParameterError(
                    f"{self.name}, {level}, {training.given}: {kind}{error}; nothing of the "
                    "entry is scored"
                ) from error
        return stacked(columns_of_trainings)

    def row(
        self,
        level: str,
        orders: NDArray[np.float64],
        no_steering: NDArray[np.float64],
        reference: NDArray[np.float64],
    ) -> dict[str, object]:
        """Return an entry's row for a level, from signed orders.

        `orders` has shape (trainings, flocks); `no_steering` and `reference` have shape (flocks,).
        """
        trainings = self.trainings[level]
        mean, low, high = score(orders, no_steering, reference)
        is_as_given = all(_sees_as_given(training.policy, LEVELS[level]) for training in trainings)
        seconds = [float(training.provenance.get("cpu_s", "nan")) for training in trainings]
        return {
            "level": level,
            "budget": self.budget,
            "entry": self.name,
            "class": self.kind,
            "sees": "as given" if is_as_given else "its own",
            "trainings": len(trainings),
            "flocks": orders.shape[1],
            "signed_order": float(orders.mean()),
            "score": mean,
            "score_low": low,
            "score_high": high,
            "flock_hours": self.flock_hours,
            "searched_hours": self.searched_hours,
            "cpu_s": float(np.mean(seconds)),
            "link": self.link,
        }


class Scored(NamedTuple):
    """The results of all entries so far."""

    #: The ranked rows of entries.
    rows: "pd.DataFrame"
    #: `MEASURED` for all flocks; those of each level's two references come first.
    orders: "pd.DataFrame"
    #: For each entry without a row, the reason.
    broken: tuple[str, ...]


def scored(
    entries: Sequence[SuiteEntry],
    levels: Sequence[str],
    flocks: int = FLOCKS,
    progress: Progress = no_progress,
) -> Iterator[Scored]:
    """Score entries one after another, each on the levels for which it has policies.

    Yields after each entry. An entry that fails has no row; the others are still scored.
    """
    pandas = require("pandas", "plot")
    scored_levels = [name for name in levels if any(name in entry.trainings for entry in entries)]
    references = {name: LEVELS[name].references(flocks, progress) for name in scored_levels}
    tables = [
        orders_table(name, "0", "reference", (NO_STEERING, REFERENCE), columns)
        for name, columns in references.items()
    ]
    rows: list[dict[str, object]] = []
    broken: list[str] = []
    for entry in entries:
        entry_levels = [name for name in scored_levels if name in entry.trainings]
        try:
            columns_by_level = {name: entry.run(name, flocks, progress) for name in entry_levels}
        except ParameterError as error:
            columns_by_level = {}
            broken.append(str(error))
        for name, columns in columns_by_level.items():
            reference_orders = references[name]["signed_order"]
            rows.append(entry.row(name, columns["signed_order"], *reference_orders))
            policies = [training.given for training in entry.trainings[name]]
            tables.append(orders_table(name, entry.budget, entry.name, policies, columns))
        yield Scored(ranked(rows), pandas.concat(tables, ignore_index=True), tuple(broken))


def orders_table(
    level: str, budget: str, entry: str, policies: Sequence[str], led: Led
) -> "pd.DataFrame":
    """Return a row for each flock of each policy, from arrays of shape (policies, flocks)."""
    pandas = require("pandas", "plot")
    index = pandas.MultiIndex.from_product([policies, range(led["signed_order"].shape[1])])
    columns = {name: values.ravel() for name, values in led.items()}
    table: pd.DataFrame = pandas.DataFrame(columns, index)
    table = table.rename_axis(["policy", "flock"]).reset_index()
    names: pd.DataFrame = pandas.DataFrame({"level": level, "budget": budget, "entry": entry}, [0])
    return names.merge(table, how="cross")


def ranked(rows: Sequence[Mapping[str, object]]) -> "pd.DataFrame":
    """Return rows of entries as a table: by level and budget, the best first."""
    table: pd.DataFrame = require("pandas", "plot").DataFrame(rows)
    if table.empty:
        return table
    sort_keys = {
        "level": table["level"].map([*LEVELS].index),
        "budget": table["budget"].map([*map(str, BUDGETS), "more"].index),
        "score": -table["score"],
    }
    index = table.assign(**sort_keys).sort_values([*sort_keys], kind="stable").index
    return table.loc[index].reset_index(drop=True)


_KEYS = (
    *("suite", "name", "class", "link"),
    *("flock_hours", "searched_hours", "training_seeds", "levels"),
)


def _check_suite(values: Mapping[str, Any]) -> None:
    """Refuse entries of another suite."""
    if values["suite"] != SUITE:
        raise ParameterError(f"suite = {short_repr(values['suite'])} is not accepted: {SUITE!r}")


def _check_training_seeds(seeds: object) -> None:
    """Refuse anything but the first and the last seed of a range of training seeds."""
    if not isinstance(seeds, list) or len(seeds) != 2:
        raise ParameterError(
            f"training_seeds = {short_repr(seeds)} is not accepted: the first and the last seed of "
            "the flocks that made the policies"
        )
    first, last = (as_int(seed, "training_seeds") for seed in seeds)
    _check_seeds(first, last, "training_seeds")


def _levels(levels: object) -> Mapping[str, object]:
    """Return an entry's table of policies by level; refuse unknown levels."""
    if not isinstance(levels, Mapping) or not levels:
        raise ParameterError(f"levels = {short_repr(levels)} is not a table of levels and policies")
    refuse_unknown(levels, LEVELS, f"level of suite {SUITE}")
    return levels


def _checked_text(value: object, name: str) -> str:
    """Return a printable text of limited length; refuse anything else."""
    if not isinstance(value, str) or not value.isprintable() or not 0 < len(value) <= _LONGEST_TEXT:
        raise ParameterError(
            f"{name} = {short_repr(value)} is not accepted: a text of at most {_LONGEST_TEXT} "
            "characters"
        )
    return value


def _checked_hours(value: object, name: str) -> float:
    """Return finite hours of at least 0; refuse anything else."""
    hours = float(number(value, name))
    if not 0.0 <= hours < math.inf:
        raise ParameterError(f"{name} = {short_repr(value)} is not accepted: hours, at least 0")
    return hours


def _check_seeds(first: int, last: int, name: str) -> None:
    """Refuse training seeds that overlap the seeds for evaluation."""
    if first > last:
        raise ParameterError(
            f"{name} = [{first}, {last}] is not accepted: the first seed is above the last"
        )
    if first < FIRST_TRAINING_SEED:
        raise ParameterError(
            f"{name} = [{first}, {last}] is not accepted: seeds below 2^32 are for evaluation, and "
            "no training may use them"
        )


def _trainings(policies: object, level: Level, folder: Path, trust: bool) -> tuple[Training, ...]:
    """Read and check the policies that an entry names for a level."""
    names = [policies] if isinstance(policies, str) else policies
    if not isinstance(names, list) or not names or not all(isinstance(n, str) for n in names):
        raise ParameterError(
            f"{level.name} = {short_repr(policies)} is not accepted: files of policies"
        )
    if len(set(names)) < len(names):
        raise ParameterError(f"{level.name} names a policy twice, which would count twice")
    return tuple(_training(name, level, folder, trust) for name in names)


def _training(name: str, level: Level, folder: Path, trust: bool) -> Training:
    """Read a policy; check its weights, and the training seeds and cpu_s in its provenance."""
    try:
        is_file = name.endswith(FILES)
        trained = policy(folder / name if is_file else name, level.parameters.pool, trust=trust)
    except OSError as error:
        raise ParameterError(f"{name} cannot be read: {error.strerror}") from error
    except ParameterError as error:
        raise ParameterError(f"{level.name}, {name}: {error}") from error
    _check_weights(trained.source, name)
    provenance = getattr(trained.source, "provenance", None) or {}
    if seeds := provenance.get("training_seeds"):
        first, separator, last = seeds.partition("-")
        if not separator or not (first.isdecimal() and last.isdecimal()):
            raise ParameterError(f"{name} says training_seeds = {seeds!r}, not FIRST-LAST")
        _check_seeds(int(first), int(last), f"training_seeds of {name}")
    try:
        float(provenance.get("cpu_s", "nan"))
    except (TypeError, ValueError) as error:
        cpu_s = short_repr(provenance["cpu_s"])
        raise ParameterError(f"{name} says cpu_s = {cpu_s}, not a number of seconds") from error
    return Training(name, trained, provenance)


def _sees_as_given(policy: Policy, level: Level) -> bool:
    """Return whether a policy sees the level's observation itself, without a wrapper."""
    if isinstance(policy.source, WrappedPolicy):
        return False
    return not differing_options(
        {"observation": policy.observation}, {"observation": level.observation}
    )


def _check_weights(source: object, name: str) -> None:
    """Refuse a torch model whose weights are not finite; other files are checked when read."""
    model = getattr(source, "model", None)
    parameters = getattr(getattr(model, "policy", model), "parameters", None)
    for weights in parameters() if callable(parameters) else ():
        if not bool(weights.isfinite().all()):
            raise ParameterError(f"{name} holds weights that are not finite")
