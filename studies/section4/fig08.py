"""Figure 8: the time that a flock needs to order, against noise, with and without leaders."""

from typing import Any

import numpy as np
import pandas as pd

from flockenv.statistics import kaplan_meier
from studies.claim import Claims, Interval, bca, judging, mean, unknown
from studies.picture import COLORS, picture
from studies.section4.section4 import CW, FREE, READING, STUDY, at, setup, within
from studies.study import Options, main

END_S = 480.0
_PAPERS_P = {CW: 0.01, FREE: 0.003}
"""The paper's p that the time to order does not fall with noise."""
ANGLES = {"ordered_quarter_s": "π/4", "ordered_s": "π/20 as printed"}
_LEAST_SHARE = 0.25
"""Share of the runs that order, from which on a noise counts as one where flocking is observed."""


def flocking(runs: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return the runs at noises of at least 0.4 s at which at least a quarter of them order."""
    came = np.isfinite(runs[column]).groupby(runs["bw_s"]).transform("mean")
    return within(runs[came >= _LEAST_SHARE], 0.4)


def rate_slope(runs: pd.DataFrame, column: str) -> Interval:
    """Return how the logarithm of the rate of ordering grows per s of bw.

    The rate at a noise is the number of runs that order over the time until they do; a run that
    does not order counts with all of its time, and half a run is added to each noise.
    """
    noises = sorted(runs["bw_s"].unique())
    if len(noises) < 3:
        return unknown()
    came, waited = np.isfinite(runs[column]), runs[column].clip(upper=END_S)
    groups = at(runs.assign(came=came, waited=waited), "came", "waited")
    return bca(
        groups,
        lambda *drawn: slope(
            noises, [np.log((g[..., 0].sum(-1) + 0.5) / g[..., 1].sum(-1)) for g in drawn]
        ),
    )


def slope(x: list[float], y: list[Any]) -> Any:
    """Return the slope of a straight line through means at x, one for each draw."""
    away = np.array(x) - np.mean(x)
    return np.tensordot(away, np.stack(np.broadcast_arrays(*y)), 1) / (away**2).sum()


def judge(table: pd.DataFrame) -> Claims:
    """Judge what the paper says of figure 8."""
    claims = Claims("4.2", READING)
    free, led = setup(table, FREE), setup(table, CW)
    for name, runs in (("without leaders", free), ("with 3 leaders", led)):
        for column, angle in ANGLES.items():
            chosen = flocking(runs, column)
            claims.add(
                f"Order comes sooner at higher noise {name}",
                f"d ln(rate of ordering)/d bw (1/s), eq. (7) with {angle}, where a quarter order",
                rate_slope(chosen, column),
                least=0.0,
            )
        later = within(runs, 1.0, 2.4)
        noises = sorted(later["bw_s"].unique())
        claims.add(
            "The coherence of the flock decreases with increasing noise",
            f"slope of mean Ψ_o of second halves, bw 1.0 to 2.4 s (1/s), {name}",
            bca(
                at(later, "psi_o_late"),
                lambda *drawn, x=noises: slope(x, [g[..., 0].mean(-1) for g in drawn]),
            ),
            most=0.0,
        )
    column = "ordered_quarter_s"
    came = [
        np.isfinite(within(runs, 1.4)[column]).groupby(runs["seed"]).mean() for runs in (led, free)
    ]
    claims.add(
        "Leaders extend the noise range where ordering is present",
        "share of runs that order at bw ≥ 1.4 s (π/4), with 3 leaders minus without",
        mean(came[0] - came[1]),
        least=0.0,
    )
    waits = [
        within(runs, 0.4, 1.4)[column].clip(upper=END_S).groupby(runs["seed"]).mean()
        for runs in (led, free)
    ]
    claims.add(
        "Leaders slightly reduce the time needed for ordering",
        "mean time to order within 8 min (s; 480 s where it does not, π/4), bw 0.4 to 1.4 s, "
        "with 3 leaders minus without",
        mean(waits[0] - waits[1]),
        most=0.0,
    )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw the share of runs that have not ordered yet, by noise."""
    with picture(options, "fig08", height_cm=7.2) as figure:
        panels = figure.subplots(1, 2, sharey=True)
        for axes, name in zip(panels, (CW, FREE), strict=True):
            runs = setup(table, name)
            for color, bw_s in zip(COLORS, (0.4, 0.8, 1.0, 1.2, 1.4, 1.6), strict=False):
                times = runs.loc[np.isclose(runs["bw_s"], bw_s), "ordered_quarter_s"]
                left = kaplan_meier(times, END_S)
                x = np.array([0.0, *left.time_s, END_S]) / 60
                y = [1.0, *left.share, left.share_at(END_S)]
                axes.step(x, y, where="post", color=color, label=f"bw = {bw_s:g} s")
            title = f"{name} ({runs['seed'].nunique()} runs each)"
            paper = f"paper: sooner with noise, p = {_PAPERS_P[name]}"
            axes.set(title=f"{title}\n{paper}", xlabel="time (min)")
        panels[0].set(ylabel="share of runs not yet ordered", ylim=(-0.03, 1.03))
        figure.legend(*panels[1].get_legend_handles_labels(), loc="outside lower center", ncols=3)


script = judging("fig08", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
