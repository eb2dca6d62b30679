"""Figures 5 and 6 and Table 2: the states of a flock, how long they last, how it changes them."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd

import flockenv
from flockenv.statistics.structure import structure_series
from studies.claim import Claims, Interval, judging, mean
from studies.picture import COLORS, PAPERS_LINE, curve, picture
from studies.section4.section4 import LOW_S, MEDIUM_S, READING, over, within, words
from studies.study import SEEDS, Options, Row, Study, main, simulated

LEVELS_S = (1.4, 1.9, 0.4, 0.8, 1.2, 1.6, 2.4, 2.8)
STATES = ("jamming", "clustering", "ordered", "disordered", "between")
_TYPICAL = {
    "jamming": "low noise",
    "clustering": "middle",
    "ordered": "low to middle",
    "disordered": "high",
}
"""The typical noise level of each state in the paper's Table 2."""
_STAYS = 3
"""Cycles in a row for which a series stays above a level that it has reached."""


def cycles(run: flockenv.Recording) -> pd.DataFrame:
    """Return means over each analysis window, and its most frequent state."""
    used = np.flatnonzero(run.in_analysis_window)
    clusters = np.zeros(len(run.time_s))
    clusters[used] = structure_series("largest_cluster", run.parameters, run.pose[used])
    states = run.order.states(run.parameters.speed_cm_s, clusters)[used]
    window = np.cumsum(np.diff(run.time_s[used], prepend=-10.0) > 1.0)
    order = run.order
    frames = pd.DataFrame(
        {
            "window": window,
            "time_s": run.time_s[used],
            "psi_o": order.psi_o[used],
            "psi_v": order.psi_v[used],
            "m": order.rotation()[used],
            "outward": order.outward()[used],
        }
    )
    found = frames.groupby("window").mean()
    names = pd.Series([s.partition(" ")[0] for s in states]).groupby(window).agg(_most_frequent)
    return found.assign(state=names.to_numpy())


def _most_frequent(names: Any) -> str:
    return str(names.value_counts().index[0])


def ways(found: pd.DataFrame) -> Any:
    """Return +1 for cycles that are ordered clockwise, -1 for the other way, 0 for the rest."""
    return np.where(found["state"] == "ordered", np.sign(found["m"]), 0.0)


def cycle_min(found: pd.DataFrame) -> float:
    """Return the length of a cycle in minutes; NaN for a run of one cycle."""
    return np.diff(found["time_s"]).mean() / 60.0 if len(found) > 1 else math.nan


def longest_min(found: pd.DataFrame) -> float:
    """Return the longest stretch of order one way in minutes; 0 without order."""
    taken = ways(found)
    bounds = np.flatnonzero(np.diff(taken, prepend=9.0, append=9.0))
    lengths = [end - start for start, end in pairwise(bounds) if taken[start] != 0]
    return max(lengths, default=0) * cycle_min(found)


