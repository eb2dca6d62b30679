"""The search for the constants of the experiment: trials of one budget, seeded, resumable, logged.

A trial is a set of constants in one reading of the pool. It runs each cell of the design `SEARCHED`
once, on the same seeds in every trial, and its log keeps what those runs measured, so that targets
may be read off again without a run. The first trials fill the space of constants (scrambled
Sobol points, each in every pool) as far as a boat alone backs and turns as Table 1 has it. The
others are proposed in batches, the same number in every pool, by `calibration.surrogate`.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flockenv._io.atomic_write import write_text
from flockenv._io.extras import require
from flockenv._io.interrupts import held_interrupts
from flockenv.calibration.constants import CONSTANTS, POOLS
from flockenv.calibration.flock_runs import (
    QUANTITIES,
    SEARCHED,
    FlockRuns,
    run_flocks,
    single_boat,
)
from flockenv.calibration.surrogate import Kernels, Surrogate, learn, propose
from flockenv.calibration.targets import BOAT_TARGETS, SEARCHED_TARGETS, measure
from flockenv.errors import ParameterError, refuse_unknown
from flockenv.parameters import FlockParameters
from flockenv.runs.seeds import MODEL_SEEDS

__all__ = ["DT_S", "Fit", "Trial", "table"]

DT_S = 0.1
"""Substep of trials, with one relinearization: see docs/speed_vs_error.md."""

_BOAT = tuple(target.key for target in BOAT_TARGETS)
_MOST_DRAWS = 2048
_DRAWN_AT_ONCE = 32
_FEWEST = 10
"""Space-filling trials per constant and pool from which a surrogate says something."""


@dataclass(frozen=True, slots=True)
class Trial:
    """A set of constants in a pool, and what its runs measured.

    Attributes
    ----------
    draw : int
        Place in the Sobol sequence; -1 for a proposal of the surrogate.
    pool : str
        Of `Fit.pools`.
    places : tuple of float
        Of each free constant between its bounds, from 0 to 1.
    boat : mapping of float
        As `single_boat` returns it.
    runs : FlockRuns
        One run of each cell of `SEARCHED`.
    """

    draw: int
    pool: str
    places: tuple[float, ...]
    boat: Mapping[str, float]
    runs: FlockRuns

    @property
    def values(self) -> dict[str, float]:
        """The value of every target."""
        return measure(self.boat, self.runs)


@dataclass(frozen=True, slots=True, kw_only=True)
class Fit:
    """The search: free constants, pools and effort.

    Attributes
    ----------
    free : tuple of str
        Constants to free, of `CONSTANTS`.
    pools : tuple of str
        Readings of the pool.
    parameters : FlockParameters
        Everything else, but the substep.
    flock_hours : float
        Simulated time of all trials together. A search with more of them has the same
        first trials.
    filling_hours : float
        Simulated time of those trials that fill the space.
    batch : int
        Proposals per pool between two fits of the surrogate.
    seed : int
        Of the Sobol points and of the surrogate's draws.
    jobs : int
        Runs at a time.

    Raises
    ------
    ParameterError
        For unknown constants or pools, numbers out of range, and too few flock-hours to say
        anything.
    """

    free: tuple[str, ...] = tuple(CONSTANTS)
    pools: tuple[str, ...] = POOLS
    parameters: FlockParameters = field(
        default_factory=lambda: FlockParameters.preset("experiment-2026")
    )
    flock_hours: float = 4000.0
    filling_hours: float = 2048.0
    batch: int = 64
    seed: int = 0
    jobs: int = 1

    def __post_init__(self) -> None:
        refuse_unknown(self.free, CONSTANTS, "entry of free")
        refuse_unknown(self.pools, POOLS, "entry of pools")
        for name in ("free", "pools"):
            entries = getattr(self, name)
            if not entries or len(set(entries)) < len(entries):
                raise ParameterError(f"{name} = {entries} is not accepted: at least one, each once")
        for name in ("batch", "jobs"):
            if getattr(self, name) < 1:
                raise ParameterError(f"{name} = {getattr(self, name)} is not accepted: at least 1")
        if not 0 <= self.seed < 2**32:
            raise ParameterError(f"seed = {self.seed} is not accepted: from 0 to 2^32 - 1")
        least = _FEWEST * len(self.free) * len(self.pools) * SEARCHED.flock_hours
        if not least <= self.filling_hours < math.inf:
            raise ParameterError(
                f"filling_hours = {self.filling_hours:g} is not accepted: inconclusive: needs at "
                f"least {least:g}, which is {_FEWEST} trials for each constant and pool"
            )
        if not self.filling_hours <= self.flock_hours < math.inf:
            raise ParameterError(
                f"flock_hours = {self.flock_hours:g} is not accepted: inconclusive: needs at least "
                f"filling_hours = {self.filling_hours:g}"
            )

    @property
    def trials(self) -> int:
        """Trials of the whole search, the same number in each pool."""
        return self._trials_in(self.flock_hours)

    def _trials_in(self, hours: float) -> int:
        pools = len(self.pools)
        return int(hours / SEARCHED.flock_hours) // pools * pools

    @property
    def space_filling(self) -> int:
        """Trials that fill the space."""
        return self._trials_in(self.filling_hours)

    def search(self, log: Path) -> Iterator[Trial]:
        """Yield the trials, reading from the log what it has of them and adding the rest.

        Raises
        ------
        ParameterError
            If the log is of another fit or version; nothing is changed then.
        MissingExtraError
            Without the extra ``fit``.
        """
        for package in ("scipy", "sklearn"):
            require(package, "fit")
        done = self._read(log)
        yield from done
        kernels: dict[str, Kernels] = {}
        while len(done) < self.trials:
            if len(done) < self.space_filling:
                planned = self._next_point(done)
            else:
                planned = self._next_proposals(done, kernels)
            for draw, pool, places, boat in planned:
                trial = self._trial(draw, pool, places, boat)
                with log.open("ab") as file:
                    file.write(_line(trial))
                done.append(trial)
                yield trial

    def constants_at(self, places: Sequence[float] | NDArray[np.float64]) -> dict[str, float]:
        """Return the free constants at a place."""
        return {
            name: CONSTANTS[name].at(float(place))
            for name, place in zip(self.free, places, strict=True)
        }

    def parameters_at(self, places: Sequence[float]) -> FlockParameters:
        """Return the parameters of trials at a place, in the pool of `parameters`."""
        stepping = {"dt_s": DT_S, "relinearizations": 1}
        return self.parameters.replace(**self.constants_at(places), **stepping)

    def boat(self, places: Sequence[float]) -> dict[str, float] | None:
        """Measure a boat alone; None if it does not back and turn as Table 1 has it."""
        boat = single_boat(self.parameters_at(places))
        met = all(target.is_in_range(boat[target.key]) for target in BOAT_TARGETS)
        return {name: float(f"{boat[name]:.6g}") for name in _BOAT} if met else None

    def _next_point(
        self, done: Sequence[Trial]
    ) -> Iterator[tuple[int, str, tuple[float, ...], Mapping[str, float]]]:
        """Yield the next Sobol point with a boat of Table 1, once for each pool."""
        started = len(done) % len(self.pools)
        if started:
            last = done[-1]
            for pool in self.pools[started:]:
                yield last.draw, pool, last.places, last.boat
            return
        first = done[-1].draw + 1 if done else 0
        for start in range(first, first + _MOST_DRAWS, _DRAWN_AT_ONCE):
            for draw, point in enumerate(self._points(start), start):
                places = _rounded(point)
                boat = self.boat(places)
                if boat is not None:
                    for pool in self.pools:
                        yield draw, pool, places, boat
                    return
        raise ParameterError(
            f"free = {self.free} is not accepted: of {_MOST_DRAWS} points no boat alone backs and "
            "turns as Table 1 has it"
        )

    def _points(self, first: int) -> NDArray[np.float64]:
        """Return the Sobol points from the `first`-th on."""
        sobol = require("scipy.stats.qmc", "fit").Sobol
        # SciPy does not pass a Ctrl-C on that arrives here, and continues with other points.
        with held_interrupts():
            sequence = sobol(len(self.free), rng=self.seed)
            if first:
                sequence.fast_forward(first)
            return np.asarray(sequence.random(_DRAWN_AT_ONCE))

    def _next_proposals(
        self, done: Sequence[Trial], kernels: dict[str, Kernels]
    ) -> Iterator[tuple[int, str, tuple[float, ...], Mapping[str, float]]]:
        """Yield what is left of the batch that the surrogate proposes, the pools by turns."""
        pools = len(self.pools)
        proposed = len(done) - self.space_filling
        started = proposed % (self.batch * pools)
        known = done[: len(done) - started]
        batches = []
        for number, pool in enumerate(self.pools):
            own = [trial for trial in known if trial.pool == pool]
            if pool not in kernels:
                kernels[pool] = self.kernels(own)
            at, values = table(own)
            surrogate = Surrogate.of(kernels[pool], at, values)
            rng = np.random.default_rng([self.seed, len(known), number])
            batch = propose(surrogate, at, self.batch, rng, lambda at: self.boat(_rounded(at)))
            batches.append(batch)
        for turn in range(started, min(self.batch * pools, started + self.trials - len(done))):
            places, boat = batches[turn % pools][turn // pools]
            yield -1, self.pools[turn % pools], _rounded(places), boat

    def kernels(self, trials: Sequence[Trial]) -> Kernels:
        """Learn the kernels of the surrogate from the space-filling ones among trials of a pool."""
        return learn(*table([trial for trial in trials if trial.draw >= 0]))

    def _trial(
        self, draw: int, pool: str, places: tuple[float, ...], boat: Mapping[str, float]
    ) -> Trial:
        parameters = self.parameters_at(places).replace(pool=pool)
        seeds = MODEL_SEEDS["calibration"].seeds(len(SEARCHED.cells))
        runs = run_flocks(parameters, SEARCHED, seeds, self.jobs)
        # As the log has them, so that a resumed search continues with the same numbers.
        values = np.array([float(f"{value:.6g}") for value in runs.values.ravel()])
        runs = FlockRuns(SEARCHED, values.reshape(runs.values.shape))
        return Trial(draw, pool, places, boat, runs)

    def _header(self) -> str:
        cells = [f"{cell.name}:{name}" for cell in SEARCHED.cells for name in QUANTITIES]
        return ",".join(["draw", "pool", *self.free, *_BOAT, *cells]) + "\n"

    def _read(self, log: Path) -> list[Trial]:
        header = self._header()
        if not log.exists():
            write_text(log, header)
        raw = log.read_bytes()
        whole = raw[: raw.rfind(b"\n") + 1]
        lines = whole.decode("utf-8", errors="replace").splitlines()
        if not lines or lines[0] + "\n" != header:
            raise ParameterError(
                f"{log} is the log of another fit or version: move it away or name another --out"
            )
        trials = []
        for number, line in enumerate(lines[1:], start=2):
            try:
                trials.append(self._parsed(line))
            except ValueError as error:
                raise ParameterError(f"{log}, line {number}: {error}") from error
        if len(whole) < len(raw):
            # A killed search leaves part of a line, whose trial is run again.
            with log.open("r+b") as file:
                file.truncate(len(whole))
        return trials[: self.trials]

    def _parsed(self, line: str) -> Trial:
        draw, pool, *numbers = line.split(",")
        values = [float(number) for number in numbers]
        width, cells = len(self.free), len(SEARCHED.cells)
        if len(values) != width + len(_BOAT) + cells * len(QUANTITIES) or pool not in self.pools:
            raise ValueError("is no trial of this fit")
        boat = dict(zip(_BOAT, values[width : width + len(_BOAT)], strict=True))
        rest = np.array(values[width + len(_BOAT) :]).reshape(cells, 1, len(QUANTITIES))
        return Trial(int(draw), pool, tuple(values[:width]), boat, FlockRuns(SEARCHED, rest))


def table(
    trials: Sequence[Trial],
) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64]]]:
    """Return the places of trials, shape (trials, constants), and the values of their targets."""
    values = [trial.values for trial in trials]
    columns = {
        target.key: np.array([each[target.key] for each in values]) for target in SEARCHED_TARGETS
    }
    return np.array([trial.places for trial in trials]), columns


def _rounded(places: Sequence[float] | NDArray[np.float64]) -> tuple[float, ...]:
    return tuple(round(float(place), 4) for place in places)


def _line(trial: Trial) -> bytes:
    numbers = [*trial.places, *trial.boat.values(), *trial.runs.values.ravel().tolist()]
    words = [str(trial.draw), trial.pool, *(f"{number:.6g}" for number in numbers)]
    return (",".join(words) + "\n").encode()
