"""Is the jamming–order transition of first order? Lifetimes of a jam and of a rotating flock.

The rules of the answer stand in README.md.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pandas as pd

from flockenv.statistics import kaplan_meier
from studies.claim import (
    FAILS,
    HOLDS,
    Claim,
    Claims,
    Interval,
    bca,
    mean,
    proportion,
    unknown,
    write_claims,
)
from studies.picture import COLORS, curve, picture
from studies.section4.fig08 import slope
from studies.store import write
from studies.study import Options, main
from studies.transition.outside import write_outside
from studies.transition.transition_runs import AFTER_MIN, C4, LITERAL, LONG, STARTED, STUDY


def second(table: pd.DataFrame) -> pd.DataFrame:
    """Return the runs by the second rule: when they leave their state, if they do.

    A run that ends in its own state has not left it, though its jam may have split.
    """
    own = _in(table, own=True)
    after = table.get("after_min", AFTER_MIN)
    ended = np.minimum(table["stayed_min"] + after * table["exited"], table["minutes"])
    return table.assign(
        exited=(~own).astype(int), stayed_min=table["stayed_min"].where(~own, ended)
    )


def doubling(table: pd.DataFrame, start: str) -> Interval:
    """Return by what the rate of exits is multiplied as the flock doubles, largest over smallest.

    A half exit is added to each size, so that sizes without exits have a rate too. Where no run of
    any size leaves its start there is nothing to compare.
    """
    chosen = table[table["start"] == start]
    sizes = sorted(chosen["n_boats"].unique())
    if len(sizes) < 3 or not chosen["exited"].any():
        return unknown()
    groups = [
        chosen.loc[chosen["n_boats"] == n, ["stayed_min", "exited"]].to_numpy() for n in sizes
    ]

    def factor(*runs: np.ndarray) -> np.ndarray:
        rates = [(each[..., 1].sum(-1) + 0.5) / each[..., 0].sum(-1) for each in runs]
        return np.asarray(2.0 ** slope(list(np.log2(sizes)), [np.log2(each) for each in rates]))

    return bca(groups, factor)


RULES = {
    "first": ("stays so for two hours", "runs that stay"),
    "second": (
        "ends its run in that state",
        "runs that end in jams (|m| < 0.5, at least half of the boats in jams) or rotating",
    ),
}
"""What each rule counts, in words."""


def judge(table: pd.DataFrame, rule: str, suffix: str = "") -> Claims:
    """Judge a rule of transition.md, at each coverage and noise."""
    claims = Claims("5.2, left open", "", ours=True)
    lasts, counted = RULES[rule]
    by = ["coverage", "scheme", "c4", "dt_s"]
    for (coverage, scheme, c4, dt_s), group in table.groupby(by, sort=False):
        noise = "per-step" if scheme == "paper" else "white"
        claims.reading = (
            f"{scheme}, {noise} c4 = {c4:g}, dt = {dt_s:g} s, coverage {coverage:g}{suffix}"
        )
        for start, words in STARTED.items():
            chosen = group[group["start"] == start]
            for n, runs in chosen.groupby("n_boats"):
                claims.add(
                    f"A flock that starts {words} {lasts}",
                    f"share of {counted}; read as at least half",
                    proportion((runs["exited"] == 0).sum(), len(runs)),
                    least=0.5,
                    n=f"{n:g}",
                )
                stayed = runs.loc[runs["exited"] == 0, "drift_per_h"].dropna()
                if rule == "first" and start == "one-jam" and len(stayed):
                    claims.add(
                        "A jam that stays does not shrink",
                        "drift of the largest jam's share of the boats in the runs that stay (1/h)",
                        mean(stayed),
                        least=-0.05,
                        n=f"{n:g}",
                    )
            claims.add(
                f"The larger a flock that starts {words}, the longer it stays so ({rule} rule)",
                "factor of exits per hour for each doubling of n",
                doubling(group, start),
                most=1.0,
                n=", ".join(f"{n:g}" for n in sorted(chosen["n_boats"].unique())),
            )
    return claims


def bistable(table: pd.DataFrame) -> Claims:
    """Judge whether both states come from either start, in the cell where the rarest is least rare.

    The states are those of the second rule. Flocks that only stay in the state they start in may be
    in a transient of each.
    """
    claims = Claims("5.2", "")
    white = table[(table["scheme"] == "leapfrog") & (table["dt_s"] == 0.1)]
    other = white.assign(other=_in(white, own=False).astype(int))
    for n, runs in other.groupby("n_boats"):
        turned = runs.groupby(["c4", "coverage", "start"])["other"].agg(["sum", "size"])
        cells = (turned["sum"] / turned["size"]).unstack("start").min(axis=1)
        c4, coverage = cells.idxmax()
        start = (turned["sum"] / turned["size"]).loc[c4, coverage].idxmin()
        count, of = turned.loc[c4, coverage, start]
        claims.reading = f"leapfrog, white c4 = {c4:g}, dt = 0.1 s, coverage {coverage:g}"
        quantity = f"runs that end in the other state, {STARTED[start]} at first, the rarer of both"
        claims.exists("The transition is bistable", quantity, int(count), int(of), n=f"{n:g}")
    return claims


def side_by_side(table: pd.DataFrame) -> Claims:
    """Judge whether jams last beside rotation in one flock, two hours after a split or longer."""
    claims = Claims("5.2", "", ours=True)
    jams = table[table["start"] == "one-jam"]
    both = jams.assign(both=(abs(jams["m"]) >= 0.5) & (jams["in_jams"] >= 0.1))
    for (coverage, n), runs in both.groupby(["coverage", "n_boats"]):
        claims.reading = f"leapfrog, white c4 = {C4[0]:g}, dt = 0.1 s, coverage {coverage:g}"
        quantity = "runs that end with |m| of at least 0.5 and a tenth of the boats in jams"
        count, of = int(runs["both"].sum()), len(runs)
        claims.exists("Jams last beside rotation in one flock", quantity, count, of, n=f"{n:g}")
    return claims


def _in(table: pd.DataFrame, own: bool) -> pd.Series:
    """Return whether runs end in the state that they started in, or in the other one."""
    rotates = abs(table["m"]) >= 0.5
    jammed = ~rotates & (table["in_jams"] >= 0.5)
    return jammed.where((table["start"] == "one-jam") == own, rotates)


def answers(found: Mapping[str, Claims]) -> pd.DataFrame:
    """Return a line for each noise and coverage: what each rule says of it, and by what numbers.

    The numbers are the share of the runs of the largest flocks that keep their state, and the
    factor of exits for each doubling, from both starts.
    """
    lines: dict[str, dict[str, str]] = {}
    for rule, claims in found.items():
        cells: dict[str, list[Claim]] = {}
        for each in claims:
            cells.setdefault(each.reading.partition(", n = ")[0], []).append(each)
        for cell, judged in cells.items():
            line = lines.setdefault(cell, {"cell": cell})
            line |= {f"{rule} rule": _answer(judged), **_numbers(rule, judged)}
    return pd.DataFrame(lines.values())


def _shares(judged: list[Claim]) -> list[Claim]:
    """Return the shares of the largest flocks."""
    shares = [each for each in judged if each.quantity.startswith("share")]
    boats = [int(each.reading.rpartition("n = ")[2]) for each in shares]
    return [each for each, n in zip(shares, boats, strict=True) if n == max(boats)]


def _answer(judged: list[Claim]) -> str:
    """Return what a rule says of a cell: for, against or open."""
    largest = _shares(judged)
    asked = [each for each in judged if each in largest or not each.quantity.startswith("share")]
    refutes = [each for each in asked if not each.quantity.startswith("drift")]
    if any(each.verdict == FAILS for each in refutes):
        return "against"
    return "for" if all(each.verdict == HOLDS for each in asked) else "open"


def _numbers(rule: str, judged: list[Claim]) -> dict[str, str]:
    largest = _shares(judged)
    numbers = {f"{rule}: boats": largest[0].reading.rpartition("n = ")[2]}
    for start, words in STARTED.items():
        for name, each in [("share kept", each) for each in largest] + [
            ("exits per doubling", each) for each in judged if each.quantity.startswith("factor")
        ]:
            if f"starts {words}" in each.claim:
                value, low, high = each.found.texts()
                numbers[f"{rule}: {name}, {start}"] = f"{value} ({low} to {high})"
    return numbers


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw how many runs are still in the state they started in, by noise and size."""

    def lifetimes(axes: Any, place: int, n: float, runs: pd.DataFrame) -> None:
        times = runs["stayed_min"].where(runs["exited"] == 1, np.inf)
        left = kaplan_meier(times, runs["stayed_min"])
        x = [0.0, *left.time_s, runs["stayed_min"].max()]
        y = [1.0, *left.share, left.share_at(math.inf)]
        label = f"n = {n:g} ({len(runs)} runs)"
        axes.step(x, y, where="post", color=COLORS[place], label=label)

    shown = (table["dt_s"] == 0.1) | (table["scheme"] == "paper")
    noises = _by_noise(table[shown & (table["coverage"] == 0.5)])
    _panels(options, "transition", noises, lifetimes, "time (min)", "still {}")


