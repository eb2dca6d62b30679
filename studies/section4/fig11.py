"""Figure 11: C_v against noise, without leaders and with three of them."""

import numpy as np
import pandas as pd

from studies.claim import Claims, Interval, bca, judging, mean
from studies.picture import COLORS, PAPERS_LINE, curve, picture
from studies.section4.section4 import (
    CW,
    FREE,
    LOST_S,
    READING,
    SETUPS,
    STUDY,
    VERY_LOW_S,
    over,
    setup,
    words,
)
from studies.study import Options, main


def share_of_best(runs: pd.DataFrame, least: float, most: float = 9.0) -> Interval:
    """Return mean C_v of some noises over that of the noise where it is largest."""
    best = runs.groupby("bw_s")["c_v"].mean().idxmax()
    pairs = np.stack([over(runs, "c_v", least, most), over(runs, "c_v", best, best)], 1)
    return bca([pairs], lambda drawn: drawn[..., 0].mean(-1) / drawn[..., 1].mean(-1))


def judge(table: pd.DataFrame) -> Claims:
    """Judge the three states of figure 11."""
    claims = Claims("4.3", READING)
    for name in SETUPS:
        runs = setup(table, name)
        claims.add(
            "C_v is high at medium noise and vanishes at high noise",
            f"mean C_v at bw ≥ 2.4 s over its maximum, {name}; read as at most a tenth",
            share_of_best(runs, 2.4),
            most=0.1,
        )
        claims.add(
            "C_v is low again at very low noise",
            f"mean C_v at {words(VERY_LOW_S)} over its maximum, {name}; read as at most half",
            share_of_best(runs, *VERY_LOW_S),
            most=0.5,
        )
    free, led = setup(table, FREE), setup(table, CW)
    claims.add(
        "C_v is low at very low noise most so without leaders",
        f"mean C_v at {words(VERY_LOW_S)} with 3 clockwise leaders minus without (cm²/s²)",
        mean(over(led, "c_v", *VERY_LOW_S) - over(free, "c_v", *VERY_LOW_S)),
        least=0.0,
    )
    return claims


def draw(options: Options, table: pd.DataFrame) -> None:
    """Draw means with intervals."""
    with picture(options, "fig11", width_cm=12.0, height_cm=8.0) as figure:
        axes = figure.subplots()
        for color, marker, name in zip(COLORS, "osD", SETUPS, strict=False):
            groups = setup(table, name).groupby("bw_s")["c_v"]
            found = [mean(each) for _, each in groups]
            curve(axes, groups.groups, found, color=color, marker=marker, label=name)
        for lost_s in sorted(set(LOST_S.values())):
            axes.axvline(lost_s, **PAPERS_LINE)
        words = "dashed: order is lost in the paper,\nwithout leaders and with three"
        axes.set(xlabel=f"bw (s)\n{words}", ylabel="mean C_v (cm²/s²)")
        axes.legend(title=f"{table['seed'].nunique()} runs each")


script = judging("fig11", STUDY, judge, draw)


if __name__ == "__main__":
    main(script)
