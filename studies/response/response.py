"""Leaders as a linear response: branches of one state whose leaders head for opposite sides.

Written before the runs, but for a pilot with other seeds.

**Branches.** A flock without leaders runs for about 8 minutes, and then on. At times a cycle of the
motors begins; from there two branches with the same noise run for 3.5 minutes: k of the boats lead,
to the one side or to the other. The response R is half the difference of m = Ψ_o sin φ_o of the
boats that do not lead, so that it is the same by either side in flocks that favor none. Opposed
groups change sides together. Values are means of the analysis window of each cycle, over windows
that end after 3, 6, 12 and 24 cycles (about 13, 26, 52 and 103 s) and at the end (207 s). A run is
a seed: the mean over its states. Intervals draw seeds, in all cells of a flock together.

**Fluctuations.** K(0) − K(t), where K is the correlation in time of two boats' sin φ in the same
flocks without leaders, over all pairs and times. In linear response theory a leader that pulls at
its own heading moves the other boats by a factor times this difference. ⟨m²⟩, which the study of worth takes,
also counts each boat with itself, which was nine tenths of it at 0.5 s in the pilot.

Rules, with the bounds of the study of worth. The last window answers, and the one before it varies the time.

1. **Linear:** k leaders respond as k times one if R_k / (k R_1) has an interval within 0.8 to 1.25.
2. **Opposed groups** add up if the interval of R less the sum of the groups' own responses lies
   within half of the response of the smaller group.
3. **Response and fluctuation:** the factor is R of three leaders (of one in 27 in larger flocks)
   per leader, over K(0) − K(t). It does not hang on the time (from 26 s on), the noise, the size or
   the step if its ratio to that of 27 boats at 0.31 s and 0.05 s in the last window has an interval
   within 2/3 to 3/2.
4. **Worth:** a learned leader moves more than one by the paper's law if R by the learned over R by
   the law is above 1.

A statement holds if the whole interval lies in its range, fails if it lies outside, and is open
otherwise. Beside m of the headings, the last window is judged by the mean tangential velocity.

Noises: 0.31 s is critical for 27 boats in the library's table; 0.2 s lies below, 0.4 and 0.5 s
above. Flocks of 100 and 400 are at their own critical noise by the study of sizes, 0.37 and 0.36 s;
1600 are at that of 400, as their own was not measured. Whether 8 minutes settle a flock is shown by
the correlation of pairs in the first and the second half of its stretches.

Power, from a pilot with seeds from 900 000 on: 24 seeds with four states at 0.31 s, and 2 to 12
seeds at 0.2 s, at 0.5 s, of 400 and of 1600 boats. Half of an interval in the last window will be
about 0.12 for R_2 / (2 R_1), 0.2 of a leader for two against one, 10 % of the factor at 0.31 s,
20 % at 0.2 s and 45 % at 0.5 s, and 0.3 of the smaller group in 400 boats. From 52 to 103 s it is
one and a half times as much. So the factor at 0.5 s may stay open. In the pilot, K(0) − K(t) of
1600 boats was below 0 up to 103 s, so that one factor cannot hold there if that is so. Their runs
are few.
"""

import functools
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

import flockenv
from docs.scripts.plots import draw_intervals, name_heights
from flockenv.comparison.figure import policy_colors
from flockenv.statistics import FEW
from studies.claim import Claims, Interval, bca, judging, unknown
from studies.study import COLORS, Options, Row, Study, curve, main, picture, seed_of
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


# --- judgment ------------------------------------------------------------------------------------


def of(table: pd.DataFrame, group: Group, chosen: Sequence[Cell], column: str) -> np.ndarray:
    """Return a column of cells by seed, shape (seeds, cells), NaN where a cell has no such seed."""
    own = table[(table["n_boats"] == group.n_boats) & (table["bw_s"] == group.bw_s)]
    own = own[own["dt_s"] == group.dt_s]
    series = [
        own[(own[["policy", "leaders", "against"]] == list(cell)).all(axis=1)]
        .set_index("seed")[column]
        .rename(place)
        for place, cell in enumerate(chosen)
    ]
    return pd.concat(series, axis=1).to_numpy(float)


def compared(groups: Sequence[np.ndarray], formula: Callable[..., Any]) -> Interval:
    """Return a formula of the means of cells, with its interval over the seeds of each group."""
    if any(len(each) < 3 or np.isnan(each).all(axis=0).any() for each in groups):
        return unknown()

    def of_means(*drawn: Any) -> Any:
        means = [np.moveaxis(np.nanmean(each, axis=-2), -1, 0) for each in drawn]
        return formula(*(mean for each in means for mean in each))

    return bca(groups, of_means)