def draw_map(options: Options, name: str, table: pd.DataFrame, up: str) -> None:
    """Draw the share of flocks that stay in their state against the wall coverage."""

    def shares(axes: Any, place: int, n: float, runs: pd.DataFrame) -> None:
        kept = [(x, each["exited"] == 0) for x, each in runs.groupby("coverage")]
        found = [proportion(stays.sum(), len(stays)) for _, stays in kept]
        x = [coverage + 0.006 * place for coverage, _ in kept]
        style = {"color": COLORS[place], "marker": "os^D"[place], "label": f"n = {n:g}"}
        curve(axes, x, found, **style)

    white = table[(table["scheme"] == "leapfrog") & (table["dt_s"] == 0.1)]
    _panels(options, name, _by_noise(white), shares, "wall coverage", up)


def draw_long(options: Options, table: pd.DataFrame) -> None:
    """Draw the share of boats in jams at the end of runs that are followed for two hours."""
    edges = np.linspace(0.0, 1.0, 11)

    def histogram(axes: Any, place: int, n: float, runs: pd.DataFrame) -> None:
        counts = np.histogram(runs["in_jams"], edges)[0] / len(runs)
        axes.stairs(counts, edges, color=COLORS[place], label=f"n = {n:g}")

    across = "share of boats in jams at the end"
    coverages = [(f"coverage {each:g}", runs) for each, runs in table.groupby("coverage")]
    _panels(options, "transition_long", coverages, histogram, across, "share of runs,\n{} first")


