"""Figure 10: Ψ_o against noise, without leaders and with three of them."""

from typing import Any

import numpy as np
import pandas as pd

from studies.claim import DISORDER, Claims, Interval, bca, crossing, disorder, judging, mean
from studies.order import MOSTLY
from studies.picture import COLORS, PAPERS_LINE, curve, picture
from studies.section4.section4 import (
    CW,
    FREE,
    HIGH_S,
    LOST_S,
    LOW_S,
    MEDIUM_S,
    READING,
    SETUPS,
    STUDY,
    at,
    over,
    setup,
    words,
)
from studies.study import Options, main

_BANDS = {"low": LOW_S, "medium": MEDIUM_S, "high": HIGH_S}


def lost(runs: pd.DataFrame) -> Interval:
    """Return the bw in s from which on mean Ψ_o of a setup's runs is that of disorder."""
    return disorder(sorted(runs["bw_s"].unique()), [at(runs, "psi_o")])


def gain(table: pd.DataFrame, least: float, most: float) -> Interval:
    """Return mean Ψ_o with clockwise leaders minus without at noises of a range, by seed."""
    led, free = (over(setup(table, name), "psi_o", least, most) for name in (CW, FREE))
    return mean(led - free)


def judge(table: pd.DataFrame) -> Claims:
    """Judge what the paper says of figure 10, and what its summary says of leaders."""
    claims = Claims("4.3, 6", READING)
    by = {name: setup(table, name) for name in SETUPS}
    free, led = by[FREE], by[CW]
    for name in SETUPS:
        runs = by[name]
        rotates = runs[runs["cw"] + runs["ccw"] >= MOSTLY]
        claims.add(
            "Ψ_o is near 1 in the ordered state at low noise",
            f"mean Ψ_o of the second half of runs that mostly rotate, {words(LOW_S)}, {name}; "
            "read as at least 0.9",
            mean(over(rotates, "psi_o_late", *LOW_S)),
            least=0.9,
        )
        claims.add(
            "Ψ_o is below 0.3 in the disordered state at high noise",
            f"mean Ψ_o, bw ≥ 2.4 s, {name}",
            mean(over(runs, "psi_o", 2.4)),
            most=0.3,
        )
        claims.add(
            "Order comes and goes at the critical noise",
            f"standard deviation of Ψ_o within runs, bw 1.2 to 1.6 s over bw ≥ 2.4 s, {name}; "
            "read as at least 1.2",
            bca(
                [np.stack([over(runs, "psi_o_sd", 1.2, 1.6), over(runs, "psi_o_sd", 2.4)], 1)],
                lambda drawn: drawn[..., 0].mean(-1) / drawn[..., 1].mean(-1),
            ),
            least=1.2,
        )
        lost_s = LOST_S[name]
        claims.add(
            f"Ψ_o becomes that of disorder around bw = {lost_s} s",
            f"bw (s) at which mean Ψ_o falls through {DISORDER:g}, {name}",
            lost(runs),
            least=lost_s - 0.2,
            most=lost_s + 0.2,
            ours=True,
        )
    for band, ends in _BANDS.items():
        claims.add(
            f"Leaders increase the order at {band} noise",
            f"mean Ψ_o with 3 clockwise leaders minus without, {words(ends)}",
            gain(table, *ends),
            least=0.0,
        )
    claims.add(
        "Leaders greatly increase coherence at medium noise",
        "mean Ψ_o with 3 clockwise leaders minus without, bw 1.4 to 2.0 s; read as at least 0.2",
        gain(table, 1.4, 2.0),
        least=0.2,
    )
    noises = sorted(free["bw_s"].unique())
    claims.add(
        "Leaders are most efficient at the critical noise",
        "bw of the largest gain of Ψ_o by 3 leaders minus that at which mean Ψ_o without leaders "
        f"falls through {DISORDER:g} (s)",
        bca(
            [*at(free, "psi_o"), *at(led, "psi_o")],
            lambda *drawn: _after(noises, drawn),
        ),
        least=-0.2,
        most=0.2,
    )
    claims.add(
        "Leaders raise the noise at which Ψ_o becomes that of disorder",
        f"bw (s) at which mean Ψ_o falls through {DISORDER:g}, with 3 clockwise leaders minus "
        "without",
        disorder(noises, [at(led, "psi_o"), at(free, "psi_o")], (1.0, -1.0)),
        least=0.0,
        ours=True,
    )
    return claims


def _after(noises: list[float], drawn: Any) -> Any:
    """Return the noise of the largest gain minus that at which Ψ_o without leaders is lost."""
    psi_o = np.stack(np.broadcast_arrays(*(group[..., 0].mean(-1) for group in drawn)))
    free, led = np.split(psi_o.reshape(len(drawn), -1), 2)
    peak = np.array(noises)[(led - free).argmax(0)]
    return (peak - crossing(noises, free, DISORDER)).reshape(psi_o.shape[1:])


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw means with intervals, and each run as a point."""
    with picture(options, "fig10", height_cm=6.0) as figure:
        panels = figure.subplots(1, 3, sharey=True)
        for axes, color, name in zip(panels, COLORS, SETUPS, strict=False):
            runs = setup(table, name)
            axes.plot(runs["bw_s"], runs["psi_o"], ".", color="0.7", markersize=2)
            groups = runs.groupby("bw_s")["psi_o"]
            curve(axes, groups.groups, [mean(each) for _, each in groups], color=color)
            axes.axvline(LOST_S[name], **PAPERS_LINE)
            axes.fill_between((LOST_S[name], runs["bw_s"].max()), 0.0, 0.3, color="0.9", zorder=0)
            axes.set(title=name, ylim=(0, 1.03))
        panels[0].set_ylabel("mean Ψ_o")
        words = "dashed: lost in the paper; shaded: its disorder"
        each = f"{runs['seed'].nunique()} runs each"
        figure.supxlabel(f"bw (s), {each}; {words}")


script = judging("fig10", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