def linear(table: pd.DataFrame, group: Group, policy: str, k: int, column: str) -> Interval:
    """Return the response to k times the fewest leaders over k times that to the fewest."""
    one = _fewest(group)
    both = of(table, group, [Cell(policy, k * one), Cell(policy, one)], column)
    return compared([both], lambda many, few: many / (k * few))


def rest(table: pd.DataFrame, group: Group, policy: str, k: int, column: str) -> Interval:
    """Return R of k times the fewest leaders against the fewest less the sum of their own.

    It is in responses of the fewest.
    """
    one = _fewest(group)
    sides = [Cell(policy, k * one, one), Cell(policy, k * one), Cell(policy, one)]
    found = of(table, group, sides, column)
    return compared([found], lambda both, ours, few: (both - ours + few) / few)


def _fewest(group: Group) -> int:
    return 1 if group.n_boats == DENSITY_BOATS else group.share


def factor(table: pd.DataFrame, group: Group, column: str) -> Interval:
    """Return the response per leader over the fluctuation."""
    found = of(table, group, [Cell(LAW, group.share), FREE], column)
    return compared([found], lambda led, free: led / group.share / free)


def factors(table: pd.DataFrame, group: Group, column: str, base: str) -> Interval:
    """Return a factor over that of 27 boats at 0.31 s in another column, the last window's."""
    ours = of(table, group, [Cell(LAW, group.share), FREE], column)
    theirs = of(table, MAIN, [Cell(LAW, MAIN.share), FREE], base)
    if group == MAIN:  # The same seeds.
        return compared([np.hstack([ours, theirs])], _quotient)
    per_leader = MAIN.share / group.share
    return compared([ours, theirs], lambda *four: per_leader * _quotient(*four))


def _quotient(led: Any, free: Any, led_there: Any, free_there: Any) -> Any:
    return (led / free) / (led_there / free_there)


def worth(table: pd.DataFrame, group: Group, column: str) -> Interval:
    """Return the response to learned leaders over that to as many by the paper's law."""
    k = _fewest(group)
    found = of(table, group, [Cell(LEARNED, k), Cell(LAW, k)], column)
    return compared([found], lambda learned, law: learned / law)


WINDOWS = ("0 to 13 s", "13 to 26 s", "26 to 52 s", "52 to 103 s", "103 to 207 s")
TIMES_S = (6.5, 19.5, 39.0, 78.0, 155.0)
POLICY_NAMES = {LAW: "paper's law", LEARNED: "learned"}
MULTIPLES = ((LAW, 2), (LAW, 3), (LAW, 6), (LEARNED, 2))
OPPOSED = ((LAW, 2, 1), (LAW, 3, 1), (LEARNED, 2, 1))


def multiples(group: Group) -> Sequence[tuple[str, int]]:
    """Return the policies and numbers, in fewest leaders, that are compared with the fewest."""
    return MULTIPLES if group == MAIN else MULTIPLES[:1]


def opposed(group: Group) -> Sequence[tuple[str, int, int]]:
    """Return the policies of opposed groups and their sizes, in fewest leaders."""
    return OPPOSED if group == MAIN else OPPOSED[:1]


def known(table: pd.DataFrame, groups: Sequence[Group]) -> list[Group]:
    """Return the main flock, and those with enough seeds for a bootstrap."""
    return [
        group
        for group in groups
        if group == MAIN or len(of(table, group, cells(group), f"m_{LAST}")) >= FEW
    ]


def judge(table: pd.DataFrame) -> Claims:
    """Judge the four rules by m in the last two windows, and by velocities in the last."""
    claims = Claims("beyond the paper", "", ours=True)
    for name, window in (("m", LAST), ("m", LAST - 1), ("velocity", LAST)):
        for group in known(table, (MAIN, *SIZES)):
            claims.reading = _reading(group)
            _judge_leaders(claims, table, group, name, window)
    for name in NAMES:
        for group in known(table, KINDS):
            claims.reading = _reading(group)
            for window in (LAST - 1, LAST - 2) if group == MAIN else (LAST,):
                claims.add(
                    "The response follows the fluctuations of leaderless flocks",
                    f"factor by {NAMES[name]}, {WINDOWS[window]} after the branch, over that of 27 "
                    f"boats at 0.31 s, {WINDOWS[LAST]}",
                    factors(table, group, f"{name}_{window}", f"{name}_{LAST}"),
                    least=2 / 3,
                    most=1.5,
                )
    return claims