def _by_noise(table: pd.DataFrame) -> list[tuple[str, pd.DataFrame]]:
    """Return the runs of each noise with its name."""
    return [
        ("literal" if scheme == "paper" else f"c4 = {c4:g}", runs)
        for (scheme, c4), runs in table.groupby(["scheme", "c4"])
    ]


def _panels(
    options: Options,
    name: str,
    columns: list[tuple[str, pd.DataFrame]],
    plot: Callable[..., None],
    across: str,
    up: str,
) -> None:
    """Draw sizes apart, a column of panels for each noise or coverage; the first has all sizes."""
    with picture(options, name, height_cm=9.0) as figure:
        panels = figure.subplots(2, len(columns), sharex=True, sharey=True, squeeze=False)
        for column, (title, group) in zip(panels.T, columns, strict=True):
            column[0].set_title(title)
            for axes, start in zip(column, STARTED, strict=True):
                sizes = group[group["start"] == start].groupby("n_boats")
                for place, (n, runs) in enumerate(sizes):
                    plot(axes, place, n, runs)
                axes.set_ylim(-0.05, 1.05)
        for axes, words in zip(panels[:, 0], STARTED.values(), strict=True):
            axes.set_ylabel(up.format(words))
        figure.supxlabel(across)
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=4)


def script(options: Options) -> None:
    """Make the map, judge and draw it."""
    table = pd.concat([STUDY.results(options), LITERAL.results(options)], ignore_index=True)
    found = {"first": judge(table, "first"), "second": judge(second(table), "second")}
    long = LONG.results(options)
    write_claims(options, "transition", [*bistable(table), *side_by_side(long)])
    if len(table):
        draw(options, table)
        draw_map(options, "transition_map", table, "stays {}")
        draw_map(options, "transition_map_second", second(table), "starts {},\nends so")
        _write_answers(options, "answers", answers(found))
        write_outside(options, table)
    if len(long):
        draw_long(options, long)
        _write_answers(options, "answers_long", answers({"second": judge(second(long), "second")}))


def _write_answers(options: Options, name: str, lines: pd.DataFrame) -> None:
    path = options.folder / f"{name}.csv"
    write(path, lines.to_csv(index=False, lineterminator="\n").encode())
    rules = [column for column in lines if column.endswith(" rule")]
    for _, line in lines.iterrows():
        print(f"{line['cell']}: {', '.join(f'{rule}: {line[rule]}' for rule in rules)}")
    print(f"{len(lines)} cells: {path}")


if __name__ == "__main__":
    main(script)
