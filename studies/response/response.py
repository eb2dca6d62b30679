"""Leaders as a linear response: branches of one state whose leaders head for opposite sides.

Written before the runs, but for a pilot with other seeds.

branches.py has the runs and what is measured of them.

Rules, with the bounds of the study of worth. The last window answers, and the one before it varies
the time.

1. **Linear:** k leaders respond as k times one if R_k / (k R_1) has an interval within 0.8 to 1.25.
2. **Opposed groups** add up if the interval of R less the sum of the groups' own responses lies
   within half of the response of the smaller group.
3. **Response and fluctuation:** the factor is R of three leaders (of one in 27 in larger flocks)
   per leader, over K(0) − K(t). It does not depend on the time (from 26 s on), the noise, the size
   or the step if its ratio to that of 27 boats at 0.31 s and 0.05 s in the last window has an
   interval within 2/3 to 3/2.
4. **Worth:** a learned leader moves more than one by the paper's law if R by the learned over R by
   the law is above 1.

A statement holds if the whole interval lies in its range, fails if it lies outside, and is open
otherwise. Beside m of the headings, the last window is judged by the mean tangential velocity.

Power, from a pilot with seeds from 900 000 on: 24 seeds with four states at 0.31 s, and 2 to 12
seeds at 0.2 s, at 0.5 s, of 400 and of 1600 boats. Half of an interval in the last window will be
about 0.12 for R_2 / (2 R_1), 0.2 of a leader for two against one, 10 % of the factor at 0.31 s,
20 % at 0.2 s and 45 % at 0.5 s, and 0.3 of the smaller group in 400 boats. From 52 to 103 s it is
one and a half times as much. So the factor at 0.5 s may stay open. In the pilot, K(0) − K(t) of
1600 boats was below 0 up to 103 s, so that one factor cannot hold there if that is so. Their runs
are few.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from docs.scripts.plots import draw_intervals, name_heights
from flockenv.comparison.figure import policy_colors
from flockenv.statistics import FEW
from studies.claim import Claims, Interval, bca, judging, unknown
from studies.picture import COLORS, curve, picture
from studies.response.branches import (
    FREE,
    KINDS,
    LAST,
    LEARNED,
    MAIN,
    NAMES,
    NOISES,
    SIZES,
    STUDY,
    Cell,
    Group,
    cells,
)
from studies.study import Options, main
from studies.worth.worth_runs import DENSITY_BOATS, LAW


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