def _judge_leaders(
    claims: Claims, table: pd.DataFrame, group: Group, name: str, window: int
) -> None:
    column, k = f"{name}_{window}", _fewest(group)
    when = f"by {NAMES[name]}, {WINDOWS[window]} after the branch"
    for policy, many in multiples(group):
        claims.add(
            "Leaders with one target respond as their number times the fewest",
            f"R of {many * k} over {many} R of {k}, {POLICY_NAMES[policy]}, {when}",
            linear(table, group, policy, many, column),
            least=0.8,
            most=1.25,
        )
    for policy, ours, theirs in opposed(group):
        claims.add(
            "Two groups with opposite targets respond as the sum of their own responses",
            f"R of {ours * k} against {theirs * k} less the sum, in R of {k}, "
            f"{POLICY_NAMES[policy]}, {when}",
            rest(table, group, policy, ours, column),
            least=-0.5,
            most=0.5,
        )
    claims.add(
        "A learned leader moves the flock more than one by the paper's law",
        f"R of {k} learned over R of {k} by the paper's law, {when}",
        worth(table, group, column),
        least=1.0,
    )


def _reading(group: Group) -> str:
    return f"simulation, n = {group.n_boats}, bw = {group.bw_s:g} s, dt = {group.dt_s:g} s"


# --- picture -------------------------------------------------------------------------------------


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw the response per leader in time, what adds up, and the factor against the noise."""
    with picture(options, "response", height_cm=15.0) as figure:
        (times, sums), (noises, rests) = figure.subplots(2, 2)
        _draw_times(times, table)
        alone = {
            _name(group, policy, many): linear(table, group, policy, many, f"m_{LAST}")
            for group in known(table, (MAIN, *SIZES))
            for policy, many in multiples(group)
        }
        _draw_range(sums, alone, 0.8, 1.25, "response over that of\nthe fewest, times their number")
        against = {
            _name(group, policy, ours, theirs): rest(table, group, policy, ours, f"m_{LAST}")
            for group in known(table, (MAIN, *SIZES))
            for policy, ours, theirs in opposed(group)
        }
        _draw_range(
            rests,
            against,
            -0.5,
            0.5,
            "response of opposed groups less\nthe sum, in the smaller group's",
        )
        _draw_noises(noises, table)


def _draw_times(axes: Axes, table: pd.DataFrame) -> None:
    colors = policy_colors(POLICY_NAMES.values())
    led = [*(Cell(LAW, k) for k in (1, 2, 3, 6)), Cell(LEARNED, 1)]
    for place, (cell, marker) in enumerate(zip(led, "os^Dv", strict=True)):
        found = [
            compared([of(table, MAIN, [cell], column)], lambda each, k=cell.leaders: each / k)
            for column in _in_time()
        ]
        style = {"color": colors[POLICY_NAMES[cell.policy]], "marker": marker}
        label = f"{cell.leaders}{', learned' if cell.policy == LEARNED else ''}"
        curve(axes, np.array(TIMES_S) + 3.0 * (place - 2), found, label=label, **style)
    scale = factor(table, MAIN, f"m_{LAST}")[0]
    free = [
        compared([of(table, MAIN, [FREE], column)], lambda each: scale * each)
        for column in _in_time()
    ]
    curve(axes, TIMES_S, free, color="0.4", linestyle="--", marker="", label="fluctuations")
    axes.set(xlabel="time after the branch (s)", ylabel="m per leader")
    axes.legend(title="leaders, by the paper's law or learned", **_ABOVE | {"ncols": 3})


_ABOVE = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "ncols": 2}


def _in_time() -> list[str]:
    return [f"m_{window}" for window in range(LAST + 1)]


def _draw_range(
    axes: Axes, found: dict[str, Interval], least: float, most: float, label: str
) -> None:
    axes.axvspan(least, most, color="0.93", zorder=0)
    draw_intervals(axes, range(len(found)), [*found.values()], color=COLORS[0])
    name_heights(axes, found)
    axes.set_xlabel(label)


def _draw_noises(axes: Axes, table: pd.DataFrame) -> None:
    base = factor(table, MAIN, f"m_{LAST}")
    axes.axhspan(2 / 3 * base[0], 1.5 * base[0], color="0.93", zorder=0)
    sizes = [[group] for group in known(table, SIZES)]
    for place, groups in enumerate([known(table, (MAIN, *NOISES)), *sizes]):
        at = [group.bw_s + 0.006 * place for group in groups]
        found = [factor(table, group, f"m_{LAST}") for group in groups]
        label = f"{groups[0].n_boats} boats"
        curve(axes, at, found, color=COLORS[place], linestyle="", label=label)
    axes.set(xlabel="bw (s)", ylabel="factor")
    axes.legend(**_ABOVE)


def _name(group: Group, policy: str, many: int, against: int = 0) -> str:
    k = _fewest(group)
    who = f"{many * k} against {against * k}" if against else f"{many * k}"
    learned = ", learned" if policy == LEARNED else ""
    return f"{who} of {group.n_boats}{learned}"


script = judging("response", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
