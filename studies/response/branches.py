"""Branches of one state whose leaders head for opposite sides, and what is measured of them.

**Branches.** A flock without leaders runs for about 8 minutes, and then on. At times a cycle of the
motors begins; from there two branches with the same noise run for 3.5 minutes: k of the boats lead,
to the one side or to the other. The response R is half the difference of m = Ψ_o sin φ_o of the
boats that do not lead, so that it is the same by either side in flocks that favor none. Opposed
groups change sides together. Values are means of the analysis window of each cycle, over windows
that end after 3, 6, 12 and 24 cycles (about 13, 26, 52 and 103 s) and at the end (207 s). A run is
a seed: the mean over its states. Intervals draw seeds, in all cells of a flock together.

**Fluctuations.** K(0) − K(t), where K is the correlation in time of two boats' sin φ in the same
flocks without leaders, over all pairs and times. In linear response theory a leader that pulls at
its own heading moves the other boats by a factor times this difference. ⟨m²⟩, which the study of
worth takes, also counts each boat with itself, which was nine tenths of it at 0.5 s in the pilot.

Noises: 0.31 s is critical for 27 boats in the library's table; 0.2 s lies below, 0.4 and 0.5 s
above. Flocks of 100 and 400 are at their own critical noise by the study of sizes, 0.37 and 0.36 s;
1600 are at that of 400, as their own was not measured. Whether 8 minutes settle a flock is shown by
the correlation of pairs in the first and the second half of its stretches.
"""

import functools
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

import flockenv
from studies.study import Row, Study, seed_of
from studies.worth.worth_runs import DENSITY_BOATS, LAW, of_pool, steering

FIRST = 200_000  # Seeds that neither this study's pilot nor that of worth has.
MINUTES, WARM_CYCLES, STRETCHES = 3.5, 112, 8
SAMPLES, ANALYZED = 8, 3
"""Samples per cycle of the motors, and those of them in the analysis window."""
ENDS = (3, 6, 12, 24)
"""Cycles after which a window of time ends; the last one ends with the branch."""
NAMES = {"m": "m", "velocity": "tangential velocity"}
LAST = 4
"""The window that answers."""
CYCLE_S = 4.0
"""Length of a cycle in s, less bw."""


class Cell(NamedTuple):
    """Leaders of one policy, and those of them that head for the other side."""

    policy: str
    leaders: int
    against: int = 0


class Group(NamedTuple):
    """Flocks of one kind, with their seeds, and the states of each that are branched."""

    n_boats: int
    bw_s: float
    seeds: int
    states: int
    dt_s: float = 0.05

    @property
    def share(self) -> int:
        """One leader in 27, or three leaders in the smallest flock."""
        return 3 if self.n_boats == DENSITY_BOATS else round(self.n_boats / DENSITY_BOATS)


FREE = Cell("nobody", 0)
MAIN = Group(DENSITY_BOATS, 0.31, 128, 8)
ALONE_SEEDS = 256
"""Seeds of single leaders at 0.31 s, whose response is the least certain."""
NOISES = (
    Group(DENSITY_BOATS, 0.2, 64, 8),
    Group(DENSITY_BOATS, 0.4, 64, 8),
    Group(DENSITY_BOATS, 0.5, 128, 8),
)
SIZES = (Group(100, 0.37, 32, 4), Group(400, 0.36, 24, 2), Group(1600, 0.36, 12, 1))
STEP = Group(DENSITY_BOATS, 0.31, 32, 8, 0.02)
KINDS = (MAIN, *NOISES, *SIZES, STEP)
LEARNED = "learned"


def cells(group: Group) -> list[Cell]:
    """Return who leads in flocks of a kind, the flocks without leaders first."""
    k = group.share
    if group == MAIN:
        law = [Cell(LAW, 1), Cell(LAW, 2), Cell(LAW, 3), Cell(LAW, 6)]
        law += [Cell(LAW, 2, 1), Cell(LAW, 3, 1)]
        return [FREE, *law, Cell(LEARNED, 1), Cell(LEARNED, 2), Cell(LEARNED, 2, 1)]
    if group.n_boats == DENSITY_BOATS:
        return [FREE, Cell(LAW, 3)]
    return [FREE, Cell(LAW, k), Cell(LAW, 2 * k), Cell(LAW, 2 * k, k), Cell(LEARNED, k)]


def design() -> list[Row]:
    """Return the runs, a share of every kind's seeds after the other, 27 boats at 0.31 s first."""
    found = []
    for group in KINDS:
        seeds = ALONE_SEEDS if group == MAIN else group.seeds
        for seed in range(seeds):
            kept = cells(group) if seed < group.seeds else [FREE, Cell(LAW, 1)]
            soon = 0.25 if group == MAIN else 1.0
            found += [(soon * seed / seeds, group, cell, seed) for cell in kept]
    return [
        {"n_boats": group.n_boats, "bw_s": group.bw_s, "dt_s": group.dt_s, **cell._asdict()}
        | {"states": group.states, "minutes": MINUTES, "seed": FIRST + seed}
        for _, group, cell, seed in sorted(found, key=lambda each: each[0])
    ]


