"""Which runs stand for the measurements of Section 4: preset ``experiment``, 27 boats."""

from collections.abc import Sequence
from dataclasses import dataclass

from flockenv.parameters import FlockParameters
from flockenv.reproduce.order_statistics import OrderStatistics
from flockenv.reproduce.reproduction import Results, Settings
from flockenv.runs.spec import RunSpec

__all__ = [
    "CCW",
    "CW",
    "GUIDED_S",
    "LEVELS_S",
    "NONE",
    "SETUPS",
    "Setup",
    "leader_series",
    "noise_series",
    "statistics",
]

LEVELS_S = tuple(round(0.4 + 0.2 * place, 1) for place in range(13))
"""Backward durations: bw from 0.4 to 2.8 s, the range of Table 1."""

GUIDED_S = 1.8
"""The backward duration of figures 7 and 12."""

_RUNS = 6
_LEADER_RUNS = 12
_MINUTES = 8.0


@dataclass(frozen=True, slots=True)
class Setup:
    """One column of figures 9 to 11.

    Attributes
    ----------
    name : str
        For titles and tables.
    n_leaders : int
        Of the 27 boats.
    target : str
        The leaders' direction.
    """

    name: str
    n_leaders: int
    target: str


NONE = Setup("no leaders", 0, "cw")
CCW = Setup("3 leaders, CCW", 3, "ccw")
CW = Setup("3 leaders, CW", 3, "cw")
SETUPS = (NONE, CCW, CW)
"""The columns of figures 9 to 11, in the paper's order."""


def flock_parameters(n_leaders: int, bw_s: float, target: str = "cw") -> FlockParameters:
    """Return the experiment with so many leaders at a backward duration."""
    base = FlockParameters.preset("experiment")
    return base.replace(n_leaders=n_leaders, bw_s=bw_s, target=target)


def _runs(settings: Settings, parameters: FlockParameters, count: int) -> list[RunSpec]:
    return [
        RunSpec(
            parameters=parameters,
            seed=seed,
            duration_s=settings.duration_s(_MINUTES),
            keep="order",
        )
        for seed in range(settings.seed, settings.seed + count)
    ]


def noise_series(settings: Settings, setup: Setup) -> list[list[RunSpec]]:
    """Return the 8-minute runs of a column, by backward duration."""
    points = (flock_parameters(setup.n_leaders, bw_s, setup.target) for bw_s in LEVELS_S)
    return [_runs(settings, each, _RUNS) for each in points]


def leader_series(settings: Settings) -> list[list[RunSpec]]:
    """Return the 8-minute runs with 0 to 4 leaders at bw = 1.8 s, by number of leaders."""
    points = (flock_parameters(k, GUIDED_S, "ccw") for k in range(5))
    return [_runs(settings, each, _LEADER_RUNS) for each in points]


def statistics(
    results: Results, points: Sequence[Sequence[RunSpec]], x: Sequence[float] = LEVELS_S
) -> OrderStatistics:
    """Return the statistics of a series."""
    return OrderStatistics.of(results, x, points)