def onset(found: pd.DataFrame) -> Row:
    """Return how much earlier Ψ_o is halfway to order than Ψ_v, and how long each rises (s).

    Of runs whose second half rotates (mean |m| of at least 0.5). A series is halfway when it has
    come half of the way from its first two cycles to its mean over the second half and stays
    above for three cycles; it rises from a tenth to nine tenths.
    """
    late = found[len(found) // 2 :]
    none = {"lead_s": math.nan, "rise_o_s": math.nan, "rise_v_s": math.nan}
    if not abs(late["m"]).mean() >= 0.5:
        return none
    reached = {}
    for name in ("psi_o", "psi_v"):
        start, end = found[name][:2].mean(), late[name].mean()
        way = ((found[name] - start) / (end - start)).to_numpy()
        held = np.lib.stride_tricks.sliding_window_view(way, _STAYS).min(axis=1)
        if held.max() < 0.9:
            return none
        reached[name] = [found["time_s"].iloc[int((held >= x).argmax())] for x in (0.1, 0.5, 0.9)]
    o, v = reached["psi_o"], reached["psi_v"]
    return {"lead_s": v[1] - o[1], "rise_o_s": o[2] - o[0], "rise_v_s": v[2] - v[0]}


def onsets(runs: pd.DataFrame) -> tuple[Interval, Interval]:
    """Return how much earlier Ψ_o comes than Ψ_v, and by how much longer Ψ_v rises (s), by seed."""
    found = runs.dropna(subset="lead_s").groupby("seed").mean(numeric_only=True)
    return mean(found["lead_s"]), mean(found["rise_v_s"] - found["rise_o_s"])


def design() -> list[Row]:
    """Return runs of 16 minutes without leaders, those of figures 5 and 6 first."""
    return [
        {"preset": "experiment", "n_leaders": 0, "bw_s": bw_s, "minutes": 16.0, "seed": seed}
        for seed in range(SEEDS)
        for bw_s in LEVELS_S
    ]


def measure(row: Row) -> Row:
    """Return shares of states, the longest order, changes of direction, and how order comes."""
    found = cycles(simulated(row, sample_hz=5.0))
    every = found["state"].to_numpy()
    taken = ways(found)[ways(found) != 0]
    ordered = every == "ordered"
    return {
        **{state: (every == state).mean() for state in STATES},
        "longest_min": longest_min(found),
        "turns": int((taken[1:] != taken[:-1]).sum()),
        "left": int((ordered[:-1] & ~ordered[1:]).sum()),
        "ordered_min": ordered.sum() * cycle_min(found),
        "psi_o_late": found["psi_o"][len(found) // 2 :].mean(),
        "psi_o": found["psi_o"].mean(),
        **onset(found),
    }


STUDY = Study("section4/states", design, measure)


def judge(table: pd.DataFrame) -> Claims:
    """Judge Sections 4.1 and 4.2 on flocks without leaders."""
    claims = Claims("4.1, 4.2", f"{READING}, no leaders")
    for state in STATES[:4]:
        seen = (table[state] > 0.0).groupby(table["seed"]).any()
        name = {"ordered": "Ordered motion", "disordered": "Disordered motion"}.get(
            state, state.capitalize()
        )
        claims.exists(
            f"{name} is observed", "seeds with a cycle in this state", seen.sum(), len(seen)
        )

    def share(text: str, states: list[str], ends: tuple[float, float], **claimed: float) -> None:
        runs = within(table, *ends)
        each = runs[states].sum(axis=1).groupby(runs["seed"]).mean()
        read = " and ".join(f"at {name} {bound:g}" for name, bound in claimed.items())
        what = f"share of cycles, {words(ends)}; read as {read}"
        claims.add(text, what, mean(each), **claimed)

    share("Jamming occurs sometimes at low noise", ["jamming"], LOW_S, least=0.005, most=0.5)
    share("Clustering is rare", ["clustering"], (0.4, 2.8), most=0.02)
    share(
        "Ordered motion is regular at low to middle noise",
        ["ordered"],
        (LOW_S[0], MEDIUM_S[1]),
        least=0.5,
    )
    share("Disordered motion is regular at high noise", ["disordered"], (2.4, 2.8), least=0.9)
    low, high = within(table, *LOW_S), within(table, 1.6, 1.9)
    rates = [
        r.groupby("seed")["left"].sum() / (r.groupby("seed")["ordered_min"].sum() + 0.1)
        for r in (low, high)
    ]
    claims.add(
        "Ordered motion is stable at low and unstable at high noise",
        f"changes out of order per min in it, {words(LOW_S)} minus 1.6 to 1.9 s",
        mean(rates[0] - rates[1]),
        most=0.0,
    )
    at14, at19 = within(table, 1.4, 1.4), within(table, 1.9, 1.9)
    claims.add(
        "Stable order lasts for long at bw = 1.4 s",
        "longest stretch of order one way in 16 min (min); the paper's lasts at least 5",
        mean(at14["longest_min"]),
        least=5.0,
    )
    claims.add(
        "Ordered states exist only for short periods at bw = 1.9 s",
        "longest stretch of order one way in 16 min (min), read as above 0 and at most 5",
        mean(at19["longest_min"]),
        least=0.05,
        most=5.0,
    )
    claims.add(
        "Correlations at bw = 1.9 s are much lower than at 1.4 s",
        "mean Ψ_o at bw = 1.9 s minus that at 1.4 s, same seeds; read as at most -0.2",
        mean(over(table, "psi_o", 1.9, 1.9) - over(table, "psi_o", 1.4, 1.4)),
        most=-0.2,
    )
    claims.exists(
        "The direction of a moving flock can change at bw = 1.9 s",
        "runs of 16 min with a change of direction between two stretches of order",
        (at19["turns"] > 0).sum(),
        len(at19),
    )
    leads, rises = onsets(within(table, 0.8, 1.4))
    claims.add(
        "Orientations signal the coming order earlier than velocities",
        "time by which Ψ_o is halfway to order before Ψ_v (s), bw 0.8 to 1.4 s",
        leads,
        least=0.0,
    )
    claims.add(
        "Velocities change more abruptly than orientations",
        "rise of Ψ_v minus that of Ψ_o, from 10 to 90 % (s), bw 0.8 to 1.4 s",
        rises,
        most=0.0,
    )
    return claims


@dataclass(frozen=True)
class Series:
    """A figure of one run over time, and what the paper's caption says of its own run.

    Attributes
    ----------
    bw_s
        Its noise.
    at_min
        Minutes that the caption names.
    ways
        Angles φ_o that it names, each with the minutes from which and until which they hold.
    words
        The same in words.
    """

    bw_s: float
    at_min: tuple[float, ...]
    ways: tuple[tuple[float, float, float], ...]
    words: str


_SERIES = {
    "fig05": Series(
        1.4,
        (2.5, 5.0),
        ((0.0, 1.5, 3.5), (-np.pi / 2, 5.0, 16.0)),
        "paper: its jam peaks at 2.5 min, and from 5 min on it circles counter-clockwise",
    ),
    "fig06": Series(
        1.9,
        (8.5,),
        ((np.pi / 2, 0.0, 8.5), (-np.pi / 2, 8.5, 16.0)),
        "paper: around 8.5 min it turns from clockwise to counter-clockwise",
    ),
}


def median_run(table: pd.DataFrame, bw_s: float) -> pd.DataFrame:
    """Return the cycles of the run whose mean Ψ_o is the median of its level.

    All runs of the level are made again, so that the picture is of this code's version.
    """
    rows = table[np.isclose(table["bw_s"], bw_s)].to_dict("records")
    found = [cycles(simulated(row | {"n_leaders": 0}, sample_hz=5.0)) for row in rows]
    return sorted(found, key=lambda run: run["psi_o"].mean())[len(found) // 2]


def draw_series(options: Options, table: pd.DataFrame) -> None:
    """Draw figures 5 and 6: order parameters over time, of the median run of a level."""
    for name, series in _SERIES.items():
        found = median_run(table, series.bw_s)
        minutes = found["time_s"] / 60
        with picture(options, name, height_cm=6.2) as figure:
            left, middle, right = figure.subplots(1, 3, sharex=True)
            left.plot(minutes, found["psi_o"], color=COLORS[0])
            left.set(ylabel="Ψ_o", ylim=(0, 1))
            middle.plot(minutes, np.arctan2(found["m"], found["outward"]), ".", color=COLORS[1])
            middle.set(ylabel="φ_o", yticks=[-np.pi / 2, 0, np.pi / 2], ylim=(-3.2, 3.2))
            middle.set_yticklabels(["−π/2", "0", "π/2"])
            right.plot(minutes, found["psi_v"], color=COLORS[2])
            right.set(ylabel="Ψ_v (cm/s)", ylim=(0, None))
            for axes in (left, middle, right):
                axes.set_xlabel("time (min)")
                for at_min in series.at_min:
                    axes.axvline(at_min, **PAPERS_LINE)
            for angle, *ends in series.ways:
                middle.plot(ends, [angle, angle], **PAPERS_LINE)
            runs = int(np.isclose(table["bw_s"], series.bw_s).sum())
            about = f"bw = {series.bw_s:g} s, 27 boats, no leaders: the median of {runs} runs"
            figure.suptitle(f"{about}\ndashed, {series.words}")


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw Table 2 as shares of states against noise, and figures 5 and 6."""
    draw_series(options, table)
    with picture(options, "table2", width_cm=12.0, height_cm=8.5) as figure:
        axes = figure.subplots()
        for place, (state, marker) in enumerate(zip(STATES, "^vosD", strict=True)):
            groups = table.groupby("bw_s")[state]
            x = np.array(list(groups.groups)) + 0.015 * (place - 2)
            found = [mean(each) for _, each in groups]
            label = f"{state} (paper: {_TYPICAL[state]})" if state in _TYPICAL else state
            curve(axes, x, found, color=COLORS[place], marker=marker, label=label)
        axes.set(xlabel="bw (s)", ylabel="share of cycles", ylim=(-0.03, 1.03))
        axes.set_title(f"27 boats, no leaders, {table['seed'].nunique()} runs of 16 min per level")
        figure.legend(loc="outside lower center", ncols=2)


script = judging("states", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
