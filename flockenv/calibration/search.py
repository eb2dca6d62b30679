"""The fit of the model's free constants to the experiment: seeded, resumable, with a log of trials.

The search is CMA-ES (Hansen's covariance matrix adaptation, from the package cmaes) over logarithms
of the constants. A trial measures the single boat first. Flocks are run only if that boat backs and
turns about as the experiment's boats do, on the same seeds in every trial. The least loss of a
trial is too low by the luck of those seeds. After the search, the best trials and the minimum of a
response surface through all trials are therefore run again on more seeds, and the chosen constants
are measured on seeds that the search has not used.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from flockenv._io.atomic_write import atomic_write
from flockenv._io.extras import require
from flockenv.calibration.targets import NOISE_S, TARGETS, FlockRuns, loss, measure, run_flock
from flockenv.calibration.targets import single_boat as measure_boat
from flockenv.errors import ParameterError, refuse_unknown
from flockenv.parameters import FlockParameters
from flockenv.runs.executors import in_order
from flockenv.runs.seeds import MODEL_SEEDS
from flockenv.statistics.intervals import percentile_ends

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "BOUNDS",
    "Fit",
    "Trial",
    "experiment_parameters",
    "residuals",
    "run_flocks",
    "surface_minimum",
]

BOUNDS: Mapping[str, tuple[float, float]] = {
    "c1": (0.05, 5.0),
    "c2": (0.05, 4.0),
    "c3": (0.03, 1.0),
    "c4": (1e-3, 0.3),
    "reverse_speed_cm_s": (2.0, 12.0),
    "speed_spread_cm_s": (0.1, 5.0),
    "current_gain": (0.01, 0.6),
    "turning_bias": (1e-3, 0.3),
}
"""Constants that can be fitted, each between these bounds, searched by its logarithm."""

MODEL_CONSTANTS = ("c1", "c2", "c3", "c4", "reverse_speed_cm_s")
"""Default of the fitted constants: no optional effects."""

_BOAT_TARGETS = ("backing_turn", "backing_speed")


def experiment_parameters() -> FlockParameters:
    """Return Table 1: 27 boats in the printed pool, leaders whose motor runs forward only."""
    base = FlockParameters.preset("simulation")
    return base.replace(n_boats=27, pool="table-1", leaders_reverse=False)


@dataclass(frozen=True, slots=True)
class Trial:
    """Constants of a trial, the values of the targets, and the loss."""

    constants: Mapping[str, float]
    values: Mapping[str, float]
    loss: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Fit:
    """The search: free constants, targets and effort.

    Attributes
    ----------
    free : tuple of str
        Constants to fit, of `BOUNDS`.
    only : tuple of str
        Keys of the targets to fit to; all that have a weight, if empty.
    parameters : FlockParameters
        Everything else.
    trials, seeds, finalists, seed : int
        Trials of the search, flock seeds in each; how many of the best are run again on four times
        as many other seeds; seed of the search.
    jobs : int
        Runs at a time.

    Raises
    ------
    ParameterError
        For unknown constants or targets, and numbers out of range.
    """

    HOPELESS: ClassVar[float] = 1000.0
    """Least loss of trials whose single boat is too far off for flocks to be run."""

    free: tuple[str, ...] = MODEL_CONSTANTS
    only: tuple[str, ...] = ()
    parameters: FlockParameters = field(default_factory=experiment_parameters)
    trials: int = 110
    seeds: int = 4
    finalists: int = 3
    seed: int = 0
    jobs: int = 1

    def __post_init__(self) -> None:
        refuse_unknown(self.free, BOUNDS, "entry of free")
        refuse_unknown(self.only, [target.key for target in TARGETS], "entry of only")
        if not self.free:
            raise ParameterError("free = () is not accepted: at least one constant")
        for name in ("trials", "seeds", "finalists", "jobs"):
            if getattr(self, name) < 1:
                raise ParameterError(f"{name} = {getattr(self, name)} is not accepted: at least 1")
        if not 0 <= self.seed < 2**32:
            raise ParameterError(f"seed = {self.seed} is not accepted: from 0 to 2^32 - 1")

    def search(self, log: Path) -> Iterator[Trial]:
        """Yield the trials, reading from the log what it has of them and adding the rest.

        Raises
        ------
        ParameterError
            If the log is of another fit; nothing is changed then.
        MissingExtraError
            Without the extra ``fit``.
        """
        cmaes = require("cmaes", "fit")
        known = _read_log(log, self.free)
        optimizer = cmaes.CMA(
            mean=np.full(len(self.free), 0.5),
            sigma=0.25,
            bounds=np.tile([0.0, 1.0], (len(self.free), 1)),
            seed=self.seed,
            population_size=4 + 3 * len(self.free) // 2,
        )
        done: list[Trial] = []
        while len(done) < self.trials:
            generation = []
            for _ in range(optimizer.population_size):
                place = optimizer.ask()
                constants = self._constants(place)
                if len(done) < len(known):
                    trial = _same(known[len(done)], constants, log)
                else:
                    trial = self.trial(constants, MODEL_SEEDS["calibration"].seeds(self.seeds))
                done.append(trial)
                if len(done) > len(known):
                    _write_log(log, done)
                generation.append((place, trial.loss))
                yield trial
            optimizer.tell(generation)

    def finals(
        self, trials: Sequence[Trial], progress: Callable[[], None] = lambda: None
    ) -> list[Trial]:
        """Run the best trials again on other seeds, and return them best first."""
        ranked = sorted(trials, key=lambda trial: trial.loss)[: self.finalists]
        smooth = surface_minimum(self._with_flocks(trials), self.only, self.seed)
        others = MODEL_SEEDS["calibration"].seeds(4 * self.seeds, start=self.seeds)
        again = []
        for constants in [*(trial.constants for trial in ranked), *smooth]:
            again.append(self.trial(constants, others))
            progress()
        return sorted(again, key=lambda trial: trial.loss)

    def trial(self, constants: Mapping[str, float], seeds: Sequence[int]) -> Trial:
        """Measure every target with these constants."""
        parameters = self.parameters.replace(**constants)
        boat = measure_boat(parameters)
        lone = measure(boat, _no_runs())
        distance = sum(
            target.residual(lone[target.key]) for target in TARGETS if target.key in _BOAT_TARGETS
        )
        # Flocks of boats that are two tolerances off carry no information.
        if distance > 2.0:
            return Trial(dict(constants), lone, self.HOPELESS + distance)
        values = measure(boat, run_flocks(parameters, seeds, NOISE_S, self.jobs))
        return Trial(dict(constants), values, loss(values, self.only))

    def _with_flocks(self, trials: Sequence[Trial]) -> list[Trial]:
        return [trial for trial in trials if trial.loss < self.HOPELESS]

    def _constants(self, place: NDArray[np.float64]) -> dict[str, float]:
        constants = {}
        for name, part in zip(self.free, place.tolist(), strict=True):
            low, high = BOUNDS[name]
            constants[name] = low * (high / low) ** part
        return constants


def run_flocks(
    parameters: FlockParameters,
    seeds: Sequence[int],
    noise_s: Mapping[int, tuple[float, ...]],
    jobs: int = 1,
    progress: Callable[[], None] = lambda: None,
) -> FlockRuns:
    """Run flocks with each number of leaders at each backward duration, on the same seeds."""
    cells = [(k, bw_s, seed) for k, levels in noise_s.items() for bw_s in levels for seed in seeds]

    def run(cell: tuple[int, float, int]) -> list[float]:
        k, bw_s, seed = cell
        measured = run_flock(parameters.replace(n_leaders=k, bw_s=bw_s), seed)
        progress()
        return measured

    rows = iter(in_order(run, cells, jobs))
    values = {
        k: np.array([[next(rows) for _ in seeds] for _ in levels]) for k, levels in noise_s.items()
    }
    return FlockRuns(noise_s, values)


def surface_minimum(
    trials: Sequence[Trial], only: Sequence[str] = (), seed: int = 0
) -> list[dict[str, float]]:
    """Find the constants of least loss on planes through all trials: a response surface.

    Each target is a linear function of the logarithms of the constants, fitted to all trials by
    least squares. The loss of these functions is minimized over draws as widely spread as the
    trials. It averages over trials, so that the luck of their seeds biases it less than the best
    trial.

    Returns
    -------
    list of dict
        One set of constants, or none if there are fewer than five trials per constant.
    """
    if len(trials) < 5 * (len(trials[0].constants) + 1 if trials else 1):
        return []
    names = list(trials[0].constants)
    places = np.log([list(trial.constants.values()) for trial in trials])
    middle, spread = places.mean(axis=0), np.cov(places.T).reshape(len(names), len(names))
    known = [target.key for target in TARGETS]
    values = np.array([[trial.values[key] for key in known] for trial in trials])
    whole = np.isfinite(values).all(axis=1)
    planes, *_ = np.linalg.lstsq(_with_one(places[whole] - middle), values[whole], rcond=None)
    rng = np.random.default_rng(seed)
    draws = rng.multivariate_normal(np.zeros(len(names)), spread, 4000, method="cholesky")
    losses = [loss(dict(zip(known, row, strict=True)), only) for row in _with_one(draws) @ planes]
    best = np.exp(middle + draws[int(np.argmin(losses))])
    return [
        {
            name: float(np.clip(value, *BOUNDS[name]))
            for name, value in zip(names, best, strict=True)
        }
    ]


def _with_one(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.hstack([np.ones((len(rows), 1)), rows])


def residuals(
    parameters: FlockParameters, runs: FlockRuns, resamples: int = 1000
) -> "pd.DataFrame":
    """Return each target with its range, its value and interval, and whether it is in range.

    Intervals are percentiles of a bootstrap over seeds, at 95 %. A target is in range if its value
    lies in its range, whatever its interval.
    """
    pandas = require("pandas", "fit")
    boat = measure_boat(parameters)
    values = measure(boat, runs)
    seeds = int(next(iter(runs.values.values())).shape[1])
    rng = np.random.default_rng(0)
    drawn = [
        measure(boat, runs.resampled(rng.integers(seeds, size=seeds))) for _ in range(resamples)
    ]
    rows = []
    for target in TARGETS:
        sample = np.array([each[target.key] for each in drawn])
        defined = sample[np.isfinite(sample)]
        low, high = percentile_ends(defined) if len(defined) else (math.nan, math.nan)
        value = values[target.key]
        rows.append(
            {
                "key": target.key,
                "target": target.name,
                "source": target.source,
                "target_low": target.low,
                "target_high": target.high,
                "value": value,
                "value_low": low,
                "value_high": high,
                "in_range": target.is_in_range(value),
                "statement": target.statement,
            }
        )
    table: pd.DataFrame = pandas.DataFrame(rows)
    return table


def _no_runs() -> FlockRuns:
    return FlockRuns(NOISE_S, {k: np.full((len(s), 1, 6), math.nan) for k, s in NOISE_S.items()})


def _write_log(path: Path, trials: Sequence[Trial]) -> None:
    free, keys = list(trials[0].constants), [target.key for target in TARGETS]
    lines = [",".join([*free, *keys, "loss"])]
    for trial in trials:
        numbers = [*trial.constants.values(), *(trial.values[key] for key in keys), trial.loss]
        # repr keeps every bit, so that a resumed fit makes the same next trial.
        lines.append(",".join(repr(float(number)) for number in numbers))
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_write(path) as file:
        file.write(("\n".join(lines) + "\n").encode())


def _read_log(path: Path, free: Sequence[str]) -> list[Trial]:
    if not path.exists():
        return []
    keys = [target.key for target in TARGETS]
    header, *lines = path.read_text(encoding="utf-8").splitlines() or [""]
    if header.split(",") != [*free, *keys, "loss"]:
        raise ParameterError(
            f"{path} is the log of another fit: move it away or name another --out"
        )
    trials = []
    for number, line in enumerate(lines, start=2):
        try:
            numbers = [float(text) for text in line.split(",")]
            constants = dict(zip(free, numbers, strict=False))
            values = dict(zip([*keys, "loss"], numbers[len(free) :], strict=True))
        except ValueError as error:
            raise ParameterError(f"{path}, line {number}: {error}") from error
        trials.append(Trial(constants, values, values.pop("loss")))
    return trials


def _same(trial: Trial, constants: Mapping[str, float], log: Path) -> Trial:
    if trial.constants != constants:
        raise ParameterError(
            f"{log} was made with other options (seed, bounds or version): move it away or name "
            "another --out"
        )
    return trial