def cycles(row: Row) -> int:
    """Return the whole cycles of a branch."""
    return int(60.0 * row["minutes"] / (CYCLE_S + row["bw_s"]))


def by_boat(run: flockenv.Recording) -> np.ndarray:
    """Return sin φ and the tangential velocity of each boat, shape (2, cycles, boats)."""
    seen = run.analyzed(0.0)
    boats = seen.pose.shape[1]
    each = flockenv.order_series(seen.pose.reshape(-1, 1, 3), seen.velocity.reshape(-1, 1, 3))
    both = np.stack([each.rotation(), each.psi_v * np.sin(each.phi_v)])
    return both.reshape(2, -1, ANALYZED, boats).mean(axis=2)


def followed(row: Row, sides: Sequence[str], state: Any) -> flockenv.Recording:
    """Return a run from a state for the cycles of a branch, with the noise of the row's seed."""
    cycle_s = CYCLE_S + row["bw_s"]
    # Half a sample more than the last one, so that rounding does not lose it.
    length_s = (cycles(row) + 0.5 / SAMPLES) * cycle_s
    policy = steering(row) if sides else None
    parameters = of_pool(row, sides)
    return flockenv.simulate(
        parameters, seed_of(row), length_s, SAMPLES / cycle_s, policy=policy, start=state
    )


def trunk(row: Row) -> tuple[list[Any], np.ndarray]:
    """Return the states of a flock without leaders, and its boats in each cycle after the first."""
    return _trunk(*((name, row[name]) for name in ("n_boats", "bw_s", "dt_s", "minutes", "seed")))


@functools.lru_cache(maxsize=2)
def _trunk(*items: tuple[str, Any]) -> tuple[list[Any], np.ndarray]:
    row = dict(items)
    warm_s = WARM_CYCLES * (CYCLE_S + row["bw_s"])
    run = flockenv.simulate(of_pool(row), seed_of(row), 1.25 * warm_s, 1.0 / warm_s)
    states, found = [], []
    for _ in range(STRETCHES):
        states.append(run.state_at(run.time_s[-1]))
        run = followed(row, (), states[-1])
        found.append(by_boat(run))
    return states, np.concatenate(found, axis=1)


def response(row: Row) -> np.ndarray:
    """Return R by sin φ and by velocity in each cycle of a branch, shape (2, cycles)."""
    forth = ["cw"] * row["leaders"] + ["ccw"] * row["against"]
    back = ["ccw"] * row["leaders"] + ["cw"] * row["against"]
    states = trunk(row)[0][:: STRETCHES // row["states"]]
    halves = [
        (by_boat(followed(row, forth, state)) - by_boat(followed(row, back, state))) / 2.0
        for state in states
    ]
    return np.asarray(np.mean(halves, axis=0)[..., len(forth) :].mean(axis=-1))


def fluctuation(boats: np.ndarray, longest: int) -> np.ndarray:
    """Return K(0) − K(t) of pairs of boats at lags from 0 to the longest, shape (..., lags).

    It is the mean of half the product of two boats' changes over the lag, for pairs of different
    boats. `boats` has shape (..., cycles, boats).
    """
    count = boats.shape[-1]
    found = np.zeros((*boats.shape[:-2], longest + 1))
    for lag in range(1, longest + 1):
        change = boats[..., lag:, :] - boats[..., :-lag, :]
        pairs = change.sum(axis=-1) ** 2 - (change**2).sum(axis=-1)
        found[..., lag] = pairs.mean(axis=-1) / (2.0 * count * (count - 1))
    return found


def equal_times(boats: np.ndarray) -> Row:
    """Return ⟨m²⟩ of all boats, and what pairs of different boats have of it, in two halves."""
    count = boats.shape[-1]
    squared = boats.mean(axis=-1) ** 2
    pairs = (count * squared - (boats**2).mean(axis=-1)) / (count - 1)
    early, late = np.array_split(pairs, 2)
    return {"m_squared": squared.mean(), "pairs_early": early.mean(), "pairs_late": late.mean()}


def measure(row: Row) -> Row:
    """Return R, or K(0) − K(t) of flocks without leaders, in each window of time."""
    settled = dict.fromkeys(("m_squared", "pairs_early", "pairs_late"), np.nan)
    if row["leaders"]:
        found = response(row)
    else:
        boats = trunk(row)[1]
        lags, settled = fluctuation(boats, cycles(row)), equal_times(boats[0])
        # The window of a branch's first cycle lies half a cycle after its start.
        found = (lags[..., 1:] + lags[..., :-1]) / 2.0
    parts = np.split(found, ENDS, axis=-1)
    means = {
        f"{name}_{window}": part[place].mean() if part.size else np.nan
        for place, name in enumerate(NAMES)
        for window, part in enumerate(parts)
    }
    return means | settled


STUDY = Study("response/response", design, measure, lambda row: row["n_boats"] <= 100)
