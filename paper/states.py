"""Figures 4 to 6 and Table 2: the states of a flock, how long they last, how it changes them."""

import math
from itertools import pairwise

import numpy as np
import pandas as pd
from claim import Claims, judging, mean
from section4 import LOW_S, MEDIUM_S, READING, over, within, words
from state_series import cycles, onset
from study import COLORS, SEEDS, Options, Row, Study, curve, main, picture, simulated

LEVELS_S = (1.4, 1.9, 0.4, 0.8, 1.2, 1.6, 2.4, 2.8)
STATES = ("jamming", "clustering", "ordered", "disordered", "between")


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
    ways = np.where(every == "ordered", np.sign(found["m"]), 0.0)
    bounds = np.flatnonzero(np.diff(ways, prepend=9.0, append=9.0))
    period_s = np.diff(found["time_s"]).mean() if len(found) > 1 else math.nan
    lengths = [e - s for s, e in pairwise(bounds) if ways[s] != 0]
    taken = ways[ways != 0]
    ordered = every == "ordered"
    return {
        **{state: (every == state).mean() for state in STATES},
        "longest_min": max(lengths, default=0) * period_s / 60.0,
        "turns": int((taken[1:] != taken[:-1]).sum()),
        "left": int((ordered[:-1] & ~ordered[1:]).sum()),
        "ordered_min": ordered.sum() * period_s / 60.0,
        "psi_o_late": found["psi_o"][len(found) // 2 :].mean(),
        "psi_o": found["psi_o"].mean(),
        **onset(found),
    }


STUDY = Study("states", design, measure)


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
    runs = within(table, 0.8, 1.4).dropna(subset="lead_s")
    onset = runs.groupby("seed").mean(numeric_only=True)
    claims.add(
        "Orientations signal the coming order earlier than velocities",
        "time by which Ψ_o is halfway to order before Ψ_v (s), bw 0.8 to 1.4 s",
        mean(onset["lead_s"]),
        least=0.0,
    )
    claims.add(
        "Velocities change more abruptly than orientations",
        "rise of Ψ_v minus that of Ψ_o, from 10 to 90 % (s), bw 0.8 to 1.4 s",
        mean(onset["rise_v_s"] - onset["rise_o_s"]),
        most=0.0,
    )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw Table 2 as shares of states against noise."""
    with picture(options, "table2", width_cm=12.0, height_cm=6.5) as figure:
        axes = figure.subplots()
        for place, (state, marker) in enumerate(zip(STATES, "^vosD", strict=True)):
            groups = table.groupby("bw_s")[state]
            x = np.array(list(groups.groups)) + 0.015 * (place - 2)
            found = [mean(each) for _, each in groups]
            curve(axes, x, found, color=COLORS[place], marker=marker, label=state)
        axes.set(xlabel="bw (s)", ylabel="share of cycles", ylim=(-0.03, 1.03))
        axes.set_title(f"27 boats, no leaders, {table['seed'].nunique()} runs of 16 min per level")
        axes.legend(loc="center right")


script = judging("states", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
